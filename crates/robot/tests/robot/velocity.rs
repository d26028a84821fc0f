//! Velocities of mode 10: the newest one counts, none is driven late, and without one the wheels are released.
#![allow(clippy::unwrap_used, reason = "a test helper")]

use crate::support;
use rumbo_control::Velocity;
use rumbo_control::mode::ModeId;
use rumbo_wire::{Command, RobotTime, ToRobot};
use support::Bench;

const AHEAD: Velocity = Velocity {
    forward_m_s: 0.2,
    yaw_rad_s: 0.0,
};

/// In mode 10, armed.
fn armed() -> Bench {
    let mut bench = Bench::alive();
    bench.command(Command::Mode(ModeId::Twist)).unwrap();
    bench.command(Command::Arm).unwrap();
    bench
}

/// A velocity issued this long ago.
fn aged(bench: &mut Bench, velocity: Velocity, age_ms: u32) {
    let now = bench.time();
    let seen = RobotTime {
        ms: now.ms - age_ms,
        ..now
    };
    bench.send(&ToRobot::Velocity { velocity, seen });
}

#[test]
fn drives_while_velocities_come_and_half_a_second_longer() {
    let mut bench = armed();
    assert!(!bench.is_driven(), "ON alone drives nothing");
    for _ in 0..20 {
        aged(&mut bench, AHEAD, 0);
        bench.ticks(5);
    }
    assert!(bench.is_driven());
    bench.ticks(45);
    assert!(bench.is_driven());
    bench.ticks(2);
    assert!(!bench.is_driven());
    assert!(bench.status().armed, "it waits for the next one");
    aged(&mut bench, AHEAD, 0);
    bench.ticks(3);
    assert!(bench.is_driven());
}

#[test]
fn a_velocity_older_than_300_ms_or_of_another_start_or_of_later_moves_nothing() {
    let mut bench = armed();
    aged(&mut bench, AHEAD, 310);
    bench.ticks(3);
    let now = bench.time();
    for (start, ms) in [(now.start + 1, now.ms), (now.start, now.ms + 1_000)] {
        let seen = RobotTime { start, ms };
        bench.send(&ToRobot::Velocity {
            velocity: AHEAD,
            seen,
        });
        bench.ticks(3);
    }
    assert!(!bench.is_driven());
    aged(&mut bench, AHEAD, 300);
    bench.ticks(3);
    assert!(bench.is_driven());
}

#[test]
fn a_velocity_neither_arms_nor_waits_for_on() {
    let mut bench = Bench::alive();
    bench.command(Command::Mode(ModeId::Twist)).unwrap();
    aged(&mut bench, AHEAD, 0);
    bench.ticks(5);
    assert!(!bench.status().armed && !bench.is_driven());
    bench.command(Command::Arm).unwrap();
    assert!(!bench.is_driven());
}

#[test]
fn stop_counts_whatever_velocities_follow() {
    let mut bench = armed();
    aged(&mut bench, AHEAD, 0);
    bench.ticks(5);
    assert!(bench.is_driven());
    bench.command(Command::Stop).unwrap();
    for _ in 0..20 {
        aged(&mut bench, AHEAD, 0);
        bench.ticks(2);
        assert!(!bench.is_driven());
    }
}

#[test]
fn another_mode_and_what_no_robot_drives_take_no_notice() {
    let mut bench = armed();
    for wrong in [f32::NAN, f32::INFINITY, 1.5, -40.0] {
        let velocity = Velocity {
            forward_m_s: wrong,
            yaw_rad_s: 0.0,
        };
        aged(&mut bench, velocity, 0);
        bench.ticks(3);
        assert!(!bench.is_driven(), "{wrong}");
    }
    bench.command(Command::Disarm).unwrap();
    bench.command(Command::Mode(ModeId::WheelSpeed)).unwrap();
    bench.command(Command::Arm).unwrap();
    aged(&mut bench, AHEAD, 0);
    bench.ticks(5);
    assert!(!bench.is_driven());
}
