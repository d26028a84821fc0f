//! A robot that still runs the report's program, behind a serial port: the sketch on the emulated Mega, behind a pseudo terminal.
#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::panic)]

use crate::support;
use rumbo_station::log_file;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use support::{Page, Running, rumbo_in, sketch};

/// The value of a signal in the last row of a message.
fn signal(message: &Value, columns: &[String], name: &str) -> Option<f64> {
    let column = columns.iter().position(|column| column == name)?;
    message["rows"].as_array()?.last()?[column].as_f64()
}

fn columns(page: &mut Page) -> Vec<String> {
    page.wait_for("hello", |message| {
        serde_json::from_value(message["columns"].clone()).ok()
    })
}

struct Bench {
    folder: tempfile::TempDir,
    _robot: Running,
    station: Running,
    page: Page,
    columns: Vec<String>,
}

impl Bench {
    fn with(scenario: &str, image: &Path) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let image = image.to_str().unwrap();
        let robot = Running::start(&["lab", "--pty", "--scenario", scenario, "--firmware", image]);
        let out = folder.path().to_str().unwrap().to_owned();
        let station = Running::start(&[
            "connect",
            &robot.said,
            "--text",
            "--no-browser",
            "--port",
            "0",
            "--out",
            &out,
        ]);
        let mut page = Page::open(&station.said);
        let columns = columns(&mut page);
        Self {
            folder,
            _robot: robot,
            station,
            page,
            columns,
        }
    }

    /// Waits for a value of a signal.
    fn wait_for(&mut self, name: &str, wanted: impl Fn(f64) -> bool) -> f64 {
        let Self { page, columns, .. } = self;
        page.wait_for(name, |message| {
            signal(message, columns, name).filter(|value| wanted(*value))
        })
    }

    /// Ends the station; returns its log.
    fn log(self) -> (tempfile::TempDir, PathBuf) {
        self.station.end();
        let mut files = std::fs::read_dir(self.folder.path()).unwrap();
        let path = files.next().unwrap().unwrap().path();
        (self.folder, path)
    }
}

#[test]
fn the_original_program_is_recognised_commanded_watched_and_recorded() {
    let Some(image) = sketch("memoria-mode5") else {
        return;
    };
    let mut bench = Bench::with("mode5", &image);
    // It is silent before its first ON.
    bench.page.send(&json!({"type": "speed", "factor": 1}));
    bench.page.wait_for_event("real robot");
    std::thread::sleep(std::time::Duration::from_secs(2));
    bench.page.send(&json!({"type": "arm"}));
    bench
        .page
        .wait_for_event("speaks the original program's text");
    assert_eq!(bench.wait_for("mode", |_| true), 5.0);
    bench
        .page
        .send(&json!({"type": "reference", "value": 60.0 * std::f64::consts::TAU / 60.0}));
    bench.page.wait_for_event("setpoint 60 rpm: sent");
    bench.wait_for("right_ref_rad_s", |rad_s| {
        (rad_s - std::f64::consts::TAU).abs() < 0.01
    });
    bench.wait_for("right_rad_s", |rad_s| rad_s > 4.0);
    // Its gains, as a person types them: without any, no controller's output is left.
    bench
        .page
        .send(&json!({"type": "type", "usart": 255, "text": "PID A 0 0 0"}));
    bench.wait_for("right_pwm", |pwm| pwm <= 60.0);
    bench.page.send(&json!({"type": "stop"}));
    bench.page.wait_for_event("STOP: sent");
    std::thread::sleep(std::time::Duration::from_millis(700));
    let (folder, path) = bench.log();
    let log = log_file::read(&path).unwrap();
    assert_eq!(log.cut, None);
    assert!(log.rows.len() > 10, "{}", log.rows.len());
    assert!(log.rows.is_sorted_by_key(|row| row.t_ms));
    // Values that rows of mode 5 lack are not invented.
    assert!(log.rows.iter().all(|row| row.signal("x_m").is_none()));
    assert!(log.rows.iter().all(|row| row.signal("mode") == Some(5.0)));
    let sent: Vec<u8> = log
        .link
        .iter()
        .filter(|burst| burst.to_robot)
        .flat_map(|burst| burst.bytes.clone())
        .collect();
    // Until the robot's protocol is known, frames are sent too, each ended by a zero.
    let lines: Vec<String> = sent
        .split(|byte| matches!(byte, b'\n' | 0))
        .map(|line| String::from_utf8_lossy(line).into_owned())
        .filter(|line| line.starts_with(|first: char| first.is_ascii_uppercase()))
        .collect();
    // The last OFF is the station's own, at its end.
    assert!(
        lines.ends_with(&["ON", "REF 60", "PID A 0 0 0", "OFF", "OFF"].map(String::from)),
        "{sent:?}"
    );
    replayed(&path, log.duration_s());
    let log = path.to_str().unwrap();
    for arguments in [&["export", log][..], &["compare", log, log]] {
        let done = rumbo_in(folder.path(), arguments);
        let said = String::from_utf8_lossy(&done.stderr);
        assert_eq!(done.status.code(), Some(0), "{said}");
    }
}

/// Its log in the dashboard: the robot's telemetry, and its lines in the console of the link, up to the playhead.
fn replayed(log: &Path, end_s: f64) {
    let replay = Running::start(&[
        "replay",
        log.to_str().unwrap(),
        "--no-browser",
        "--port",
        "0",
        "--speed",
        "0",
    ]);
    let mut page = Page::open(&replay.said);
    let columns = columns(&mut page);
    page.send(&json!({"type": "seek", "t_s": end_s}));
    let (mut lines, mut state, mut mode) = (String::new(), Value::Null, None);
    page.wait_for("the end of the log", |message| {
        for said in message["said"].as_array().into_iter().flatten() {
            assert_eq!(said["usart"], 255);
            lines += said["text"].as_str().unwrap();
        }
        if !message["state"].is_null() {
            state = message["state"].clone();
        }
        mode = signal(message, &columns, "mode").or(mode);
        (lines.contains(", 60.00, 5, ")
            && mode == Some(5.0)
            && state["t_s"].as_f64() >= Some(end_s - 0.01))
        .then_some(())
    });
    assert_eq!(state["robot"]["text"], true);
    assert_eq!(state["robot"]["mode"], 5);
    page.send(&json!({"type": "type", "usart": 255, "text": "REF 10"}));
    page.wait_for_event("this is a replay: nothing is sent to a robot");
}

#[test]
fn goals_reach_the_original_program_and_its_pose_and_states_are_seen() {
    let Some(image) = sketch("memoria-mode8") else {
        return;
    };
    let mut bench = Bench::with("mode8-goals", &image);
    std::thread::sleep(std::time::Duration::from_secs(2));
    bench.page.send(&json!({"type": "arm"}));
    // It sends once it has a goal.
    bench
        .page
        .send(&json!({"type": "goal", "x_m": 1.0, "y_m": 0.0}));
    bench
        .page
        .wait_for_event("speaks the original program's text");
    assert_eq!(bench.wait_for("mode", |_| true), 8.0);
    assert_eq!(bench.wait_for("reference_left", |_| true), 1.0);
    bench.wait_for("state", |state| state == 3.0);
    bench.wait_for("x_m", |x_m| x_m > 0.05);
}

#[test]
fn a_run_with_an_image_is_run_again_whole_with_what_its_usarts_said() {
    let Some(image) = sketch("memoria-mode5") else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let rumbo = |arguments: &[&str]| rumbo_in(folder.path(), arguments);
    let image = image.to_str().unwrap();
    let done = rumbo(&["run", "mode5", "--firmware", image, "--out", "."]);
    assert!(
        done.status.code().is_some_and(|status| status < 2),
        "{done:?}"
    );
    let path = folder.path().join("mode5-1.mcap");
    let log = log_file::read(&path).unwrap();
    let said: usize = log.said.iter().map(|said| said.bytes.len()).sum();
    assert!(said > 1_000, "{said}");
    let again = rumbo(&["rerun", "mode5-1.mcap"]);
    assert_eq!(again.status.code(), Some(0), "{again:?}");

    // A session, with a line typed to the program.
    let out = folder.path().join("lab");
    let lab = Running::start(&[
        "lab",
        "--scenario",
        "mode5",
        "--firmware",
        image,
        "--no-browser",
        "--port",
        "0",
        "--out",
        out.to_str().unwrap(),
    ]);
    let mut page = Page::open(&lab.said);
    // The scenario's own setpoint would take the place of the typed one.
    page.wait_for_event("setpoint 60 rpm: sent");
    page.send(&json!({"type": "type", "usart": 1, "text": "ON"}));
    page.send(&json!({"type": "type", "usart": 1, "text": "REF 50"}));
    page.wait_for("a row", |message| {
        let said = message["said"].as_array()?.iter();
        said.filter_map(|said| said["text"].as_str())
            .any(|text| text.contains(", 50"))
            .then_some(())
    });
    drop(page);
    lab.end();
    let path = std::fs::read_dir(&out)
        .unwrap()
        .next()
        .unwrap()
        .unwrap()
        .path();
    let log = log_file::read(&path).unwrap();
    assert!(
        log.said
            .iter()
            .any(|said| said.to_chip && said.bytes == b"REF 50\n")
    );
    let again = rumbo(&["rerun", path.to_str().unwrap()]);
    assert_eq!(again.status.code(), Some(0), "{again:?}");
}
