//! Recording on a disk that fills up: under a session that drives, and after a run.
#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::panic)]

use crate::support;
use rumbo_station::log_file;
use serde_json::json;
use std::process::Command;
use support::{Page, Running, stderr, stdout};

/// `rumbo` whose files may grow to so many blocks of 512 bytes, which the system reports as it does a full disk: by a write that fails.
fn confined(blocks: u32) -> Command {
    let mut command = Command::new("sh");
    command.args([
        "-c",
        &format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$0\" \"$@\""),
        env!("CARGO_BIN_EXE_rumbo"),
    ]);
    command
}

#[test]
fn a_run_on_a_full_disk_is_judged_all_the_same_and_leaves_no_half_of_a_log() {
    let folder = tempfile::tempdir().unwrap();
    let mut command = confined(40);
    command.env("RUMBO_LOGS", folder.path());
    command.args(["run", "mode5", "--runs", "2", "--json"]);
    let output = command.output().unwrap();
    assert!(output.status.code().is_some_and(|status| status < 2));
    assert_eq!(stdout(&output).lines().count(), 2);
    let said = stderr(&output);
    assert!(said.starts_with("note: not recording: "), "{said}");
    assert!(
        said.contains("is the disk full?") && said.lines().count() == 1,
        "{said}"
    );
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn a_full_disk_is_reported_once_driving_goes_on_and_the_log_is_readable_up_to_there() {
    let folder = tempfile::tempdir().unwrap();
    let mut command = confined(40);
    command.args(["lab", "--scenario", "mode5", "--speed", "8", "--no-browser"]);
    command.args(["--port", "0", "--out"]).arg(folder.path());
    let lab = Running::of(&mut command);
    let mut page = Page::open(&lab.said);
    page.wait_for_event("connected");
    page.send(&json!({"type": "arm"}));
    page.wait_for_event("is the disk full?");
    // The robot is still driven: it takes orders, and telemetry comes.
    page.send(&json!({"type": "reference", "value": 4.0}));
    page.wait_for_event("acknowledged");
    let (mut first_s, mut reported) = (None, 0);
    page.wait_for("samples", |message| {
        let events = message["events"].as_array().into_iter().flatten();
        reported += events
            .filter(|event| {
                event["text"]
                    .as_str()
                    .is_some_and(|text| text.contains("disk full"))
            })
            .count();
        let last_s = message["rows"].as_array()?.last()?[0].as_f64()?;
        (last_s > *first_s.get_or_insert(last_s) + 5.0).then_some(())
    });
    assert_eq!(reported, 0, "reported again");
    page.send(&json!({"type": "stop"}));
    page.wait_for_event("STOP: acknowledged");
    drop(page);
    lab.end();
    let path = std::fs::read_dir(folder.path())
        .unwrap()
        .next()
        .unwrap()
        .unwrap()
        .path();
    assert!(path.metadata().unwrap().len() <= 40 * 512);
    let log = log_file::read(&path).unwrap();
    assert!(log.cut.is_some() && log.manifest.is_some());
}
