//! Misbehaving robots: they ignore STOP, their clocks are wrong, they flood the link, they repeat themselves.
//! Each is reported, no more often than a person can read; a healthy robot behind a bad link never is.
#![allow(clippy::unwrap_used, clippy::panic)]

use crate::support;
use rumbo_control::{AgedRange, Range};
use rumbo_session::Target;
use rumbo_session::anomaly::Anomaly;
use rumbo_session::client::{KnownTable, LinkEvent, RobotClient};
use rumbo_session::fault::{Faults, Faulty};
use rumbo_wire::{
    Ack, Command, Decoder, FrameMessage, FromRobot, Hello, PROTOCOL_VERSION, Received, ResetCause,
    RobotTime, StatusReport, Telemetry, ToRobot,
};
use support::Toy;

const STEP_US: u64 = 5_000;
const NO_TABLE: KnownTable = KnownTable { schema: 0, len: 0 };

/// What a robot sends in a step of 5 ms, given the step's number and whether HELLO was requested.
type Says = fn(u64, bool) -> Vec<FromRobot>;

fn hello() -> FromRobot {
    FromRobot::Hello(Hello {
        protocol: PROTOCOL_VERSION,
        schema: 1,
        image: 0,
        reset: ResetCause::PowerOn,
    })
}

fn status(ms: u64) -> FromRobot {
    FromRobot::Status(StatusReport {
        armed: true,
        at: RobotTime {
            start: 0,
            ms: ms as u32,
        },
        ..StatusReport::default()
    })
}

fn telemetry(ms: u64) -> FromRobot {
    FromRobot::Telemetry(Telemetry {
        t_ms: ms as u16,
        armed: true,
        ..Telemetry::default()
    })
}

/// Frames as a healthy robot sends them, with times distorted by `clock` \[ms\].
fn by_clock(step: u64, asked: bool, clock: impl Fn(u64) -> u64) -> Vec<FromRobot> {
    let ms = step * STEP_US / 1_000;
    let mut said = Vec::new();
    if asked {
        said.extend([hello(), status(clock(ms))]);
    }
    if ms.is_multiple_of(500) {
        said.push(status(clock(ms)));
    }
    if ms.is_multiple_of(40) {
        said.push(telemetry(clock(ms)));
    }
    said
}

/// What is reported of such a robot within so many seconds.
fn reports(seconds: u64, says: Says, order: Option<Command>) -> Vec<LinkEvent> {
    let mut client = RobotClient::new(3, false, NO_TABLE);
    let (mut events, mut sequence) = (Vec::new(), 0);
    let mut decoder = Decoder::<64>::default();
    let mut asked = false;
    for step in 1..=seconds * 1_000_000 / STEP_US {
        let now_us = step * STEP_US;
        let mut bytes = Vec::new();
        for message in says(step, std::mem::take(&mut asked)) {
            bytes.extend_from_slice(message.frame(sequence).bytes());
            sequence = (sequence + 1) % 16;
        }
        client.receive(&bytes, now_us, &mut events);
        if let Some(order) = order
            && step == 400
        {
            client.submit(order, now_us).unwrap();
        }
        bytes.clear();
        client.poll(now_us, &mut bytes, &mut events);
        for byte in bytes {
            if let Some(Received::Frame(body)) = decoder.push(byte) {
                asked |= ToRobot::from_body(&body) == Ok(ToRobot::Hello);
            }
        }
    }
    events
}

fn count(events: &[LinkEvent], wanted: impl Fn(&LinkEvent) -> bool) -> usize {
    events.iter().filter(|item| wanted(item)).count()
}

fn odd(events: &[LinkEvent], anomaly: Anomaly) -> usize {
    count(events, |item| *item == LinkEvent::Anomaly(anomaly))
}

#[test]
fn a_robot_that_ignores_stop_is_an_alarm_within_a_second_and_every_ten() {
    let events = reports(
        32,
        |step, asked| by_clock(step, asked, |ms| ms),
        Some(Command::Stop),
    );
    // STOP after 2 s; reported after 3, 13 and 23 s.
    assert_eq!(
        count(&events, |item| *item == LinkEvent::StopUnconfirmed),
        3
    );
    let others = count(&events, |item| {
        matches!(item, LinkEvent::Anomaly(_) | LinkEvent::Lost)
    });
    assert_eq!(others, 0);
}

#[test]
fn a_robot_that_acknowledges_stop_and_goes_on_is_an_alarm_too() {
    let events = reports(
        16,
        |step, asked| {
            let mut said = by_clock(step, asked, |ms| ms);
            // The answer to the first command.
            if step == 420 {
                said.push(FromRobot::Ack(Ack {
                    session: 3,
                    number: 0,
                    result: Ok(0.0),
                }));
            }
            said
        },
        Some(Command::Stop),
    );
    assert_eq!(
        count(&events, |item| *item == LinkEvent::StopUnconfirmed),
        2
    );
}

#[test]
fn a_clock_that_lies_is_named_once_in_a_while() {
    let liars: [(Says, Anomaly); 6] = [
        (
            |step, asked| by_clock(step, asked, |ms| 10_000_000 - ms),
            Anomaly::ClockBack,
        ),
        (
            |step, asked| {
                by_clock(step, asked, |ms| {
                    ms.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 40
                })
            },
            Anomaly::ClockBack,
        ),
        (
            |step, asked| by_clock(step, asked, |ms| ms + ms / 5_000 * 7_000),
            Anomaly::ClockJump,
        ),
        (
            |step, asked| by_clock(step, asked, |ms| 2 * ms),
            Anomaly::ClockSpeed,
        ),
        (
            |step, asked| by_clock(step, asked, |ms| ms / 2),
            Anomaly::ClockSpeed,
        ),
        (
            |step, asked| by_clock(step, asked, |ms| ms - ms / 10_000 * 3_000),
            Anomaly::ClockBack,
        ),
    ];
    for (number, (says, anomaly)) in liars.into_iter().enumerate() {
        let events = reports(60, says, None);
        let named = odd(&events, anomaly);
        assert!((1..=2).contains(&named), "{number} {anomaly:?}: {named}");
    }
}

#[test]
fn ten_times_the_telemetry_is_a_flood_and_the_same_frames_again_a_repetition() {
    let flood: Says = |step, asked| {
        let mut said = by_clock(step, asked, |ms| ms);
        said.retain(|message| !matches!(message, FromRobot::Telemetry(_)));
        said.push(telemetry(5 * step));
        said
    };
    let events = reports(60, flood, None);
    assert!((1..=2).contains(&odd(&events, Anomaly::Flood)));
    assert_eq!(odd(&events, Anomaly::Repeats), 0);
    // The telemetry of the first second, over and over; and each frame twice.
    let stuck: Says = |step, asked| {
        let mut said = by_clock(step, asked, |ms| ms);
        for message in &mut said {
            if let FromRobot::Telemetry(telemetry) = message {
                telemetry.t_ms %= 1_000;
            }
        }
        said
    };
    let twice: Says = |step, asked| {
        let said = by_clock(step, asked, |ms| ms);
        said.iter().flat_map(|message| [*message; 2]).collect()
    };
    for says in [stuck, twice] {
        let events = reports(60, says, None);
        let named = odd(&events, Anomaly::Repeats);
        assert!((1..=3).contains(&named), "{named}");
    }
}

#[test]
fn a_robot_of_another_protocol_is_named_once_and_gets_no_order() {
    let other: Says = |_, asked| match asked {
        true => vec![FromRobot::Hello(Hello {
            protocol: PROTOCOL_VERSION - 1,
            schema: 1,
            image: 0,
            reset: ResetCause::PowerOn,
        })],
        false => Vec::new(),
    };
    let events = reports(20, other, None);
    assert_eq!(events.len(), 1, "{events:?}");
    assert!(
        matches!(events[0], LinkEvent::OtherProtocol(hello) if hello.protocol == PROTOCOL_VERSION - 1)
    );
}

#[test]
fn a_sound_robot_behind_a_bad_link_is_never_accused() {
    // Bytes lost and flipped, late by up to 1.4 s, cut off, silent for up to a minute: as bad as a link is that still
    // carries telemetry.
    let links = [
        Faults {
            lose: 0.02,
            flip: 0.01,
            cut: 0.05,
            ..Faults::default()
        },
        Faults {
            delay_us: 1_400_000,
            ..Faults::default()
        },
        Faults {
            delay_us: 900_000,
            lose: 0.004,
            flip: 0.008,
            cut: 0.02,
            silent_us: vec![
                5_000_000..5_900_000,
                10_000_000..12_500_000,
                30_000_000..90_000_000,
            ],
            ..Faults::default()
        },
        Faults {
            duplicate: 0.001,
            ..Faults::default()
        },
    ];
    for (number, faults) in links.into_iter().enumerate() {
        for seed in 0..4 {
            let mut robot = Faulty::new(Toy::default(), faults.clone(), seed);
            let mut client = RobotClient::new(3, false, NO_TABLE);
            let (mut events, mut bytes) = (Vec::new(), Vec::new());
            while robot.now_us() < 150_000_000 {
                robot.advance(STEP_US).unwrap();
                let now_us = robot.now_us();
                // It starts again in the middle, twice.
                if now_us == 40_000_000 || now_us == 100_000_000 {
                    robot.target.restart();
                }
                bytes.clear();
                robot.receive(&mut bytes);
                client.receive(&bytes, now_us, &mut events);
                bytes.clear();
                client.poll(now_us, &mut bytes, &mut events);
                robot.send(&bytes).unwrap();
            }
            let accused = count(&events, |item| matches!(item, LinkEvent::Anomaly(_)));
            let odd: Vec<_> = events
                .iter()
                .filter(|item| matches!(item, LinkEvent::Anomaly(_)))
                .collect();
            assert_eq!(accused, 0, "link {number}, seed {seed}: {odd:?}");
            assert!(count(&events, |item| matches!(item, LinkEvent::Telemetry(..))) > 500);
        }
    }
}

#[test]
fn a_robot_that_backs_off_while_its_wheels_count_ahead_is_an_alarm() {
    // The wires of both motors are exchanged, and the wall ahead goes away.
    let says: Says = |step, asked| {
        let mut said = by_clock(step, asked, |ms| ms);
        for message in &mut said {
            if let FromRobot::Telemetry(telemetry) = message {
                let way_m = 0.2 * (step * STEP_US) as f32 / 1e6;
                telemetry.pose.x_m = way_m;
                telemetry.ranges = [AgedRange {
                    range: Range::Valid(0.3 + way_m % 2.0),
                    age_ticks: 0,
                }; 3];
            }
        }
        said
    };
    assert_eq!(odd(&reports(5, says, None), Anomaly::Backward), 1);
    let events = reports(45, says, None);
    assert_eq!(odd(&events, Anomaly::Backward), 2, "again after 30 s");
}
