//! `rumbo import`, and what is read of what it made.

use crate::support::{file, program, rumbo, stderr, stdout};
use std::process::Output;

/// A short recording in the format of the original program, made up here.
const RECORDING: &str = "dt_ms,speed_a_rpm,speed_b_rpm,reference_rpm,mode,pwm_a,pwm_b\n\
                         5000,0,0,60,5,114,110\n50,15.63,12.5,60,5,100,103\n40,30,-30,60,5,90,91\n";

#[test]
fn an_imported_recording_is_in_si_units_with_the_original_attached() {
    // A folder of its own: a log that another version left there would be kept.
    let folder = tempfile::tempdir().unwrap();
    let [csv, out] =
        ["csv", "mcap"].map(|ending| folder.path().join("recording").with_extension(ending));
    std::fs::write(&csv, RECORDING).unwrap();
    let output = rumbo(&[
        "import",
        csv.to_str().unwrap(),
        "--out",
        out.to_str().unwrap(),
        "--json",
    ]);
    let summary: serde_json::Value = serde_json::from_str(&stdout(&output)).unwrap();
    assert_eq!(summary["rows"], 3);
    // The first row's time is how long the original program waited for its start.
    assert!((summary["duration_s"].as_f64().unwrap() - 0.09).abs() < 1e-9);

    let log = std::fs::read(&out).unwrap();
    let messages: Vec<_> = mcap::MessageStream::new(&log)
        .unwrap()
        .map(Result::unwrap)
        .collect();
    let last: serde_json::Value = serde_json::from_slice(&messages[2].data).unwrap();
    // Motor A of the original is the right wheel; 30 rpm are pi rad/s.
    assert!((last["right_speed_rad_s"].as_f64().unwrap() - std::f64::consts::PI).abs() < 1e-9);
    assert!((last["left_speed_rad_s"].as_f64().unwrap() + std::f64::consts::PI).abs() < 1e-9);
    assert_eq!(last["left_pwm"], 91.0);
    assert_eq!(messages[2].log_time, 90_000_000);
    let contents = mcap::Summary::read(&log).unwrap().unwrap();
    let attached = mcap::read::attachment(&log, &contents.attachment_indexes[0]).unwrap();
    assert_eq!(attached.data, RECORDING.as_bytes());
}

#[test]
fn a_csv_that_a_spanish_spreadsheet_saved_is_imported_and_another_log_of_its_name_stays() {
    let folder = tempfile::tempdir().unwrap();
    let import = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        let mut import = program();
        let output = import.current_dir(&folder).args(["import", name, "--json"]);
        output.output().unwrap()
    };
    let summary = |output: &Output| {
        serde_json::from_str::<serde_json::Value>(&stdout(output)).unwrap()["columns"].clone()
    };
    let plain = import("plain.csv", RECORDING);
    let semicolons = RECORDING
        .replace(',', ";")
        .replace('.', ",")
        .replace('\n', "\r\n");
    let spanish = import("spanish.csv", &format!("\u{feff}{semicolons}"));
    assert_eq!(summary(&spanish), summary(&plain));
    let quoted = RECORDING
        .lines()
        .map(|row| format!("\"{}\"", row.replace(',', "\";\"").replace('.', ",")))
        .collect::<Vec<_>>();
    let quoted = import("quoted.csv", &format!("sep=;\n{}\n", quoted.join("\n")));
    assert_eq!(summary(&quoted), summary(&plain), "{}", stderr(&quoted));
    // The same again is no loss; another recording of that name would be one.
    assert!(import("plain.csv", RECORDING).status.success());
    let other = import("plain.csv", &RECORDING.replace(",5,", ",6,"));
    assert_eq!(other.status.code(), Some(2));
    assert!(
        stderr(&other).contains("another place"),
        "{}",
        stderr(&other)
    );
}

#[test]
fn a_recording_and_the_log_made_of_it_are_checked_alike() {
    // Two seconds at a steady 60 rpm, made up here.
    let rows = (0..40).map(|row| {
        format!(
            "50,{speed},{speed},60,5,90,90\n",
            speed = if row < 4 { 15 * row } else { 60 }
        )
    });
    let header = "dt_ms,speed_a_rpm,speed_b_rpm,reference_rpm,mode,pwm_a,pwm_b\n";
    file(
        "steady.csv",
        &format!("{header}{}", rows.collect::<String>()),
    );
    rumbo(&["import", "steady.csv", "--out", "steady.mcap"]);
    let check = |log: &str| {
        let output = rumbo(&["identify", log, "--check", "memoria", "--json"]);
        let report: serde_json::Value = serde_json::from_str(&stdout(&output)).unwrap();
        (
            report["runs"][0]["whole"].clone(),
            report["runs"][0]["nuisance"].clone(),
        )
    };
    let recording = check("steady.csv");
    assert_eq!(recording.0[0]["rows"], 40);
    assert_eq!(recording, check("steady.mcap"));
}

#[test]
fn a_damaged_row_near_the_start_costs_only_that_row_and_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    let import = |damaged: &[u8]| {
        std::fs::write(folder.path().join("damaged.csv"), damaged).unwrap();
        let mut import = program();
        import.current_dir(&folder).args(["import", "damaged.csv"]);
        import
            .args(["--out", "damaged.mcap", "--force", "--json"])
            .output()
            .unwrap()
    };
    let rows: Vec<String> = (0..30)
        .map(|row| format!("50,{row},{row},60,5,90,91\n"))
        .collect();
    let whole = format!(
        "{}{}",
        &RECORDING[..RECORDING.find('\n').unwrap() + 1],
        rows.concat()
    );
    let cut = whole.replacen("50,1,1,60,5,90,91", "50,1,1,6", 1);
    let header = whole.replacen("speed_b_rpm", "spee\u{0007}_rpm", 1);
    let mut noise = whole.clone().into_bytes();
    // Of a line of 17 bytes after the header: no text at all.
    noise[rows[0].len() + whole.find('\n').unwrap() + 5] = 0xFE;
    for (damaged, line, rows, duration_s) in [
        (cut.as_bytes(), 3, 29, 1.45),
        (header.as_bytes(), 1, 30, 1.45),
        (&noise, 3, 29, 1.45),
    ] {
        let output = import(damaged);
        assert!(output.status.success(), "{}", stderr(&output));
        let summary: serde_json::Value = serde_json::from_str(&stdout(&output)).unwrap();
        assert_eq!(summary["rows"], rows);
        assert!((summary["duration_s"].as_f64().unwrap() - duration_s).abs() < 1e-9);
        assert_eq!(summary["left_out"][0]["line"], line);
        let note = stderr(&output);
        assert!(
            note.starts_with(&format!("note: damaged.csv:{line} is skipped: ")),
            "{note}"
        );
        assert!(note.ends_with("note: all the rest is used\n"), "{note}");
        // What reads imported logs reads this one, and the file as it was is in it too.
        let mut check = program();
        check
            .current_dir(&folder)
            .args(["identify", "damaged.mcap", "--check", "memoria"]);
        assert!(check.output().unwrap().status.success());
        let log = std::fs::read(folder.path().join("damaged.mcap")).unwrap();
        let contents = mcap::Summary::read(&log).unwrap().unwrap();
        let attached = mcap::read::attachment(&log, &contents.attachment_indexes[1]).unwrap();
        assert_eq!(attached.data, damaged);
    }
}

#[test]
fn a_recording_without_pwm_is_skipped_with_a_note() {
    let row = "60,10,10,0,1,0,0.1,0.1,0,3,50,50,50\n";
    let header = "dt_ms,reference_a_rpm,reference_b_rpm,heading_reference_deg,goal_x_m,goal_y_m,x_m,y_m,heading_deg,state,right_cm,left_cm,front_cm\n";
    file("goals.csv", &format!("{header}{row}{row}"));
    file("driven.csv", RECORDING);
    let output = rumbo(&["identify", "goals.csv", "driven.csv", "--check", "memoria"]);
    let said = stderr(&output);
    assert!(said.starts_with("note: goals.csv is skipped"), "{said}");
    let alone = rumbo(&["identify", "goals.csv", "--check", "memoria"]);
    assert_eq!(alone.status.code(), Some(2));
    assert!(stderr(&alone).contains("give a log of modes 1 to 7"));
}

/// Runs `rumbo import` in a folder of its own; what it wrote is `table.mcap`.
struct Import {
    folder: tempfile::TempDir,
}

impl Import {
    fn of(name: &str, content: &[u8]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join(name), content).unwrap();
        Self { folder }
    }

    fn run(&self, args: &[&str]) -> Output {
        program()
            .current_dir(&self.folder)
            .args(args)
            .output()
            .unwrap()
    }

    /// The rows of a log as `rumbo export` writes them.
    fn exported(&self, log: &str) -> Vec<std::collections::BTreeMap<String, f64>> {
        let export = self.run(&["export", log, "--format", "csv", "--force"]);
        assert!(export.status.success(), "{}", stderr(&export));
        let table = std::path::Path::new(log).with_extension("csv");
        let text = std::fs::read_to_string(self.folder.path().join(table)).unwrap();
        let names: Vec<&str> = text.lines().next().unwrap().split(',').collect();
        let rows = text.lines().skip(1).map(|line| {
            let cells = names.iter().zip(line.split(','));
            cells
                .filter_map(|(name, cell)| Some(((*name).to_owned(), cell.parse().ok()?)))
                .collect()
        });
        rows.collect()
    }
}

#[test]
fn a_table_of_another_program_is_shown_with_the_command_that_imports_it() {
    let rows = (0..30).map(|at| {
        format!(
            "{at},{},{}.5,{}.25\n",
            1_700_000_000_000_u64 + 100 * at,
            at,
            at
        )
    });
    let header = "Sample Number (10 samples per second),UNIX Timestamp (Milliseconds since 1970-01-01),Left Speed (rpm),Right Speed (rpm)\n";
    let import = Import::of(
        "viewer.csv",
        format!("{header}{}", rows.collect::<String>()).as_bytes(),
    );
    let preview = import.run(&["import", "viewer.csv"]);
    let said = stdout(&preview);
    let command = "rumbo import viewer.csv --columns 't_ms=#2,left_rpm=#3,right_rpm=#4'";
    assert!(
        said.contains("nothing is written yet") && said.contains(command),
        "{said}"
    );
    assert!(!import.folder.path().join("viewer.mcap").exists());
    let imported = import.run(&[
        "import",
        "viewer.csv",
        "--columns",
        "t_ms=#2,left_rpm=#3,right_rpm=#4",
    ]);
    let said = stdout(&imported);
    assert!(
        said.contains("30 rows of signals in 2.9 s") && said.contains("lacks left_pwm, right_pwm"),
        "{said}"
    );
    let last = &import.exported("viewer.mcap")[29];
    assert_eq!(last["t_s"], 2.9);
    assert!((last["left_rad_s"] - 29.5 * std::f64::consts::PI / 30.0).abs() < 1e-3);
    let refused = import.run(&["identify", "viewer.mcap"]);
    assert!(
        stderr(&refused).contains("has no left_pwm, right_pwm"),
        "{}",
        stderr(&refused)
    );
}

#[test]
fn a_table_that_shares_some_names_with_the_original_s_is_one_of_another_program() {
    let table = b"t_s,x_m,y_m,heading_deg,state\n0,0,0,0,1\n1,0.1,0,0,1\n2,0.2,0,5,1\n";
    let import = Import::of("table.csv", table);
    let said = stdout(&import.run(&["import", "table.csv"]));
    assert!(
        said.contains("t_s=t_s,x_m=x_m,y_m=y_m,heading_deg=heading_deg"),
        "{said}"
    );
}

#[test]
fn two_columns_of_one_name_are_two() {
    let table = b"millis,rpm,rpm,pwm,pwm\n0,10,20,100,110\n20,10,20,100,110\n40,10,20,100,110\n";
    let import = Import::of("table.csv", table);
    let columns = "t_ms=millis,left_rpm=rpm,right_rpm=rpm_2,left_pwm=#4,right_pwm=#5";
    let output = import.run(&["import", "table.csv", "--columns", columns]);
    assert!(output.status.success(), "{}", stderr(&output));
    let last = import.exported("table.mcap").pop().unwrap();
    assert!(
        (2.0 * last["left_rad_s"] - last["right_rad_s"]).abs() < 1e-3,
        "{last:?}"
    );
    assert_eq!([last["left_pwm"], last["right_pwm"]], [100.0, 110.0]);
}

#[test]
fn a_column_without_values_has_no_least_and_no_largest() {
    let import = Import::of("table.csv", b"millis,range_left_m\n0,\n20,\n40,\n");
    let said = stdout(&import.run(&["import", "table.csv"]));
    assert!(
        said.contains("range_left_m") && !said.contains("inf"),
        "{said}"
    );
}

#[test]
fn cells_that_are_no_numbers_are_said() {
    let table = b"t_ms;left_rpm;right_rpm\n0;1.234,5;1\n20;1.234,5;\n40;7;nan\n60;7;-inf\n";
    let import = Import::of("table.csv", table);
    let output = import.run(&["import", "table.csv", "--columns", "auto"]);
    assert_eq!(
        stderr(&output),
        "note: table.csv: left_rpm: 2 values left out, the first is `1.234.5` in line 2: no finite number\n\
         note: table.csv: right_rpm: 2 values left out, the first is `nan` in line 4: no finite number\n"
    );
}

#[test]
fn counts_are_speeds_by_what_a_turn_counts_and_rows_of_the_serial_monitor_have_its_times() {
    // 748 counts in a second to the right, half as many to the left; a row each 5 ms.
    let rows: Vec<String> = (0..300)
        .map(|at| {
            format!(
                "23:59:{:06.3} -> right:{},left:{},pwm:300\n",
                59.0 + f64::from(at) * 0.005 % 1.0,
                748 * at / 200,
                374 * at / 200
            )
        })
        .take(200)
        .collect();
    let import = Import::of("table.txt", rows.concat().as_bytes());
    let columns = "auto,right_turn=right/748,left_turn=left/748,left_pwm=pwm*0.5,right_pwm=pwm*0.5";
    let output = import.run(&["import", "table.txt", "--columns", columns, "--json"]);
    let summary: serde_json::Value =
        serde_json::from_str(&stdout(&output)).unwrap_or_else(|_| panic!("{}", stderr(&output)));
    assert_eq!(summary["identify_lacks"], serde_json::json!([]));
    let last = &import.exported("table.mcap")[198];
    assert!(
        (last["right_rad_s"] - std::f64::consts::TAU).abs() < 0.1,
        "{last:?}"
    );
    assert!(
        (last["left_rad_s"] - std::f64::consts::PI).abs() < 0.1,
        "{last:?}"
    );
    assert_eq!(last["left_pwm"], 150.0);
    let check = import.run(&["identify", "table.mcap", "--check", "memoria"]);
    assert!(check.status.success(), "{}", stderr(&check));
    // Of 255: what is more is in another unit.
    let refused = import.run(&[
        "import",
        "table.txt",
        "--columns",
        "auto,left_pwm=pwm",
        "--out",
        "x.mcap",
    ]);
    assert!(
        stderr(&refused).contains("left_pwm reaches 300 of 255"),
        "{}",
        stderr(&refused)
    );
}

#[test]
fn a_log_of_another_program_is_imported_and_only_ours_is_sent_to_replay() {
    let bags = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../ros/tests/bags");
    let import = Import::of(
        "foreign.mcap",
        &std::fs::read(bags.join("zstd.mcap")).unwrap(),
    );
    let said = stderr(&import.run(&["identify", "foreign.mcap"]));
    assert!(said.contains("`rumbo import`"), "{said}");
    let output = import.run(&["import", "foreign.mcap"]);
    let said = stdout(&output);
    for part in [
        "range_left_m = /sonar/range",
        "forward_ref_m_s = /cmd_vel/linear/x",
        "may be more: --columns 'auto,left_rad_s=/left_wheel/speed/data'",
        "`rumbo replay foreign-rumbo.mcap` shows it",
    ] {
        assert!(said.contains(part), "{part}: {said}{}", stderr(&output));
    }
    let last = import.exported("foreign-rumbo.mcap").pop().unwrap();
    assert!((last["range_left_m"] - 0.61).abs() < 1e-3, "{last:?}");
    let again = import.run(&["import", "foreign-rumbo.mcap"]);
    assert!(
        stderr(&again).contains("is a log already; `rumbo replay` shows it"),
        "{}",
        stderr(&again)
    );
    // Odometry and joints of an older recorder.
    std::fs::copy(bags.join("foxy.db3"), import.folder.path().join("old.db3")).unwrap();
    assert!(import.run(&["import", "old.db3"]).status.success());
    let last = import.exported("old.mcap").pop().unwrap();
    let wheels_and_pose =
        ["left_rad_s", "right_rad_s", "x_m", "heading_rad"].map(|name| last[name]);
    assert_eq!(wheels_and_pose, [6.0, 8.0, 0.11, 1.1]);
}
