//! What the robot sends: how often, in how many bytes, as frames or text.

use crate::support;
use rumbo_control::Micros;
use rumbo_control::mode::ModeId;
use rumbo_control::params::SCHEMA;
use rumbo_wire::text::TextRow;
use rumbo_wire::{Command, FromRobot, Hello, PROTOCOL_VERSION, ResetCause, ToRobot};
use support::Bench;

#[test]
fn introduces_itself_first_and_when_asked() {
    let mut bench = Bench::alive();
    let hello = Hello {
        protocol: PROTOCOL_VERSION,
        schema: SCHEMA,
        image: 0,
        reset: ResetCause::PowerOn,
    };
    assert_eq!(bench.received.first(), Some(&FromRobot::Hello(hello)));
    bench.received.clear();
    bench.send(&ToRobot::Hello);
    bench.ticks(20);
    assert!(bench.received.contains(&FromRobot::Hello(hello)));
}

#[test]
fn sends_25_telemetry_frames_a_second_in_750_bytes_and_two_statuses_beside() {
    let mut bench = Bench::alive();
    bench.drive();
    bench.ticks(100);
    bench.received.clear();
    let before = bench.bytes;
    bench.ticks(1_000);
    let telemetry = bench.telemetry().len();
    let statuses = bench.received.len() - telemetry;
    assert!(
        (249..=251).contains(&telemetry),
        "{telemetry} telemetry frames in 10 s"
    );
    assert!(
        (19..=21).contains(&statuses),
        "{statuses} other frames in 10 s"
    );
    let bytes = bench.bytes - before;
    assert!(bytes <= 8_100, "{bytes} bytes in 10 s");
}

#[test]
fn a_change_is_reported_at_once() {
    let mut bench = Bench::alive();
    bench.command(Command::Mode(ModeId::WheelSpeed)).unwrap();
    assert_eq!(
        bench.status().mode,
        ModeId::WheelSpeed,
        "within the wait for the answer, 0.2 s"
    );
    bench.command(Command::Reference(2.5)).unwrap();
    assert_eq!(bench.status().reference.numbers(), [2.5; 2]);
}

#[test]
fn a_silent_link_drops_telemetry_counts_it_and_keeps_room_for_answers() {
    let mut bench = Bench::alive();
    bench.link_up = false;
    bench.ticks(300);
    bench.send(&ToRobot::Command {
        session: 1,
        number: 1,
        command: Command::GetParam { id: 0 },
        seen: bench.seen,
    });
    bench.link_up = true;
    bench.ticks(100);
    assert!(bench.status().dropped > 50);
    assert_eq!(bench.acks().len(), 1);
}

#[test]
fn answers_in_the_language_in_which_it_was_addressed() {
    let mut bench = Bench::alive();
    bench.heartbeats = false;
    bench.line("MODE 5");
    bench.ticks(30);
    let frames = bench.received.len();
    bench.ticks(100);
    assert_eq!(bench.received.len(), frames, "no frames for a terminal");
    assert!(bench.lines.len() >= 8);
    let Ok(TextRow::Speed(row)) = TextRow::parse(bench.lines.last().unwrap()) else {
        panic!("{:?}", bench.lines.last())
    };
    assert_eq!((row.mode, row.dt_ms), (5, 100));
    bench.send(&ToRobot::Heartbeat);
    bench.ticks(50);
    assert!(bench.received.len() > frames);
}

#[test]
fn the_original_commands_drive_it_for_10_s_after_the_last_line_and_off_clears_the_fault() {
    let mut bench = Bench::alive();
    bench.heartbeats = false;
    for line in ["MODE 5", "REF 40", "ON"] {
        bench.line(line);
        bench.ticks(5);
    }
    bench.ticks(900);
    assert!(bench.is_driven());
    let Ok(TextRow::Speed(row)) = TextRow::parse(bench.lines.last().unwrap()) else {
        panic!("{:?}", bench.lines.last())
    };
    assert_eq!(row.reference_rpm, 40.0);
    assert!((row.wheel_rpm.right - 40.0).abs() < 4.0, "{row:?}");
    bench.ticks(150);
    assert!(!bench.is_driven());
    assert!(bench.lines.contains(&"FLT 1".to_owned()));
    bench.line("ON");
    bench.ticks(20);
    assert!(
        !bench.is_driven() && bench.lines.contains(&"ERR 6".to_owned()),
        "a fault is latched"
    );
    bench.line("OFF");
    bench.line("ON");
    bench.ticks(20);
    assert!(bench.is_driven());
}

#[test]
fn text_references_are_in_the_units_of_the_mode_and_off_stops() {
    let mut bench = Bench::alive();
    bench.heartbeats = false;
    bench.line("MODE 1");
    bench.line("REF 45");
    bench.ticks(60);
    let Ok(TextRow::Distance(row)) = TextRow::parse(bench.lines.last().unwrap()) else {
        panic!("{:?}", bench.lines.last())
    };
    assert_eq!((row.reference_cm, row.mode), (45.0, 1));
    assert!((row.left_cm - 100.0).abs() < 0.5, "{row:?}");
    bench.line("ON");
    bench.ticks(20);
    assert!(bench.is_driven());
    bench.line("OFF");
    bench.ticks(1);
    assert!(!bench.is_driven());
}

#[test]
fn gains_in_text_are_set_together_or_not_at_all() {
    let mut bench = Bench::alive();
    bench.line("PID A 1 0.5 0");
    bench.ticks(5);
    bench.line("PID A 2 -1 0");
    bench.line("nonsense");
    bench.ticks(50);
    assert!(bench.lines.contains(&"ERR 2".to_owned()) && bench.lines.contains(&"ERR 9".to_owned()));
    // One PWM count of 255 per rpm, in rad/s.
    let id = rumbo_control::params::ParamId::SpeedKpRight as u8;
    let kp = bench.command(Command::GetParam { id }).unwrap();
    assert!(
        (kp - 1.0 / 255.0 * 60.0 / core::f32::consts::TAU).abs() < 1e-6,
        "{kp}"
    );
}

#[test]
fn milliseconds_wrap_after_65_s_and_not_with_the_microseconds() {
    let mut bench = Bench::at(Micros(u32::MAX - 30_000_000));
    bench.ticks(7_000);
    let telemetry = bench.telemetry();
    assert!(
        telemetry
            .windows(2)
            .all(|two| two[1].t_ms.wrapping_sub(two[0].t_ms) == 40)
    );
    assert!(telemetry.last().is_some_and(|last| last.t_ms < 5_000));
}

#[test]
fn in_mode_7_the_text_shows_speeds_references_pose_and_pwm_as_the_original_did() {
    let mut bench = Bench::alive();
    bench.heartbeats = false;
    for line in ["MODE 7", "GOAL 0.5 0", "ON"] {
        bench.line(line);
        bench.ticks(5);
    }
    bench.ticks(100);
    let Ok(TextRow::Waypoints(row)) = TextRow::parse(bench.lines.last().unwrap()) else {
        panic!("{:?}", bench.lines.last())
    };
    assert!(row.x_m > 0.05 && row.y_m.abs() < 0.05, "{row:?}");
    assert!(
        row.reference_rpm.left > 20.0 && row.wheel_rpm.right > 20.0,
        "{row:?}"
    );
    assert!(row.pwm.left > 0 && row.heading_deg.abs() < 20.0, "{row:?}");
}
