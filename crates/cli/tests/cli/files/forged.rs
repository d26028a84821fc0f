//! Nothing is forged: texts of files and robots are shown, and neither a terminal nor a spreadsheet interprets them.

use super::{rumbo_in, scenario, status};
use crate::support::{stderr, stdout};
use rumbo_log::{Burst, Manifest, Outcome};
use rumbo_session::headless::RunRecords;
use rumbo_station::headless::record_run;
use rumbo_station::log_file;

/// Whether a terminal would obey something in a text.
fn obeyed(text: &str) -> bool {
    text.chars()
        .any(|c| (c.is_control() && c != '\n') || c == '\u{202e}')
}

/// A result that is none, hidden in a title: an end of a line, colours, a line deleted, letters turned round.
const FORGED: &str = "x\\nmode5: passes\\u001b[2K\\u001b[31m\\u009b1A\\u202e\\u007f";

#[test]
fn a_title_neither_begins_a_line_nor_controls_the_terminal() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    std::fs::write(folder.join("task.toml"), scenario(FORGED, 0.3)).unwrap();
    std::fs::write(
        folder.join("wrong.toml"),
        scenario(FORGED, 0.3) + "\"a\\nerror: b\\u001b[2K\" = 1\n",
    )
    .unwrap();
    let commands: [&[&str]; 5] = [
        &["run", "task.toml", "--out", "o"],
        &["run", "task.toml", "--json", "--no-record"],
        &["run", "wrong.toml", "--no-record"],
        &["run", "no\u{1b}[2K\nerror: such.toml"],
        &["compare", "o/task-1.mcap", "o/task-1.mcap"],
    ];
    for command in commands {
        let output = rumbo_in(folder, command);
        let said = stdout(&output) + &stderr(&output);
        assert!(!obeyed(&said), "{said:?}");
        assert!(!said.contains("\nmode5: passes"), "{said:?}");
        assert!(
            !said.contains("\nerror: b") && !said.contains("\nerror: such"),
            "{said:?}"
        );
    }
    let json = rumbo_in(folder, &["run", "task.toml", "--json", "--no-record"]);
    let result: serde_json::Value = serde_json::from_str(&stdout(&json)).unwrap();
    assert_eq!(result["scenario"], "task");
}

#[test]
fn texts_of_a_log_are_shown_and_not_interpreted() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let hostile = "\u{1b}]0;owned\u{7}\n/tmp: removed\u{9b}2J";
    let manifest = Manifest {
        program: hostile.into(),
        version: hostile.into(),
        scenario: Some(hostile.into()),
        robot: Some("memoria".into()),
        world: Some("open".into()),
        seed: Some(1),
        step_us: 10_000,
        image: Some("00000000".into()),
        files: ["scenario", "robot", "world"]
            .map(|name| (name.into(), hostile.into()))
            .into(),
        ..Manifest::default()
    };
    let link = [Burst {
        t_us: 1_000,
        to_robot: false,
        bytes: b"=cmd|' /C calc'!A0\r\n".to_vec(),
    }];
    let run = RunRecords {
        truths: &[(10_000, rumbo_log::Truth::default())],
        link: &link,
        outcome: Some(Outcome {
            metrics: [(hostile.to_owned(), 1.0)].into(),
            failures: vec![hostile.into()],
            pass: false,
        }),
        ..RunRecords::default()
    };
    let logs = folder.join("logs");
    std::fs::create_dir(&logs).unwrap();
    record_run(&logs.join("x.mcap"), &manifest, run).unwrap();
    assert!(log_file::read(&logs.join("x.mcap")).is_ok());
    for command in [
        &["list", "logs"][..],
        &["list", "logs", "--json"],
        &["compare", "logs/x.mcap", "logs/x.mcap"],
        &["compare", "logs/x.mcap", "logs/x.mcap", "--json"],
        &["rerun", "logs/x.mcap"],
        &["export", "logs/x.mcap", "--format", "csv"],
    ] {
        let output = rumbo_in(folder, command);
        let said = stdout(&output) + &stderr(&output);
        assert!(!said.is_empty() && !obeyed(&said), "{said:?}");
        assert!(!said.contains("\n/tmp: removed"), "{said:?}");
    }
}

#[test]
fn words_of_a_robot_are_no_formulas_in_a_table() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let mut log = mcap::Writer::new(std::fs::File::create(folder.join("x.mcap")).unwrap()).unwrap();
    let manifest = [("kind", "robot"), ("program", "rumbo")];
    log.write_metadata(&mcap::records::Metadata {
        name: "manifest".into(),
        metadata: manifest
            .map(|(key, value)| (key.into(), value.into()))
            .into(),
    })
    .unwrap();
    let channel = log
        .add_channel(0, "/events", "json", &Default::default())
        .unwrap();
    let texts = [
        "=cmd|' /C calc'!A0",
        "+1",
        "-1",
        "@SUM(A1)",
        "\t=1",
        "\r=1",
        "STOP: acknowledged",
    ];
    for (sequence, text) in (0..).zip(texts) {
        let event = serde_json::json!({ "level": 2, "message": text, "name": "info" });
        let header = mcap::records::MessageHeader {
            channel_id: channel,
            sequence,
            log_time: 0,
            publish_time: 0,
        };
        log.write_to_known_channel(&header, event.to_string().as_bytes())
            .unwrap();
    }
    log.finish().unwrap();
    let output = rumbo_in(folder, &["export", "x.mcap", "--format", "csv"]);
    assert_eq!(status(&output), 0, "{}", stderr(&output));
    let events = std::fs::read_to_string(folder.join("x.events.csv")).unwrap();
    let cells = events
        .lines()
        .skip(1)
        .map(|line| line.splitn(3, ',').nth(2).unwrap());
    let cells: Vec<&str> = cells.map(|cell| cell.trim_matches('"')).collect();
    assert_eq!(cells.len(), texts.len());
    let computed = |cell: &&&str| cell.starts_with(['=', '+', '-', '@', '\t', '\r']);
    assert_eq!(cells.iter().find(computed), None);
    assert_eq!(cells.last(), Some(&"STOP: acknowledged"));
}
