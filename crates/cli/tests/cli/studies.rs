//! `sweep` and `compare --with`: what is run, kept, gone on with and refused.

#![allow(clippy::unwrap_used, clippy::panic)]

use crate::support;
use serde_json::Value;
use std::path::{Path, PathBuf};
#[cfg(target_os = "linux")]
use std::process::{Command, Stdio};
use support::{Running, program, rumbo, stderr, stdout};

/// An empty folder of this test's, as text.
fn out(name: &str) -> (PathBuf, String) {
    let path = support::folder().join(name);
    let _ = std::fs::remove_dir_all(&path);
    let text = path.display().to_string();
    (path, text)
}

fn sweep(out: &str, more: &[&str]) -> std::process::Output {
    let axes = ["sweep", "mode5", "kv=0.015:0.025:3", "--runs", "2"];
    rumbo(&[&axes[..], &["--by", "rms_rad_s", "--out", out], more].concat())
}

fn read(folder: &Path, name: &str) -> String {
    std::fs::read_to_string(folder.join(name)).unwrap()
}

#[test]
fn a_sweep_writes_tables_a_page_and_logs_and_its_runs_are_those_of_run() {
    let (folder, text) = out("sweep");
    let done = sweep(&text, &["--language", "en"]);
    assert!(done.status.success(), "{}", stderr(&done));
    assert!(stdout(&done).ends_with("index.html\n"));
    let csv = read(&folder, "runs.csv");
    let mut rows = csv.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let header = rows.next().unwrap();
    assert_eq!(header[..4], ["point", "seed", "kv", "passed"]);
    let rows: Vec<_> = rows.collect();
    assert_eq!(rows.len(), 6);
    assert_eq!(rows[3][..3], ["1", "2", "0.02"]);
    let run = rumbo(&[
        "run",
        "mode5",
        "--seed",
        "2",
        "--param",
        "kv=0.02",
        "--json",
        "--no-record",
    ]);
    let run: Value = serde_json::from_slice(&run.stdout).unwrap();
    for (name, value) in header.iter().zip(&rows[3]).skip(4) {
        let expected = run["metrics"][name].as_f64();
        assert_eq!(value.parse::<f64>().ok(), expected, "{name}");
    }
    let page = read(&folder, "index.html");
    let logs: Vec<&str> = page.split("href=\"logs/").skip(1).collect();
    assert!(logs.len() >= 6);
    for log in logs {
        let name = log.split('"').next().unwrap();
        let log = folder.join("logs").join(name).display().to_string();
        let again = rumbo(&["rerun", &log]);
        assert!(again.status.success(), "{name}: {}", stderr(&again));
    }
}

#[test]
fn the_page_of_a_sweep_names_the_limits_that_were_missed() {
    let (folder, text) = out("sweep-missed");
    let axes = ["sweep", "mode1", "front_kp=3,5", "--runs", "1"];
    let done = rumbo(&[&axes[..], &["--language", "en", "--out", &text]].concat());
    assert!(done.status.success(), "{}", stderr(&done));
    let page = read(&folder, "index.html");
    assert!(page.contains("step2: Settling time: 1.") && page.contains("(1/1)"));
    assert!(page.contains("107 → 30 → 50 cm"));
}

#[test]
fn a_sweep_that_was_cut_off_goes_on_to_the_same_bytes() {
    let (whole, whole_text) = out("sweep-whole");
    assert!(sweep(&whole_text, &[]).status.success());
    let (part, part_text) = out("sweep-part");
    std::fs::create_dir_all(&part).unwrap();
    let journal = read(&whole, "runs.jsonl");
    // The header, three runs, and half of a line.
    let cut = journal.match_indices('\n').nth(3).unwrap().0 + 40;
    std::fs::write(part.join("runs.jsonl"), &journal[..cut]).unwrap();
    let refused = sweep(&part_text, &[]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(stderr(&refused).contains("has 3 of 6 runs of this sweep; go on with --resume"));
    assert!(
        sweep(&part_text, &["--resume", "--threads", "1"])
            .status
            .success()
    );
    for name in ["runs.jsonl", "runs.csv", "index.html"] {
        let [one, other] = [&whole, &part].map(|folder| std::fs::read(folder.join(name)).unwrap());
        assert!(one == other, "{name}");
    }
    // A complete one is made again.
    let again = sweep(&part_text, &[]);
    assert!(again.status.success(), "{}", stderr(&again));
    assert_eq!(read(&part, "runs.jsonl"), journal);
    // Another sweep is not gone on with, and a run that is none is named.
    let other = sweep(&part_text, &["--resume", "--seed", "9"]);
    assert!(
        stderr(&other).contains("differs in seed"),
        "{}",
        stderr(&other)
    );
    std::fs::write(
        part.join("runs.jsonl"),
        journal.replacen("\"point\":1", "\"point\":7", 1),
    )
    .unwrap();
    let wrong = sweep(&part_text, &["--resume"]);
    assert!(
        stderr(&wrong).contains("line 4: is a run of another sweep"),
        "{}",
        stderr(&wrong)
    );
}

#[test]
fn a_sweep_keeps_a_page_that_is_not_its_own() {
    let (folder, text) = out("sweep-kept");
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("index.html"), "mine").unwrap();
    let kept = sweep(&text, &[]);
    assert!(stderr(&kept).contains("not of the same run or report"));
    assert_eq!(read(&folder, "index.html"), "mine");
}

#[test]
fn the_page_of_a_sweep_is_served_and_a_click_on_a_run_leads_to_its_replay() {
    let (_, text) = out("sweep-served");
    assert!(sweep(&text, &[]).status.success());
    let served = Running::of(program().args(["replay", &text, "--port", "0", "--no-browser"]));
    let get = |address: &str| {
        let rest = address.strip_prefix("http://").unwrap();
        let (host, path) = rest.split_once('/').unwrap();
        support::get(host, &format!("/{path}"))
    };
    let page = get(&served.said);
    assert!(page.starts_with("HTTP/1.1 200"), "{page}");
    let log = page
        .split("href=\"logs/")
        .nth(1)
        .unwrap()
        .split('"')
        .next()
        .unwrap();
    let answer = get(&format!("{}logs/{log}", served.said));
    assert!(answer.starts_with("HTTP/1.1 303"), "{answer}");
    let place = answer
        .lines()
        .find_map(|line| line.strip_prefix("location: "))
        .unwrap();
    assert!(get(place).contains("<title>Rumbo"), "{place}");
    // No address without the secret, no other file.
    let host = served.said.split('/').nth(2).unwrap();
    assert!(support::get(host, "/").starts_with("HTTP/1.1 404"));
    for name in ["..%2Fruns.csv", "nope.mcap"] {
        let answer = get(&format!("{}logs/{name}", served.said));
        assert!(answer.starts_with("HTTP/1.1 404"), "{answer}");
    }
    served.end();
}

#[test]
fn variants_are_compared_pair_by_pair() {
    let (folder, _) = out("compare");
    std::fs::create_dir_all(&folder).unwrap();
    let page = folder.join("page.html").display().to_string();
    let variants = ["compare", "mode5", "--with", "kv=0", "--with", "kv=0.02"];
    let run = |more: &[&str]| rumbo(&[&variants[..], &["--runs", "4"], more].concat());
    let done = run(&["--out", &page, "--language", "es"]);
    assert!(done.status.success(), "{}", stderr(&done));
    let said = stdout(&done);
    assert!(
        said.contains("1: kv=0, ") && said.contains("2: kv=0.02, "),
        "{said}"
    );
    let shown = read(&folder, "page.html");
    assert!(shown.contains("Diferencia media") && shown.contains("Escalón 1, a "));
    assert!(!shown.contains("step1"));
    let json: Value = serde_json::from_slice(&run(&["--json"]).stdout).unwrap();
    let rise = json["differences"].as_array().unwrap();
    let rise = rise
        .iter()
        .find(|one| one["metric"] == "step1.rise_s")
        .unwrap();
    assert_eq!(rise["pairs"], 4);
    // Less feedforward rises later.
    assert_eq!(rise["better"], 1.0);
    let single = run(&["--threads", "1", "--json"]);
    assert_eq!(
        serde_json::from_slice::<Value>(&single.stdout).unwrap(),
        json
    );
    // The first of a pair is the run of that seed.
    let alone = rumbo(&["run", "mode5", "--param", "kv=0", "--json", "--no-record"]);
    let alone: Value = serde_json::from_slice(&alone.stdout).unwrap();
    assert_eq!(json["variants"][0]["runs"][0]["metrics"], alone["metrics"]);
}

/// What a command says that gets Ctrl-C once it listens for it.
#[cfg(target_os = "linux")]
fn interrupted(arguments: &[&str]) -> String {
    let mut command = program();
    command.args(arguments).current_dir(support::folder());
    command.stdout(Stdio::null()).stderr(Stdio::piped());
    let mut command = command.spawn().unwrap();
    let status = format!("/proc/{}/status", command.id());
    let listens = || {
        let status = std::fs::read_to_string(&status).unwrap();
        let caught = status.lines().find_map(|line| line.strip_prefix("SigCgt:"));
        u64::from_str_radix(caught.unwrap().trim(), 16).unwrap() & 2 != 0
    };
    while !listens() {
        assert!(command.try_wait().unwrap().is_none(), "{arguments:?}");
        std::thread::yield_now();
    }
    let signal = Command::new("kill")
        .args(["-INT", &command.id().to_string()])
        .status();
    assert!(signal.unwrap().success());
    let output = command.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130), "{}", stderr(&output));
    stderr(&output)
}

#[cfg(target_os = "linux")]
#[test]
fn what_is_interrupted_says_what_it_had_done_and_leaves_no_file() {
    let (folder, text) = out("interrupted");
    std::fs::create_dir_all(&folder).unwrap();
    let place = |name: &str| format!("{text}/{name}");
    let said = interrupted(&[
        "compare",
        "mode5",
        "--with",
        "kv=0.03",
        "--runs",
        "100000",
        "--out",
        &place("a.html"),
    ]);
    assert!(
        said.contains("of 200000 runs; nothing is compared or written"),
        "{said}"
    );
    let said = interrupted(&[
        "tune",
        "mode1",
        "--over",
        "front_kp",
        "--runs",
        "20000",
        "--out",
        &place("b.toml"),
    ]);
    assert!(
        said.contains(" % of the search; nothing is written"),
        "{said}"
    );
    assert_eq!(std::fs::read_dir(folder).unwrap().count(), 0);
}

#[test]
fn a_gain_that_is_far_too_small_is_tuned_and_written_to_a_robot_file() {
    let (folder, _) = out("tune");
    std::fs::create_dir_all(&folder).unwrap();
    let robot = folder.join("mine.toml").display().to_string();
    let tune = |more: &[&str]| {
        let begin = ["tune", "mode1", "--for", "settling_s", "--over", "front_kp"];
        let quick = ["--runs", "2000", "--held-out", "10"];
        rumbo(&[&begin[..], &quick, more].concat())
    };
    let done = tune(&["--param", "front_kp=1", "--out", &robot]);
    assert!(done.status.success(), "{}", stderr(&done));
    let said = stdout(&done);
    assert!(said.contains("0 passed, 10 pass"), "{said}");
    let text = read(&folder, "mine.toml");
    assert!(text.contains("# Tuned by `rumbo tune`"), "{text}");
    let run = rumbo(&[
        "run",
        "mode1",
        "--robot",
        &robot,
        "--seed",
        "77",
        "--no-record",
    ]);
    assert!(run.status.success(), "{}", stdout(&run));
    // A file with parameters of one's own is kept.
    let own = text.replace("# Tuned by `rumbo tune`", "# mine");
    std::fs::write(&robot, &own).unwrap();
    let kept = tune(&["--out", &robot]);
    assert_eq!(kept.status.code(), Some(2));
    assert!(stderr(&kept).contains("were not found by this command"));
    assert_eq!(read(&folder, "mine.toml"), own);
}
