//! A real robot at a port of the page, with a simulated one at the other end of the port.
#![allow(clippy::unwrap_used, reason = "helpers of tests too")]

use rumbo_browser::Robot;
use rumbo_experiment::files::Overrides;
use rumbo_lab::SimulatedRobot;
use rumbo_log::{Choice, Log, LogKind};
use rumbo_session::Target;
use std::io::Cursor;

const ROUND_US: u64 = 5_000;
const STOP: &str = r#"{"type":"stop"}"#;

/// A page and a robot with a port in between.
struct Bench {
    page: Robot,
    robot: SimulatedRobot,
    now_us: u64,
    plugged: bool,
    to_robot: Vec<u8>,
}

impl Bench {
    fn new(ids: fn() -> u8) -> Self {
        let choice = Choice {
            scenario: "mode5".into(),
            world: None,
            rig: None,
            seed: 1,
        };
        Self {
            page: Robot::new("USB 2341:0042".into(), 9_600, false, ids, 7, 0.0).unwrap(),
            robot: SimulatedRobot::new(Overrides::default(), choice).unwrap(),
            now_us: 7,
            plugged: true,
            to_robot: Vec::new(),
        }
    }

    /// What the page gets within this time.
    fn pass(&mut self, seconds: f64) -> String {
        let mut messages = Vec::new();
        for _ in 0..(seconds * 1e6) as u64 / ROUND_US {
            self.now_us += ROUND_US;
            self.robot.advance(ROUND_US).unwrap();
            let mut bytes = Vec::new();
            self.robot.receive(&mut bytes);
            if self.plugged {
                self.page.arrived(&bytes);
            }
            let now_us = self.now_us;
            self.page.advance(|| now_us, 0.0).unwrap();
            let bytes = self.page.take_outgoing();
            self.to_robot.extend(&bytes);
            if self.plugged {
                self.robot.send(&bytes).unwrap();
            }
            messages.extend(self.page.news());
        }
        messages.join("\n")
    }

    fn turns(&self) -> bool {
        let wheels = self.robot.truth().unwrap().wheel_rad_s;
        wheels.left.abs() > 1.0 || wheels.right.abs() > 1.0
    }
}

fn connected() -> Bench {
    let mut bench = Bench::new(|| 7);
    let said = bench.pass(2.0);
    assert!(said.contains("\"connected\":true"), "{said}");
    bench
}

fn driving() -> Bench {
    let mut bench = connected();
    for order in [
        r#"{"type":"mode","mode":5}"#,
        r#"{"type":"wheel_reference","left":6,"right":6}"#,
        r#"{"type":"arm"}"#,
    ] {
        bench.page.order(order);
    }
    let said = bench.pass(1.5);
    assert!(said.contains("ON: acknowledged"), "{said}");
    assert!(bench.turns());
    bench
}

#[test]
fn it_connects_as_the_station_does_and_waits_for_on() {
    let mut bench = Bench::new(|| 7);
    let said = bench.pass(3.0);
    assert!(said.starts_with("{\"type\":\"hello\""), "{said}");
    let last = said.lines().rfind(|it| it.contains("\"type\":\"state\""));
    for part in [
        "\"armed\":false",
        "\"simulated\":false",
        "\"connected\":true",
    ] {
        assert!(last.unwrap().contains(part), "{part}: {last:?}");
    }
    assert!(!bench.turns());
}

#[test]
fn it_drives_and_stop_comes_before_all_that_waits() {
    let mut bench = driving();
    bench.page.order(r#"{"type":"reference","value":9}"#);
    bench.page.order(STOP);
    let said = bench.pass(1.5);
    assert!(said.contains("STOP: acknowledged"), "{said}");
    assert!(!bench.turns());
}

#[test]
fn without_its_heartbeat_the_robot_stops_and_a_port_that_is_back_needs_a_new_on() {
    let mut bench = driving();
    bench.plugged = false;
    bench.page.lost("The device has been lost.");
    let mut said = bench.pass(0.1);
    bench.page.order(r#"{"type":"reference","value":9}"#);
    said += &bench.pass(1.0);
    assert!(
        said.contains("port USB 2341:0042 is gone (The device has been lost.); waiting for it"),
        "{said}"
    );
    assert!(said.contains("refused, the port is gone"), "{said}");
    assert!(!bench.turns());
    let lost = bench.to_robot.len();
    bench.pass(1.0);
    assert_eq!(bench.to_robot.len(), lost, "nothing is queued for it");
    bench.plugged = true;
    bench.page.back("USB 1a86:7523");
    let said = bench.pass(2.5);
    assert!(said.contains("port USB 1a86:7523 is back"), "{said}");
    assert!(said.contains("\"connected\":true"), "{said}");
    assert!(!bench.turns());
}

#[test]
fn a_stop_given_while_the_port_is_gone_is_the_only_order_sent_when_it_is_back() {
    let mut bench = driving();
    bench.plugged = false;
    bench.page.lost("gone");
    bench.page.order(r#"{"type":"arm"}"#);
    bench.page.order(STOP);
    bench.pass(0.2);
    bench.plugged = true;
    bench.page.back("USB 2341:0042");
    let said = bench.pass(2.0);
    assert!(said.contains("STOP: acknowledged"), "{said}");
    assert!(!said.contains("ON: acknowledged"), "{said}");
    assert!(!bench.turns());
}

#[test]
fn two_sessions_are_told_apart_by_their_numbers() {
    let bytes = [(|| 7) as fn() -> u8, || 8, || 8].map(|ids| {
        let mut bench = Bench::new(ids);
        bench.pass(2.0);
        bench.page.order(r#"{"type":"arm"}"#);
        bench.pass(0.5);
        bench.to_robot
    });
    assert_ne!(bytes[0], bytes[1]);
    assert_eq!(bytes[1], bytes[2]);
}

#[test]
fn the_session_is_saved_a_piece_at_a_time_as_a_log_of_a_robot_at_a_port() {
    let mut bench = driving();
    bench.page.save("2026-11-24T09:40:03Z".into()).unwrap();
    let mut pieces = 0;
    let (name, bytes) = loop {
        pieces += 1;
        // A clock at which every look takes a second: as little as there is in each piece.
        let clock = std::cell::Cell::new(0);
        let late = || clock.replace(clock.get() + 1_000_000);
        if let Some(saved) = bench.page.saved(late).unwrap() {
            break saved;
        }
    };
    assert!(pieces > 5, "{pieces}");
    assert_eq!(name, "20261124-094003-robot.mcap");
    let log = Log::read_replay(Cursor::new(bytes)).unwrap();
    let manifest = log.manifest.unwrap();
    assert_eq!(manifest.kind, LogKind::Robot);
    assert_eq!(manifest.port.as_deref(), Some("USB 2341:0042"));
    assert!(
        log.events
            .iter()
            .any(|event| event.text.contains("ON: acknowledged"))
    );
}

#[test]
fn a_link_too_slow_for_heartbeats_is_refused() {
    let slow = Robot::new("port".into(), 300, false, || 7, 0, 0.0);
    assert!(slow.err().unwrap().to_string().contains("heartbeats"));
}
