//! Tuning from the dashboard: what `rumbo tune` finds, beside a session that goes on.

#![allow(clippy::unwrap_used, clippy::panic)]

use crate::support;
use serde_json::{Value, json};
use support::{Page, Running, rumbo};

/// A lab, its page in control, and the number of that.
fn lab() -> (Running, Page, u64) {
    let logs = support::folder().join("tuning");
    let logs = logs.display().to_string();
    let running = Running::start(&["lab", "--no-browser", "--port", "0", "--out", &logs]);
    let mut page = Page::open(&running.said);
    let number = page.wait_for("number", |message| message["page"].as_u64());
    page.wait_for_event("connected");
    (running, page, number)
}

fn search(page: &Page, number: u64, request: &Value) -> Page {
    let mut search = page.beside(&format!("/tune/search?page={number}"));
    search.send(request);
    search
}

#[test]
fn a_page_s_search_finds_what_the_command_finds_and_stop_works_meanwhile() {
    let file = support::folder().join("tuned-by-command.toml");
    let _ = std::fs::remove_file(&file);
    let by_command = rumbo(&[
        "tune",
        "mode1",
        "--for",
        "settling_s, overshoot_m < 0.05",
        "--over",
        "front_kp,front_brake_m_s2",
        "--param",
        "front_kp=1",
        "--runs",
        "2000",
        "--seed",
        "3",
        "--json",
        "--out",
        file.to_str().unwrap(),
    ]);
    let expected: Value = serde_json::from_slice(&by_command.stdout).unwrap();

    let (_running, mut page, number) = lab();
    let request = json!({
        "scenario": "mode1",
        "over": ["front_kp", "front_brake_m_s2"],
        "params": { "front_kp": 1.0 },
        "aims": "settling_s, overshoot_m < 0.05",
        "runs": 2000,
        "seed": 3,
    });
    let mut search = search(&page, number, &request);
    search.wait_for("news of the search", |message| message["share"].as_f64());
    page.send(&json!({ "type": "arm" }));
    page.wait_for("armed robot", |message| {
        (message["state"]["robot"]["armed"] == true).then_some(())
    });
    page.send(&json!({ "type": "stop" }));
    page.wait_for_event("STOP: acknowledged");
    let mut found = search.wait_for("end of the search", |message| {
        assert!(message.get("error").is_none(), "{message}");
        message.get("found").cloned()
    });
    let text = found.as_object_mut().unwrap().remove("robot_file").unwrap();
    assert_eq!(found, expected);
    let written = std::fs::read_to_string(&file).unwrap();
    assert_eq!(text.as_str().unwrap(), written);
}

#[test]
fn what_cannot_be_tuned_is_refused_in_the_words_of_the_command_line() {
    let (_running, page, number) = lab();
    let request = |changes: Value| {
        let mut request = json!({ "scenario": "mode1", "over": ["front_kp"], "seed": 1 });
        for (key, value) in changes.as_object().unwrap() {
            request[key] = value.clone();
        }
        request
    };
    let many: Vec<String> = (0..13).map(|number| format!("front_kp{number}")).collect();
    for (changes, why) in [
        (json!({ "over": ["front_kq"] }), "did you mean `front_kp`"),
        (json!({ "over": [] }), "choose a parameter"),
        (json!({ "over": many }), "at most 12 parameters"),
        (json!({ "aims": "setling_s" }), "did you mean `settling_s`"),
        (
            json!({ "aims": "x".repeat(501) }),
            "longer than 500 characters",
        ),
        (json!({ "runs": 200_001 }), "at most 200000 runs"),
        (json!({ "params": { "front_kp": 1e9 } }), "front_kp"),
        (json!({ "scenario": "mode11" }), "unknown scenario `mode11`"),
        (
            json!({ "scenario": "./scenarios/mode1.toml" }),
            "unknown scenario",
        ),
        (json!({ "scenario": "calibration" }), "has no limits"),
        (json!({ "threads": 99 }), "unknown field `threads`"),
    ] {
        let mut search = search(&page, number, &request(changes.clone()));
        let said = search.wait_for("refusal", |message| {
            message["error"].as_str().map(str::to_owned)
        });
        assert!(said.contains(why), "{changes}: {said}");
    }
}
