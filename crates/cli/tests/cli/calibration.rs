//! `rumbo calibrate` leaves a log like any run.
#![cfg(test)]
#![allow(clippy::unwrap_used, clippy::panic)]

use crate::support;
use rumbo_log::LogKind;
use rumbo_station::log_file;
use std::path::{Path, PathBuf};
use std::process::Output;
use support::{program, stderr, stdout};

/// `rumbo` whose logs go to a folder of its own.
fn rumbo(logs: &Path, arguments: &[&str]) -> Output {
    let mut command = program();
    command.env("RUMBO_LOGS", logs).current_dir(logs);
    command.args(arguments).output().unwrap()
}

fn recorded(logs: &Path) -> Vec<PathBuf> {
    let files = std::fs::read_dir(logs).unwrap();
    files.map(|file| file.unwrap().path()).collect()
}

#[test]
fn a_calibration_is_recorded_and_its_log_is_read_like_any_other() {
    let folder = tempfile::tempdir().unwrap();
    let logs = folder.path();
    let done = rumbo(logs, &["calibrate", "--seed", "3", "--json"]);
    assert!(done.status.success(), "{}", stderr(&done));
    let log = recorded(logs).pop().unwrap();
    let shown = log.display().to_string();
    assert_eq!(stderr(&done), format!("recorded: {shown}\n"));
    assert!(shown.ends_with("-calibration-3.mcap"), "{shown}");

    let read = log_file::read(&log).unwrap();
    assert_eq!(read.cut, None);
    assert_eq!(read.manifest.as_ref().unwrap().kind, LogKind::Calibration);
    let found: serde_json::Value = serde_json::from_str(&stdout(&done)).unwrap();
    let outcome = read.outcome.as_ref().unwrap();
    assert!(outcome.pass);
    for key in ["way_m", "duration_s"] {
        let logged = outcome.metrics[key];
        assert!(
            (found[key].as_f64().unwrap() - logged).abs() < 1e-9,
            "{key}"
        );
    }
    let parameters = found["parameters"].as_array().unwrap();
    let base = parameters
        .iter()
        .find(|named| named[0] == "base_m")
        .unwrap();
    assert!((outcome.metrics["base_m"] - base[1].as_f64().unwrap()).abs() < 1e-6);
    // It drove along the wall, and its true pose is beside the reported one.
    let true_x_m = read.rows.iter().filter_map(|row| row.signal("true_x_m"));
    let (least_m, most_m) = true_x_m.fold((f32::MAX, f32::MIN), |(least, most), x_m| {
        (least.min(x_m as f32), most.max(x_m as f32))
    });
    assert!(most_m - least_m > 1.0, "{least_m} to {most_m}");

    let again = rumbo(logs, &["rerun", &shown]);
    assert!(again.status.success(), "{}", stdout(&again));
    assert!(stdout(&again).contains(": equal, "), "{}", stdout(&again));
    let compared = rumbo(logs, &["compare", &shown, &shown, "--tolerance", "0"]);
    assert!(compared.status.success(), "{}", stderr(&compared));
    assert!(stdout(&compared).contains("radius_left_m"));
    let exported = rumbo(logs, &["export", &shown, "--out", "csv"]);
    assert!(exported.status.success(), "{}", stderr(&exported));
    let listed = stdout(&rumbo(logs, &["list", "logs"]));
    assert!(listed.contains("calibration  seed 3"), "{listed}");
}

#[test]
fn a_calibration_of_another_robot_in_another_world_is_run_again_as_it_was() {
    let folder = tempfile::tempdir().unwrap();
    let logs = folder.path();
    let options = [
        "--world",
        "wall_front",
        "--param",
        "battery.open_circuit_v=7.1",
    ];
    // There is no wall on its right: it does not move, and reports it; its readings are in the log.
    let done = rumbo(logs, &[&["calibrate"], &options[..]].concat());
    assert_eq!(done.status.code(), Some(2));
    assert!(stderr(&done).contains("no wall beside the robot"));
    let log = recorded(logs).pop().unwrap();
    let outcome = log_file::read(&log).unwrap().outcome.unwrap();
    assert!(!outcome.pass && outcome.failures[0].starts_with("no wall beside the robot"));
    let again = rumbo(logs, &["rerun", &log.display().to_string()]);
    assert!(again.status.success(), "{}", stderr(&again));
}

#[test]
fn without_a_log_if_asked_for_none() {
    let folder = tempfile::tempdir().unwrap();
    let done = rumbo(folder.path(), &["calibrate", "--no-record"]);
    assert!(done.status.success());
    assert_eq!(stderr(&done), "");
    assert!(recorded(folder.path()).is_empty());
}
