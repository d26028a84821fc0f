//! `docs/protocol.md` matches the code: its examples, numbers and columns are computed here.
#![allow(clippy::unwrap_used, reason = "a test helper")]

use rumbo_control::{AgedRange, Duty, Pose, Range, Velocity, Wheels};
use rumbo_wire::frame::MAX_FRAME;
use rumbo_wire::text::RowKind;
use rumbo_wire::*;

const DOC: &str = include_str!("../../../../docs/protocol.md");

fn hex(bytes: &[u8]) -> String {
    bytes
        .iter()
        .map(|byte| format!("{byte:02x}"))
        .collect::<Vec<_>>()
        .join(" ")
}

#[track_caller]
fn said(text: &str) {
    assert!(DOC.contains(text), "docs/protocol.md should say:\n{text}");
}

/// The content inside COBS and CRC.
fn body(frame: &Frame) -> Vec<u8> {
    cobs::decode_vec(frame.bytes().split_last().unwrap().1).unwrap()
}

#[test]
fn the_worked_example_of_a_command_is_right() {
    let command = Command::Reference(0.5);
    let frame = ToRobot::Command {
        session: 0x51,
        number: 7,
        command,
        seen: RobotTime {
            start: 4,
            ms: 81_500,
        },
    }
    .frame(2);
    said(&format!(
        "header and payload   {}\n",
        hex(&body(&frame)[..14])
    ));
    said(&format!("with the CRC         {}\n", hex(&body(&frame))));
    said(&format!("on the wire          {}\n", hex(frame.bytes())));
    let ack = FromRobot::Ack(Ack {
        session: 0x51,
        number: 7,
        result: Ok(0.5),
    })
    .frame(9);
    said(&format!("on the wire          {}\n", hex(ack.bytes())));
}

#[test]
fn the_worked_example_of_telemetry_is_right() {
    let aged = AgedRange::fresh;
    let telemetry = Telemetry {
        t_ms: 12_345,
        pose: Pose {
            x_m: 1.5,
            y_m: -0.25,
            heading_rad: core::f32::consts::FRAC_PI_2,
        },
        wheel_rad_s: [Wheels::both(6.24), Wheels::both(6.26)],
        wheel_ref_rad_s: Wheels::both(6.26),
        duty: Wheels {
            left: Duty::new(120),
            right: Duty::new(118),
        },
        state: 2,
        armed: true,
        faulted: false,
        servo_rad: -30f32.to_radians(),
        ranges: [
            aged(Range::Clear),
            aged(Range::Faulty),
            aged(Range::Valid(0.3)),
        ],
    };
    let frame = FromRobot::Telemetry(telemetry).frame(3);
    said(&format!(
        "payload              {}\n",
        hex(&body(&frame)[1..26])
    ));
    said(&format!("on the wire          {}\n", hex(frame.bytes())));
}

#[test]
fn the_numbers_of_the_tables_are_right() {
    said(&format!("{} on the wire", MAX_FRAME));
    let sizes = [
        (
            FromRobot::Hello(Hello {
                protocol: 1,
                schema: 0,
                image: 0,
                reset: ResetCause::PowerOn,
            })
            .frame(0),
            "1 | robot | HELLO",
        ),
        (
            FromRobot::Telemetry(Telemetry::default()).frame(0),
            "2 | robot | telemetry",
        ),
        (
            FromRobot::Status(StatusReport::default()).frame(0),
            "3 | robot | status",
        ),
        (
            FromRobot::HeadingRef(0.0).frame(0),
            "6 | robot | heading reference",
        ),
        (ToRobot::Hello.frame(0), "8 | station | HELLO"),
        (ToRobot::Heartbeat.frame(0), "9 | station | heartbeat"),
        (
            ToRobot::Velocity {
                velocity: Velocity::default(),
                seen: RobotTime::default(),
            }
            .frame(0),
            "11 | station | velocity",
        ),
    ];
    for (frame, row) in sizes {
        let wire = frame.bytes().len();
        said(&format!("| {row} | {} | {wire} |", wire - 5));
    }
    assert_eq!(PROTOCOL_VERSION, 3, "say so in docs/protocol.md");
}

#[test]
fn every_column_of_the_text_is_listed() {
    for kind in RowKind::ALL {
        let names: Vec<_> = kind.columns().iter().map(|column| column.name).collect();
        said(&format!("`{}`", names.join(",")));
    }
}
