//! The lab of a page, driven as its worker drives it, by a clock of the test.
#![allow(clippy::unwrap_used, reason = "helpers of tests too")]

use rumbo_browser::{Lab, Shared, Showing, Start};
use rumbo_log::Log;
use std::cell::Cell;

/// What the page gets while the lab is driven for this long, a round every 10 ms.
pub(crate) fn drive(lab: &mut Lab, clock_us: &Cell<u64>, seconds: f64) -> Vec<String> {
    let mut messages = Vec::new();
    for _ in 0..(seconds * 100.0) as u32 {
        clock_us.set(clock_us.get() + 10_000);
        lab.advance(|| clock_us.get(), 0.0).unwrap();
        messages.extend(lab.news());
    }
    messages
}

pub(crate) fn is(kind: &str) -> impl Fn(&&String) -> bool {
    let start = format!("{{\"type\":\"{kind}\"");
    move |message: &&String| message.starts_with(&start)
}

/// The last state of these messages.
pub(crate) fn state(messages: &[String]) -> &str {
    messages.iter().rfind(is("state")).unwrap()
}

#[test]
fn the_page_is_greeted_first_and_gets_what_the_station_sends() {
    let mut lab = Lab::new(Start::default(), 0.0).unwrap();
    let messages = drive(&mut lab, &Cell::new(0), 1.0);
    assert!(is("hello")(&&messages[0]), "{}", messages[0]);
    for kind in [
        "control",
        "scene",
        "state",
        "samples",
        "parameters",
        "events",
    ] {
        assert!(messages.iter().any(|message| is(kind)(&message)), "{kind}");
    }
    assert_eq!(messages.iter().filter(is("hello")).count(), 1);
    // In real time.
    assert!(
        state(&messages).contains("\"t_s\":0.9"),
        "{}",
        state(&messages)
    );
}

#[test]
fn the_robot_is_armed_and_stop_comes_before_all_that_waits() {
    let clock_us = Cell::new(0);
    let mut lab = Lab::new(Start::default(), 0.0).unwrap();
    drive(&mut lab, &clock_us, 1.0);
    lab.order(r#"{"type":"arm"}"#);
    let messages = drive(&mut lab, &clock_us, 0.5);
    assert!(state(&messages).contains("\"armed\":true"));
    lab.order(r#"{"type":"arm"}"#);
    lab.order(r#"{"type":"stop"}"#);
    let messages = drive(&mut lab, &clock_us, 0.5);
    assert!(state(&messages).contains("\"armed\":false"));
}

#[test]
fn what_is_no_order_is_reported_and_the_lab_goes_on() {
    let clock_us = Cell::new(0);
    let mut lab = Lab::new(Start::default(), 0.0).unwrap();
    drive(&mut lab, &clock_us, 0.1);
    lab.order(r#"{"type":"fly"}"#);
    let messages = drive(&mut lab, &clock_us, 0.5);
    let events: String = messages
        .into_iter()
        .filter(|it| is("events")(&it))
        .collect();
    assert!(events.contains("not understood"), "{events}");
}

#[test]
fn a_page_that_slept_does_not_rush_and_a_high_speed_does_not_hold_up_orders() {
    let clock_us = Cell::new(0);
    let mut lab = Lab::new(Start::default(), 0.0).unwrap();
    drive(&mut lab, &clock_us, 0.1);
    lab.order(r#"{"type":"speed","factor":100}"#);
    drive(&mut lab, &clock_us, 0.1);
    clock_us.set(clock_us.get() + 60_000_000);
    // Each look at the clock takes 5 ms: a round ends after 20 ms of them, and not when all is done.
    let looks = Cell::new(0);
    let slow_us = || {
        looks.set(looks.get() + 1);
        clock_us.set(clock_us.get() + 5_000);
        clock_us.get()
    };
    lab.advance(slow_us, 0.0).unwrap();
    assert!(looks.get() <= 6, "{}", looks.get());
}

#[test]
fn a_link_sets_the_experiment_and_one_that_is_wrong_says_where() {
    let clock_us = Cell::new(0);
    let start = Start {
        scenario: "mode5".into(),
        seed: 9,
        parameters: [("link_timeout_s".to_owned(), 0.3)].into(),
        ..Start::default()
    };
    let mut lab = Lab::new(start.clone(), 0.0).unwrap();
    let messages = drive(&mut lab, &clock_us, 20.0);
    let scene = messages.iter().find(is("scene")).unwrap();
    assert!(scene.contains("\"scenario\":\"mode5\"") && scene.contains("\"seed\":9"));
    let table = messages.iter().rfind(is("parameters")).unwrap();
    let (_, from) = table.split_once("\"name\":\"link_timeout_s\"").unwrap();
    let (_, from) = from.split_once("\"value\":").unwrap();
    assert!(from.starts_with("0.3,"), "{}", &from[..20]);
    let wrong = Start {
        parameters: [("link_timeout".to_owned(), 0.3)].into(),
        ..start
    };
    let why = Lab::new(wrong, 0.0).err().unwrap().to_string();
    assert!(why.contains("link_timeout"), "{why}");
}

#[test]
fn the_recording_is_a_log_of_the_run_since_its_reset() {
    let clock_us = Cell::new(0);
    let mut lab = Lab::new(Start::default(), 0.0).unwrap();
    drive(&mut lab, &clock_us, 1.0);
    lab.order(r#"{"type":"reset","scenario":"mode5","world":null,"seed":3}"#);
    drive(&mut lab, &clock_us, 1.0);
    let (name, bytes) = lab.log("2026-11-23T22:40:03Z".into()).unwrap();
    assert_eq!(name, "20261123-224003-mode5-3.mcap");
    let log = Log::read(std::io::Cursor::new(bytes)).unwrap();
    let manifest = log.manifest.as_ref().unwrap();
    assert_eq!(manifest.scenario.as_deref(), Some("mode5"));
    assert_eq!(manifest.seed, Some(3));
    assert!(log.rows.len() > 20 && log.rows.iter().all(|row| row.t_ms <= 1_000));
}

/// The run of a lab that drove for this long, as a file.
fn recorded(seconds: f64) -> Vec<u8> {
    let mut lab = Lab::new(Start::default(), 0.0).unwrap();
    drive(&mut lab, &Cell::new(0), seconds);
    lab.log("2026-11-23T22:40:03Z".into()).unwrap().1
}

#[test]
fn a_recording_is_replayed_in_place_of_the_lab_which_goes_on_where_it_was() {
    let clock_us = Cell::new(0);
    let mut lab = Lab::new(Start::default(), 0.0).unwrap();
    drive(&mut lab, &clock_us, 2.0);
    let showing = Showing::new("robot.mcap", recorded(4.0)).unwrap();
    lab.show(Some(showing));
    let messages = drive(&mut lab, &clock_us, 0.1);
    // As to a page that has just come: all of the log, paused at its beginning.
    assert!(is("hello")(&&messages[0]), "{}", messages[0]);
    let shown = state(&messages);
    assert!(shown.contains(r#""t_s":0.0"#), "{shown}");
    assert!(
        shown.contains(r#""replay":{"name":"robot","duration_s":"#),
        "{shown}"
    );
    assert!(messages.iter().any(|message| is("samples")(&message)));
    lab.order(r#"{"type":"seek","t_s":1.5}"#);
    assert!(state(&drive(&mut lab, &clock_us, 0.1)).contains(r#""t_s":1.5"#));
    lab.order(r#"{"type":"speed","factor":2}"#);
    let played = drive(&mut lab, &clock_us, 0.51);
    assert!(
        state(&played).contains(r#""t_s":2.5"#),
        "{}",
        state(&played)
    );
    lab.order(r#"{"type":"arm"}"#);
    let messages = drive(&mut lab, &clock_us, 0.1).concat();
    assert!(messages.contains("this is a replay: nothing is sent to a robot"));

    lab.show(None);
    let messages = drive(&mut lab, &clock_us, 0.2);
    assert!(is("hello")(&&messages[0]), "{}", messages[0]);
    let shown = state(&messages);
    assert!(
        shown.contains(r#""t_s":2."#) && !shown.contains("replay"),
        "{shown}"
    );
    assert!(shown.contains(r#""armed":false"#), "{shown}");
}

#[test]
fn what_is_no_recording_says_what_it_is_and_a_damaged_one_is_shown_as_far_as_it_goes() {
    let why = |file: &str, bytes: &[u8]| Showing::new(file, bytes.to_vec()).unwrap_err();
    let whole = recorded(3.0);
    assert_eq!(
        why("notes.mcap", b"not a log at all"),
        "notes.mcap: is no MCAP log; give a log of rumbo, or convert a table or a bag with `rumbo import`"
    );
    assert!(why("short.mcap", &whole[..60]).starts_with("short.mcap: ends before"));
    assert!(why("long.mcap", &vec![0; (100 << 20) + 1]).contains("at most 100 MB"));

    let clock_us = Cell::new(0);
    let mut lab = Lab::new(Start::default(), 0.0).unwrap();
    let cut = &whole[..whole.len() * 2 / 3];
    lab.show(Some(Showing::new("cut.mcap", cut.to_vec()).unwrap()));
    let messages = drive(&mut lab, &clock_us, 0.1).concat();
    assert!(messages.contains("the log ends early") || messages.contains("the log is damaged"));
}

/// A run driven by hand: ON, another setpoint, a parameter, a movement held by a key that is let go, OFF.
fn driven_by_hand() -> Shared {
    let clock_us = Cell::new(0);
    let start = Start {
        scenario: "free".into(),
        world: Some("wall_front".into()),
        seed: 5,
        parameters: [("link_timeout_s".to_owned(), 0.4)].into(),
        ..Start::default()
    };
    let mut lab = Lab::new(start, 0.0).unwrap();
    drive(&mut lab, &clock_us, 0.73);
    lab.order(r#"{"type":"arm"}"#);
    drive(&mut lab, &clock_us, 0.41);
    lab.order(r#"{"type":"move_speed","movement":1,"speed_rad_s":4.3333,"held":true}"#);
    drive(&mut lab, &clock_us, 1.5);
    lab.order(r#"{"type":"set_param","id":3,"value":0.123}"#);
    lab.order(r#"{"type":"move_duty","movement":3,"duty":0.3}"#);
    drive(&mut lab, &clock_us, 0.9);
    lab.order(r#"{"type":"disarm"}"#);
    drive(&mut lab, &clock_us, 1.0);
    lab.share()
}

/// What a link of this run opens.
fn linked(shared: &Shared) -> Start {
    Start {
        scenario: "free".into(),
        world: Some("wall_front".into()),
        seed: 5,
        parameters: shared.parameters.clone(),
        drive: shared.drive.clone(),
        until_s: Some(shared.until_s),
        hash: shared.hash.clone(),
        ..Start::default()
    }
}

const THE_SAME: &str = "this is the run of the link, bit for bit";

#[test]
fn a_run_driven_by_hand_is_the_same_to_the_last_bit_where_its_link_is_opened() {
    let shared = driven_by_hand();
    // The movement ends when the key is no longer held.
    assert_eq!(shared.changes, 6, "{:?}", shared.drive);
    assert!(shared.drive.as_ref().unwrap().len() < 200);
    let clock_us = Cell::new(0);
    let mut lab = Lab::new(linked(&shared), 0.0).unwrap();
    // In other rounds.
    lab.order(r#"{"type":"speed","factor":7.7}"#);
    let messages = drive(&mut lab, &clock_us, 1.2).concat();
    assert!(messages.contains(THE_SAME), "{messages}");
    // It can be shared on.
    let again = lab.share();
    assert_eq!(again.drive, shared.drive);

    let other = Start {
        seed: 6,
        ..linked(&shared)
    };
    let mut lab = Lab::new(other, 0.0).unwrap();
    let messages = drive(&mut lab, &clock_us, 6.0).concat();
    assert!(messages.contains("this is not the run of the link"));
}

#[test]
fn an_order_given_by_hand_ends_what_a_link_repeats_and_stop_stays_stop() {
    let clock_us = Cell::new(0);
    let mut lab = Lab::new(linked(&driven_by_hand()), 0.0).unwrap();
    let messages = drive(&mut lab, &clock_us, 1.1);
    assert!(
        state(&messages).contains(r#""armed":true"#),
        "{}",
        state(&messages)
    );
    lab.order(r#"{"type":"stop"}"#);
    let messages = drive(&mut lab, &clock_us, 5.0);
    assert!(state(&messages).contains(r#""armed":false"#));
    let messages = messages.concat();
    assert!(messages.contains("the link drives no further: an order was given here"));
    assert!(!messages.contains(THE_SAME) && !messages.contains("movement"));
}

#[test]
fn a_link_with_too_many_changes_or_wrong_ones_says_so_and_opens_what_it_can() {
    let said = |drive_text: &str| {
        let start = Start {
            drive: Some(drive_text.into()),
            until_s: Some(1.0),
            hash: Some("0".into()),
            ..Start::default()
        };
        let mut lab = Lab::new(start, 0.0).unwrap();
        drive(&mut lab, &Cell::new(0), 1.5)
    };
    let many = vec!["0.5 arm"; 17].join("*");
    let messages = said(&many);
    assert!(state(&messages).contains(r#""armed":true"#));
    assert!(
        messages
            .concat()
            .contains("the link has 17 changes of commands")
    );
    let messages = said("0.5 arm*0.4 stop");
    assert!(state(&messages).contains(r#""armed":false"#));
    assert!(
        messages
            .concat()
            .contains("the link's commands are left out")
    );
}

#[test]
fn a_run_that_no_link_can_repeat_says_why() {
    let clock_us = Cell::new(0);
    let mut lab = Lab::new(Start::default(), 0.0).unwrap();
    drive(&mut lab, &clock_us, 1.0);
    for value in 0..17 {
        lab.order(&format!(
            r#"{{"type":"reference","value":0.{}}}"#,
            value + 30
        ));
        drive(&mut lab, &clock_us, 0.3);
    }
    let shared = lab.share();
    assert_eq!((shared.changes, &shared.drive), (17, &None));
    assert!(shared.why_not.unwrap().contains("at most 16"));
    lab.order(r#"{"type":"save_params"}"#);
    drive(&mut lab, &clock_us, 1.0);
    lab.order(r#"{"type":"reset","scenario":"mode5","world":null,"seed":3}"#);
    drive(&mut lab, &clock_us, 1.0);
    assert!(lab.share().why_not.unwrap().contains("saved on it"));
}

#[test]
fn an_edited_world_is_in_what_is_shared_and_is_driven_in_from_the_link_again() {
    let clock_us = Cell::new(0);
    let mut lab = Lab::new(Start::default(), 0.0).unwrap();
    drive(&mut lab, &clock_us, 0.5);
    let world = r#"{\"title\":\"Mine\",\"box\":[{\"centre_m\":[0.9,0],\"size_m\":[0.2,0.4]}],\"start\":{\"x_m\":0.1}}"#;
    let order = |act: &str, ticket: u32| {
        format!(r#"{{"type":"world","ticket":{ticket},"act":"{act}","text":"{world}"}}"#)
    };
    lab.order(&order("check", 1));
    let answer = drive(&mut lab, &clock_us, 0.1);
    let answer = answer.iter().find(is("world")).unwrap();
    assert!(
        answer.contains(r#""ticket":1"#) && answer.contains(r#""problem":null"#),
        "{answer}"
    );
    assert_eq!(lab.share().edited, None);
    lab.order(&order("drive", 2));
    let messages = drive(&mut lab, &clock_us, 1.0);
    let answer = messages.iter().find(is("world")).unwrap();
    assert!(answer.contains(r#""driven":true"#), "{answer}");
    assert!(state(&messages).contains("\"armed\":false"));
    let opened = Start {
        edited: lab.share().edited,
        ..Start::default()
    };
    assert!(
        opened.edited.as_ref().unwrap().contains("Mine"),
        "{opened:?}"
    );
    // What is done by hand from its start on goes into a link too.
    let clock_us = Cell::new(0);
    let mut lab = Lab::new(opened, 0.0).unwrap();
    drive(&mut lab, &clock_us, 1.0);
    lab.order(r#"{"type":"arm"}"#);
    drive(&mut lab, &clock_us, 2.0);
    let shared = lab.share();
    let start = Start {
        edited: shared.edited.clone(),
        drive: shared.drive.clone(),
        until_s: Some(shared.until_s),
        hash: shared.hash.clone(),
        ..Start::default()
    };
    let clock_us = Cell::new(0);
    let mut linked = Lab::new(start, 0.0).unwrap();
    let messages = drive(&mut linked, &clock_us, shared.until_s + 1.0);
    let events: String = messages
        .into_iter()
        .filter(|it| is("events")(&it))
        .collect();
    assert!(events.contains("bit for bit"), "{events}");
}
