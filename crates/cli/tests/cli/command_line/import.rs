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
fn a_table_of_another_program_is_imported_once_its_columns_have_names() {
    let folder = tempfile::tempdir().unwrap();
    let table = "time,left,right,note\n1.0,50,40,a\n1.1,49,41,b\n1.3,48,x,c\n1.4,47,43,d\n";
    std::fs::write(folder.path().join("own.csv"), table).unwrap();
    let import = |columns: &[&str]| {
        let mut import = program();
        let given = columns.iter().flat_map(|column| ["--column", column]);
        import
            .current_dir(&folder)
            .args(["import", "own.csv", "--json"]);
        import.args(given).output().unwrap()
    };
    let done = import(&["time=t_s", "left=left_cm", "right=right_cm"]);
    let summary: serde_json::Value = serde_json::from_str(&stdout(&done)).unwrap();
    assert_eq!(summary["rows"], 3, "{summary}");
    assert!((summary["duration_s"].as_f64().unwrap() - 0.4).abs() < 1e-9);
    assert!((summary["columns"]["left_range_m"]["max"].as_f64().unwrap() - 0.5).abs() < 1e-9);
    // The damaged line is named as it is in the file.
    assert!(stderr(&done).contains("4"), "{}", stderr(&done));
    for (columns, said) in [
        (
            &["zeit=t_s"][..],
            "no column `zeit`; there are time, left, right, note",
        ),
        (&["left=left_cm"], "no column is the time"),
        (&["time=t_s", "left=links"], "left=links: no such column"),
        (&["time=t_s"], "no column is one of ours"),
    ] {
        let refused = import(columns);
        assert!(stderr(&refused).contains(said), "{}", stderr(&refused));
    }
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
    assert!(stderr(&other).contains("--out"), "{}", stderr(&other));
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

#[test]
fn a_log_of_another_program_is_not_sent_to_replay_which_refuses_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("foreign.mcap");
    let mut log = mcap::Writer::new(std::fs::File::create(&path).unwrap()).unwrap();
    let schema = log
        .add_schema("std_msgs/msg/Float64", "ros2msg", b"float64 data")
        .unwrap();
    let channel = log
        .add_channel(schema, "/left_wheel/speed", "cdr", &Default::default())
        .unwrap();
    let header = mcap::records::MessageHeader {
        channel_id: channel,
        sequence: 0,
        log_time: 1,
        publish_time: 1,
    };
    log.write_to_known_channel(&header, &[0; 12]).unwrap();
    log.finish().unwrap();
    drop(log);
    let refused = rumbo(&["import", path.to_str().unwrap()]);
    assert_eq!(refused.status.code(), Some(2));
    let said = stderr(&refused);
    assert!(
        said.contains("of another program, with /left_wheel/speed (std_msgs/msg/Float64)")
            && !said.contains("rumbo replay"),
        "{said}"
    );
}
