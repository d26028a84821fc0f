//! What the command says, where it says it, and with which exit status.

#![cfg(test)]

use rumbo_scenario::files::Library;
use std::io::{BufRead, BufReader};
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};

fn rumbo(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_rumbo"))
        .current_dir(env!("CARGO_TARGET_TMPDIR"))
        .args(arguments)
        .output()
        .unwrap()
}

fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

/// A file of this test run, by its name.
fn file(name: &str, text: &str) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::write(&path, text).unwrap();
    path
}

/// A short recording in the format of the original program, made up here.
const RECORDING: &str = "dt_ms,speed_a_rpm,speed_b_rpm,reference_rpm,mode,pwm_a,pwm_b\n\
                         5000,0,0,60,5,114,110\n50,15.63,12.5,60,5,100,103\n40,30,-30,60,5,90,91\n";

#[test]
fn wrong_input_gets_one_line_with_the_remedy_and_status_2() {
    file(
        "no_number.csv",
        "dt_ms,left_cm,right_cm,reference_cm,mode,pwm_a,pwm_b\n69,107,1O7,30,1,115,115\n",
    );
    file(
        "too_short.csv",
        "dt_ms,left_cm,right_cm,reference_cm,mode,pwm_a,pwm_b\n\n69,107,107,30,1,115\n",
    );
    file(
        "pwm.csv",
        "dt_ms,left_cm,right_cm,reference_cm,mode,pwm_a,pwm_b\n69,107,107,30,1,115,300\n",
    );
    file(
        "empty.csv",
        "dt_ms,left_cm,right_cm,reference_cm,mode,pwm_a,pwm_b\n",
    );
    file(
        "far.toml",
        "title = \"t\"\nrobot = \"memoria\"\nrig = \"front_single\"\nworld = \"open\"\nmode = 0\nduration_s = 1\n[start]\nx_m = -400\n",
    );
    file(
        "typos.toml",
        "title = \"t\"\nrobot = \"memoria\"\nrig = \"front_single\"\nworld = \"open\"\nmode = \"font_distance\"\nduration_s = 9\n[[command]]\nat_s = 2\nreference_m = 0.3\n",
    );
    file(
        "comma.toml",
        "title = \"t\"\nrobot = \"memoria\"\nrig = \"front_single\"\nworld = \"open\"\nmode = 0\nduration_s = 0,5\n",
    );
    let cases: [(&[&str], &str); 25] = [
        (
            &["run", "typos.toml"],
            "error: typos.toml:5: mode = font_distance: unknown mode; did you mean `front_distance` (1)?",
        ),
        (
            &["run", "comma.toml"],
            "error: comma.toml:6: not valid TOML: unexpected key or value, expected newline, `#`; write decimals with a point",
        ),
        (
            &["import", "far.toml"],
            "error: far.toml:1: `title = \"t\"` is neither a header of the original program nor a line of a capture; `rumbo import --help` shows the headers",
        ),
        (
            &["connect", ""],
            "error: a value is required for '<PORT>' but none was supplied; see `rumbo connect --help`",
        ),
        (
            &["fly"],
            "error: unrecognized subcommand 'fly'; see `rumbo --help`",
        ),
        (
            &["run"],
            "error: the following required arguments were not provided: <SCENARIO>...; see `rumbo run --help`",
        ),
        (
            &["run", "mode1", "--sed", "7"],
            "error: unexpected argument '--sed' found; tip: a similar argument exists: '--seed'; see `rumbo run --help`",
        ),
        (
            &["run", "fre"],
            "error: unknown scenario `fre`; did you mean `free`?",
        ),
        (
            &["run", "mode1", "--world", "opne"],
            "error: unknown world `opne`; did you mean `open`?",
        ),
        (
            &["run", "mode1", "--robot", "memory"],
            "error: unknown robot `memory`; did you mean `memoria`?",
        ),
        (
            &["run", "mode1", "--rig", "front"],
            "error: unknown rig `front`; did you mean `front_pair` or `front_single`?",
        ),
        (
            &["lab", "--rig", "fnal"],
            "error: unknown rig `fnal`; did you mean `final`?",
        ),
        (
            &["lab", "--world", "opne"],
            "error: unknown world `opne`; did you mean `open`?",
        ),
        (
            &["run", "far.toml"],
            "error: far.toml:8: start.x_m = -400: must be within -50..50 m",
        ),
        (
            &["run", "nowhere.toml"],
            "error: nowhere.toml: cannot be read (No such file or directory (os error 2)); give the path of an existing file",
        ),
        (
            &["run", "mode1", "--param", "battery.open_circuit_v=90"],
            "error: parameter battery.open_circuit_v = 90: must be within 5..9 V",
        ),
        (
            &["run", "mode1", "--param", "battery"],
            "error: invalid value 'battery' for '--param <NAME=VALUE>': write it as name=value, e.g. battery.open_circuit_v=6.9; see `rumbo run --help`",
        ),
        (
            &["lab", "--speed", "-1"],
            "error: unexpected argument '-1' found; see `rumbo lab --help`",
        ),
        (
            &["identify", "no_number.csv", "--check", "memoria"],
            "error: no_number.csv, line 2, column right_cm: `1O7`, allowed is a number",
        ),
        (
            &["identify", "pwm.csv", "--check", "memory"],
            "error: unknown robot `memory`; did you mean `memoria`?",
        ),
        (
            &["import", "no_number.csv"],
            "error: no_number.csv:2: right_cm = `1O7`: must be a number within -1000000..1000000",
        ),
        (
            &["import", "too_short.csv"],
            "error: too_short.csv:3: 6 values in a row of 7 columns; expected dt_ms,left_cm,right_cm,reference_cm,mode,pwm_a,pwm_b",
        ),
        (
            &["import", "pwm.csv"],
            "error: pwm.csv:2: pwm_b = `300`: must be a number within -255..255",
        ),
        (
            &["import", "empty.csv"],
            "error: empty.csv:1: no rows under the header; is the recording complete?",
        ),
        (
            &["import", "nowhere.csv"],
            "error: nowhere.csv: cannot be read (No such file or directory (os error 2)); give the path of a CSV file",
        ),
    ];
    for (arguments, expected) in cases {
        let output = rumbo(arguments);
        assert_eq!(stderr(&output), format!("{expected}\n"), "{arguments:?}");
        assert_eq!(stdout(&output), "", "{arguments:?}");
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
    }
}

#[test]
fn every_subcommand_shows_an_example_in_its_help() {
    for subcommand in [
        "lab", "run", "identify", "import", "list", "connect", "replay", "export", "compare",
        "rerun", "flash",
    ] {
        let help = stdout(&rumbo(&[subcommand, "--help"]));
        let (_, examples) = help.split_once("Examples:").unwrap();
        assert!(examples.contains(&format!("rumbo {subcommand}")), "{help}");
    }
}

#[test]
fn list_names_what_there_is() {
    let all = stdout(&rumbo(&["list"]));
    for name in [
        "mode1",
        "manual-turn-left",
        "wall_front",
        "memoria",
        "front_distance",
    ] {
        assert!(all.contains(name), "{name} is not in\n{all}");
    }
    let json: serde_json::Value =
        serde_json::from_str(&stdout(&rumbo(&["list", "robots", "--json"]))).unwrap();
    assert_eq!(json["robots"][0]["name"], "memoria");
    assert!(
        json["robots"][0]["rigs"]
            .as_array()
            .unwrap()
            .contains(&"front_single".into())
    );
    let json: serde_json::Value =
        serde_json::from_str(&stdout(&rumbo(&["list", "modes", "--json"]))).unwrap();
    let modes = json["modes"].as_array().unwrap();
    assert_eq!(modes.len(), 9);
    for mode in modes {
        assert!(!mode["help"].as_str().unwrap().is_empty(), "{mode}");
        assert!(!mode["states"].as_array().unwrap().is_empty(), "{mode}");
    }
    let reference = serde_json::json!({"what": "distance", "unit": "cm", "min": 5.0, "max": 200.0});
    assert_eq!(modes[1]["reference"], reference);
    let modes = stdout(&rumbo(&["list", "modes"]));
    assert!(modes.contains("distance 5..200 cm"), "{modes}");
    let rigs = stdout(&rumbo(&["list", "rigs"]));
    assert!(rigs.contains("front looks ahead, on the servo"), "{rigs}");
}

#[test]
fn an_imported_recording_is_in_si_units_with_the_original_attached() {
    file("recording.csv", RECORDING);
    let output = rumbo(&[
        "import",
        "recording.csv",
        "--out",
        "recording.mcap",
        "--json",
    ]);
    let summary: serde_json::Value = serde_json::from_str(&stdout(&output)).unwrap();
    assert_eq!(summary["rows"], 3);
    // The first row's time is how long the original program waited for its start.
    assert!((summary["duration_s"].as_f64().unwrap() - 0.09).abs() < 1e-9);

    let log =
        std::fs::read(PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("recording.mcap")).unwrap();
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
        let mut import = Command::new(env!("CARGO_BIN_EXE_rumbo"));
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

/// The objects on stdout, one a line.
fn objects(output: &Output) -> Vec<serde_json::Value> {
    stdout(output)
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect()
}

#[test]
fn a_run_is_one_object_and_the_same_on_any_number_of_threads() {
    let run = |threads: &str| {
        rumbo(&[
            "run",
            "mode1",
            "manual-straight",
            "--seed",
            "5",
            "--runs",
            "4",
            "--json",
            "--threads",
            threads,
        ])
    };
    let one = run("1");
    let named: Vec<_> = objects(&one)
        .iter()
        .map(|run| (run["scenario"].clone(), run["seed"].as_u64().unwrap()))
        .collect();
    let expected = ["mode1", "manual-straight"]
        .map(|name| [5, 6, 7, 8].map(|seed| (name.into(), seed)))
        .concat();
    assert_eq!(named, expected);
    assert!(
        objects(&one)
            .iter()
            .all(|run| run["metrics"]["contacts"].is_number() && run["pass"].is_boolean())
    );
    assert_eq!(stdout(&one), stdout(&run("3")));
}

#[test]
fn a_missed_limit_is_named_and_gives_status_1() {
    let text = Library::new().scenario("mode1").unwrap().text;
    let text = text.split("[limits]").next().unwrap().to_owned();
    file(
        "strict.toml",
        &format!("{text}\n[limits]\n\"step1.settling_s\" = {{ max = 0.1 }}\n"),
    );
    let output = rumbo(&["run", "strict.toml"]);
    assert_eq!(
        (stderr(&output).as_str(), output.status.code()),
        ("", Some(1))
    );
    assert!(
        stdout(&output).contains("at most 0.1"),
        "{}",
        stdout(&output)
    );
    assert!(
        stdout(&output).contains("FAILED, seed 1: step1.settling_s"),
        "{}",
        stdout(&output)
    );

    file(
        "lenient.toml",
        &format!("{text}\n[limits]\n\"step1.settling_s\" = {{ max = 9 }}\n"),
    );
    assert_eq!(
        rumbo(&["run", "lenient.toml", "--json"]).status.code(),
        Some(0)
    );
}

#[test]
fn a_parameter_from_the_command_line_changes_the_run() {
    let settling_s = |param: &str| {
        let output = rumbo(&["run", "mode1", "--json", "--param", param]);
        objects(&output)[0]["metrics"]["step1.rise_s"]
            .as_f64()
            .unwrap()
    };
    assert!(settling_s("front_cruise_m_s=0.15") > settling_s("front_cruise_m_s=0.4") + 1.0);
}

#[test]
fn each_run_leaves_its_result_and_its_trace_in_the_folder_asked_for() {
    let output = rumbo(&[
        "run",
        "mode1",
        "--seed",
        "3",
        "--runs",
        "2",
        "--json",
        "--out",
        "kept/runs",
    ]);
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("kept/runs");
    for (line, seed) in stdout(&output).lines().zip([3, 4]) {
        assert_eq!(
            std::fs::read_to_string(folder.join(format!("mode1-{seed}.json")))
                .unwrap()
                .trim(),
            line
        );
        let trace = std::fs::read_to_string(folder.join(format!("mode1-{seed}.csv"))).unwrap();
        assert!(trace.starts_with("t_s,") && trace.lines().count() > 800);
    }
}

#[test]
fn the_lab_says_when_its_port_is_taken_and_prints_its_address_when_not() {
    let taken = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port().to_string();
    let output = rumbo(&["lab", "--no-browser", "--port", &port]);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        stderr(&output).contains(&format!("port {port} on 127.0.0.1 is in use")),
        "{}",
        stderr(&output)
    );

    let mut lab = Command::new(env!("CARGO_BIN_EXE_rumbo"))
        .args(["--no-browser", "--port", "0", "--out"])
        .arg(env!("CARGO_TARGET_TMPDIR"))
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut address = String::new();
    BufReader::new(lab.stdout.take().unwrap())
        .read_line(&mut address)
        .unwrap();
    lab.kill().unwrap();
    lab.wait().unwrap();
    assert!(address.starts_with("http://127.0.0.1:"), "{address}");
}

#[test]
fn a_reader_who_stops_reading_ends_the_command_quietly() {
    let mut child = Command::new(env!("CARGO_BIN_EXE_rumbo"))
        .args(["list", "plant"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!(
        (stderr(&output).as_str(), output.status.code()),
        ("", Some(0))
    );
}

/// A program that stays where it is.
const SPIN: &str = ":02000000FFCF30\n:00000001FF\n";

#[cfg(unix)]
#[test]
fn a_campaign_that_is_interrupted_tells_what_it_had() {
    let mut campaign = Command::new(env!("CARGO_BIN_EXE_rumbo"))
        .args(["run", "mode5", "--runs", "1000000", "--json"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(campaign.stdout.take().unwrap()).lines();
    let first = lines.next().unwrap().unwrap();
    let interrupt = Command::new("kill")
        .args(["-INT", &campaign.id().to_string()])
        .status();
    assert!(interrupt.unwrap().success());
    let rest: Vec<String> = lines.map(Result::unwrap).collect();
    let output = campaign.wait_with_output().unwrap();
    for line in [&first].into_iter().chain(&rest) {
        serde_json::from_str::<serde_json::Value>(line).unwrap();
    }
    assert_eq!(output.status.code(), Some(130));
    let said = format!(
        "note: interrupted after {} of 1000000 runs\n",
        rest.len() + 1
    );
    assert_eq!(stderr(&output), said);
}

#[test]
fn a_program_is_shown_as_a_profile_and_as_a_waveform() {
    file("spin.hex", SPIN);
    file(
        "moment.toml",
        "title = \"t\"\nrobot = \"memoria\"\nrig = \"front_single\"\nworld = \"open\"\nmode = 0\nduration_s = 0.2\n",
    );
    let arguments =
        "run moment.toml --firmware spin.hex --profile spin.folded --vcd spin.vcd --json";
    let output = rumbo(&arguments.split(' ').collect::<Vec<_>>());
    assert_ne!(output.status.code(), Some(2), "{}", stderr(&output));
    assert!(
        stderr(&output).contains(" cycles (0.200 s), 0.0 % asleep"),
        "{}",
        stderr(&output)
    );
    assert_eq!(stdout(&output).lines().count(), 1);
    let read = |name| {
        std::fs::read_to_string(PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name)).unwrap()
    };
    assert!(read("spin.folded").starts_with("(unknown) "));
    assert!(read("spin.vcd").contains("left_enable"));
    let output = rumbo(&[
        "run",
        "mode5",
        "--firmware",
        "spin.hex",
        "--profile",
        "x",
        "--runs",
        "2",
    ]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("one run, here are 2"));
    let output = rumbo(&["run", "mode5", "--vcd", "x"]);
    assert_eq!(output.status.code(), Some(2));
}

#[test]
fn a_run_waits_for_a_debugger_and_ends_with_it() {
    use std::io::{Read, Write};
    file("held.hex", SPIN);
    let mut child = Command::new(env!("CARGO_BIN_EXE_rumbo"))
        .current_dir(env!("CARGO_TARGET_TMPDIR"))
        .args(["run", "mode5", "--firmware", "held.hex", "--gdb", "0"])
        .stderr(Stdio::piped())
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(child.stderr.take().unwrap());
    let mut line = String::new();
    lines.read_line(&mut line).unwrap();
    let digits = line
        .rsplit(':')
        .next()
        .unwrap()
        .trim_matches(|c: char| !c.is_ascii_digit());
    let mut debugger =
        std::net::TcpStream::connect(("127.0.0.1", digits.parse().unwrap())).unwrap();
    let receive = |debugger: &mut std::net::TcpStream, text: &str| {
        let mut bytes = vec![0; text.len()];
        debugger.read_exact(&mut bytes).unwrap();
        assert_eq!(String::from_utf8(bytes).unwrap(), text);
    };
    // A breakpoint where the program is; on to it; the end.
    for (command, answer) in [("$Z0,0,2#44", "+$OK#9a"), ("$c#63", "+$T05")] {
        debugger.write_all(command.as_bytes()).unwrap();
        receive(&mut debugger, answer);
    }
    debugger.write_all(b"+$k#6b").unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(2));
    let mut rest = String::new();
    lines.read_to_string(&mut rest).unwrap();
    assert!(rest.contains("the debugger ended the run"), "{rest}");
}
