//! `rumbo run`: what it prints, its exit status, and what it leaves behind.

use super::observe::SPIN;
use crate::support::{file, folder, program, rumbo, stderr, stdout};
use rumbo_experiment::files::Library;
use rumbo_station::log_file;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

/// The objects on stdout, one a line.
fn objects(output: &Output) -> Vec<serde_json::Value> {
    stdout(output)
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect()
}

#[test]
fn a_parameter_of_another_program_is_said_to_be_in_vain() {
    let run = |program: &str| {
        let parameter = ["--program", program, "--param", "front_kp=5"];
        rumbo(&[&["run", "mode1", "--no-record"][..], &parameter].concat())
    };
    assert_eq!(stderr(&run("rumbo")), "");
    let said = stderr(&run("baseline"));
    assert!(
        said.starts_with("note: --param front_kp: is a parameter of Rumbo's"),
        "{said}"
    );
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
            "--no-record",
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
            .all(|run| run["metrics"]["contacts"].is_number() && run["passed"].is_boolean())
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
    let output = rumbo(&["run", "strict.toml", "--no-record"]);
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
        rumbo(&["run", "lenient.toml", "--json", "--no-record"])
            .status
            .code(),
        Some(0)
    );
}

#[test]
fn what_never_happened_misses_its_limit_by_that_word() {
    file("idle.hex", SPIN);
    let output = rumbo(&["run", "mode1", "--firmware", "idle.hex", "--no-record"]);
    let said = stdout(&output);
    assert!(
        said.contains("step1.settling_s = never: limit at most"),
        "{said}"
    );
}

#[test]
fn a_parameter_from_the_command_line_changes_the_run() {
    let settling_s = |param: &str| {
        let output = rumbo(&["run", "mode1", "--json", "--no-record", "--param", param]);
        objects(&output)[0]["metrics"]["step1.rise_s"]
            .as_f64()
            .unwrap()
    };
    assert!(settling_s("front_cruise_m_s=0.15") > settling_s("front_cruise_m_s=0.4") + 1.0);
}

#[test]
fn a_choice_is_made_by_its_name_as_by_its_number() {
    let result = |param: &str| {
        let output = rumbo(&["run", "mode7", "--json", "--no-record", "--param", param]);
        objects(&output)[0]["metrics"].clone()
    };
    let named = result("waypoint_tracker=pure_pursuit");
    assert_eq!(named, result("waypoint_tracker=1"));
    assert_ne!(named, result("waypoint_tracker=straight"));
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
    let folder = folder().join("kept/runs");
    for (line, seed) in stdout(&output).lines().zip([3, 4]) {
        assert_eq!(
            std::fs::read_to_string(folder.join(format!("mode1-{seed}.json")))
                .unwrap()
                .trim(),
            line
        );
        let trace =
            std::fs::read_to_string(folder.join(format!("mode1-{seed}.truth.csv"))).unwrap();
        assert!(trace.starts_with("t_s,") && trace.lines().count() > 800);
        // No sonar at the sides, one in front.
        assert!(trace.contains(",range_left_m,range_right_m,range_front_m,"));
        assert!(trace.lines().nth(1).unwrap().contains(",,,1."));
    }
}

#[cfg(unix)]
#[test]
fn a_campaign_that_is_interrupted_or_terminated_reports_its_results_so_far() {
    reports_its_results_so_far("-INT");
    reports_its_results_so_far("-TERM");
}

#[cfg(target_os = "linux")]
#[test]
fn one_run_that_is_interrupted_says_that_nothing_is_kept() {
    // Counts on a port for ever: no round of that can be left out.
    file("counts.hex", ":06000000039505B9FDCFD8\n:00000001FF\n");
    file(
        "hour.toml",
        "title = \"t\"\nrobot = \"memoria\"\nrig = \"front_single\"\nworld = \"open\"\nmode = 0\nduration_s = 3600\n",
    );
    let arguments = "run hour.toml --firmware counts.hex --out interrupted";
    let run = program()
        .args(arguments.split(' '))
        .current_dir(folder())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let status = format!("/proc/{}/status", run.id());
    let takes_it = || {
        let status = std::fs::read_to_string(&status).unwrap();
        let caught = status.lines().find_map(|line| line.strip_prefix("SigCgt:"));
        u64::from_str_radix(caught.unwrap().trim(), 16).unwrap() & 0b10 != 0
    };
    while !takes_it() {
        std::thread::yield_now();
    }
    let mut interrupt = Command::new("kill");
    interrupt.args(["-INT", &run.id().to_string()]);
    assert!(interrupt.status().unwrap().success());
    let output = run.wait_with_output().unwrap();
    let said = "note: interrupted after 0 of 1 run; nothing is kept\n";
    assert_eq!(
        (output.status.code(), stderr(&output).as_str()),
        (Some(130), said)
    );
    let left = std::fs::read_dir(folder().join("interrupted")).unwrap();
    assert_eq!(left.count(), 0);
}

#[cfg(unix)]
fn reports_its_results_so_far(signal: &str) {
    let mut campaign = program()
        .args(["run", "mode5", "--runs", "1000000", "--json", "--no-record"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(campaign.stdout.take().unwrap()).lines();
    let first = lines.next().unwrap().unwrap();
    let interrupt = Command::new("kill")
        .args([signal, &campaign.id().to_string()])
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

/// Runs with these logs, and what is among them afterwards.
fn recorded(logs: &Path, arguments: &[&str]) -> (Output, Vec<PathBuf>) {
    let mut command = program();
    command.env("RUMBO_LOGS", logs).arg("run").args(arguments);
    let output = command.output().unwrap();
    let files = std::fs::read_dir(logs).into_iter().flatten();
    let mut files: Vec<_> = files.map(|file| file.unwrap().path()).collect();
    files.sort();
    (output, files)
}

#[test]
fn every_run_is_recorded_among_the_sessions_with_the_values_of_its_parameters() {
    let folder = tempfile::tempdir().unwrap();
    let logs = folder.path().join("logs");
    let (output, files) = recorded(&logs, &["mode5", "--json", "--param", "kv=0.03"]);
    let [log] = &files[..] else {
        panic!("{files:?}")
    };
    assert_eq!(stderr(&output), format!("recorded: {}\n", log.display()));
    assert!(log.to_str().unwrap().ends_with("-mode5-1.mcap"));
    let read = log_file::read(log).unwrap();
    let values = read.parameters();
    assert_eq!((values["kv"], values["base_m"]), (0.03, 0.1));
    assert!(read.manifest.unwrap().started.is_some());
    let listed = program()
        .env("RUMBO_LOGS", &logs)
        .args(["list", "logs"])
        .output()
        .unwrap();
    let listed = stdout(&listed);
    assert!(listed.contains("mode5  seed 1"), "{listed}");
    let again = program().arg("rerun").arg(log).output().unwrap();
    assert_eq!(again.status.code(), Some(0), "{}", stdout(&again));

    let (output, files) = recorded(&logs, &["mode5", "mode6", "--runs", "2", "--no-record"]);
    assert_eq!((stderr(&output).as_str(), files.len()), ("", 1));
    let (output, files) = recorded(&logs, &["manual-straight", "--runs", "2"]);
    let said = format!("recorded: 2 logs in {}\n", logs.display());
    assert_eq!((stderr(&output), files.len()), (said, 3));
}

#[test]
fn of_many_runs_those_that_miss_a_limit_are_recorded() {
    let text = "title = \"t\"\nrobot = \"memoria\"\nrig = \"front_single\"\nworld = \"open\"\nmode = 0\nduration_s = 0.2\n";
    let kept = file("brief.toml", text);
    let missed = file(
        "never.toml",
        &format!("{text}[limits]\ncontacts = {{ min = 1 }}\n"),
    );
    let folder = tempfile::tempdir().unwrap();
    for (name, scenario, logs) in [("kept", kept, 0), ("missed", missed, 20)] {
        let scenario = scenario.to_str().unwrap();
        let (output, files) = recorded(&folder.path().join(name), &[scenario, "--runs", "30"]);
        assert_eq!(files.len(), logs, "{}", stdout(&output));
        let said = stderr(&output);
        assert_eq!(
            said.contains("recorded: 20 logs of runs that miss a limit in "),
            logs > 0,
            "{said}"
        );
    }
}

#[test]
fn a_run_that_cannot_be_recorded_is_judged_all_the_same() {
    let logs = file("no_folder", "a file");
    let (output, _) = recorded(&logs, &["manual-straight", "--runs", "2", "--json"]);
    assert!(output.status.code().is_some_and(|status| status < 2));
    assert_eq!(objects(&output).len(), 2);
    let said = stderr(&output);
    assert!(
        said.starts_with("note: not recording: ") && said.lines().count() == 1,
        "{said}"
    );
}
