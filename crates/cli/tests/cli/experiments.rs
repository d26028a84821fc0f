//! `rumbo experiments`: what it writes, what it prints, and what it refuses.

#![allow(clippy::unwrap_used)]

use crate::support::rumbo_in;
use rumbo_log::{LogKind, Manifest, Truth};
use rumbo_session::headless::RunRecords;
use rumbo_station::headless::record_run;
use rumbo_station::log_file;
use std::path::Path;
use std::process::{Command, Output};

fn experiments(folder: &Path, locale: &str, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_rumbo"))
        .current_dir(folder)
        .env_remove("LC_ALL")
        .env_remove("LC_MESSAGES")
        .env("LANG", locale)
        .arg("experiments")
        .args(arguments)
        .output()
        .unwrap()
}

fn page(folder: &Path) -> String {
    std::fs::read_to_string(folder.join("rumbo-report/report.html")).unwrap()
}

const RECORDING: &str = "dt_ms,left_cm,right_cm,reference_cm,mode,pwm_a,pwm_b\n\
                         900,100,100,30,1,115,115\n2000,99,99,30,1,115,115\n2000,30,30,50,1,80,80\n2000,50,50,50,1,0,0\n";

#[test]
fn the_report_is_in_the_locale_s_language_unless_another_is_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    for (locale, option, language) in [
        ("C", None, "en"),
        ("es_ES.UTF-8", None, "es"),
        ("es_ES.UTF-8", Some("en"), "en"),
    ] {
        let mut arguments = vec!["--force", "--only", "mode1"];
        arguments.extend(option.iter().flat_map(|language| ["--language", *language]));
        let output = experiments(folder.path(), locale, &arguments);
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        let said = String::from_utf8(output.stdout).unwrap();
        assert!(
            said.contains("mode1  ok") && said.contains("report.html"),
            "{said}"
        );
        assert!(page(folder.path()).contains(&format!("<html lang=\"{language}\">")));
    }
}

#[test]
fn the_example_of_another_robot_keeps_the_limits_of_every_mode() {
    let folder = tempfile::tempdir().unwrap();
    let robot = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/my_robot/robot.toml");
    let modes: Vec<String> = (1..=8).map(|mode| format!("mode{mode}")).collect();
    let mut arguments = vec!["--robot", robot.to_str().unwrap(), "--only"];
    arguments.extend(modes.iter().map(String::as_str));
    let output = experiments(folder.path(), "C", &arguments);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
}

#[test]
fn a_recorded_run_stands_beside_ours_and_a_file_of_no_experiment_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let runs = folder.path().join("runs");
    std::fs::create_dir(&runs).unwrap();
    std::fs::write(runs.join("stop.csv"), RECORDING).unwrap();
    std::fs::write(runs.join("other.csv"), "time,value\n1,2\n").unwrap();
    let output = experiments(
        folder.path(),
        "C",
        &["--only", "mode1", "--real", "runs", "--data"],
    );
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert!(
        String::from_utf8(output.stdout)
            .unwrap()
            .contains("other.csv is not shown")
    );
    let page = page(folder.path());
    assert!(
        page.contains("fig-mode1-real") && page.contains("stop.csv") && page.contains("other.csv")
    );
    for file in ["mode1-1.truth.csv", "mode1-1.json", "mode1-1.mcap"] {
        assert!(
            folder.path().join("rumbo-report").join(file).is_file(),
            "{file}"
        );
    }
}

#[test]
fn a_log_of_a_real_robot_stands_beside_ours_and_one_of_a_simulated_robot_does_not() {
    let folder = tempfile::tempdir().unwrap();
    let out = rumbo_in(folder.path(), &["run", "mode5", "--out", "real"]);
    assert!(out.status.success());
    let simulated = folder.path().join("real/mode5-1.mcap");
    let log = log_file::read(&simulated).unwrap();
    // The same as a robot behind a port would have left it.
    let manifest = Manifest {
        kind: LogKind::Robot,
        ..log.manifest.clone().unwrap()
    };
    let end_us = log.link.last().unwrap().t_us;
    let truths: Vec<_> = (0..=end_us / 10_000)
        .map(|tick| (tick * 10_000, Truth::default()))
        .collect();
    let run = RunRecords {
        truths: &truths,
        link: &log.link,
        ..RunRecords::default()
    };
    record_run(&folder.path().join("real/robot.mcap"), &manifest, run).unwrap();
    let output = experiments(folder.path(), "C", &["--only", "mode5", "--real", "real"]);
    let said = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(0), "{said}");
    assert!(
        said.contains("mode5-1.mcap is not shown: it is of a simulated robot"),
        "{said}"
    );
    let page = page(folder.path());
    assert!(
        page.contains("robot.mcap")
            && page.contains("recorded robot, Rumbo")
            && page.contains("fig-mode5-real")
    );
}

#[test]
fn another_seed_is_another_report_and_the_same_one_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let mut pages = ["1", "1", "2"].map(|seed| {
        experiments(
            folder.path(),
            "C",
            &["--force", "--only", "mode1", "--seed", seed],
        );
        page(folder.path())
    });
    assert!(pages[0] == pages[1] && pages[1] != pages[2]);
    // Not only the line that says which seed it was.
    pages[2] = pages[2].replace("<dd>2</dd>", "<dd>1</dd>");
    assert!(pages[1] != pages[2]);
}

#[test]
fn a_missed_limit_is_status_1_and_stands_in_the_report() {
    let folder = tempfile::tempdir().unwrap();
    let robot = folder.path().join("weak.toml");
    let text = include_str!("../../../../robots/memoria.toml")
        .replace("[parameters]", "[parameters]\nfront_brake_m_s2 = 0.8");
    std::fs::write(robot, text).unwrap();
    let output = experiments(
        folder.path(),
        "C",
        &["--only", "mode1", "--robot", "weak.toml"],
    );
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(
        said.contains("MISSED") && said.contains("FAILED, mode1: step1"),
        "{said}"
    );
    assert!(page(folder.path()).contains("verdict bad"));
}
