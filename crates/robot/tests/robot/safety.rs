//! When the wheels may turn, and what stops them.

use crate::support;
use rumbo_control::mode::ModeId;
use rumbo_control::{Fault, Micros, Wheels};
use rumbo_wire::{Command, EventKind, Refusal, ToRobot};
use support::{Bench, SESSION};

#[test]
fn is_disarmed_at_the_start_whatever_the_link_sends() {
    let mut bench = Bench::alive();
    bench.ticks(200);
    assert!(!bench.status().armed && !bench.is_driven());
    assert_eq!(bench.events(), []);
}

#[test]
fn arms_only_with_a_live_link() {
    let mut bench = Bench::new();
    bench.heartbeats = false;
    bench.ticks(100);
    assert_eq!(
        bench.command(Command::Arm),
        Err(Refusal::NoLink),
        "a start out of a silent link"
    );
    bench.ticks(100);
    bench.heartbeats = true;
    bench.ticks(30);
    assert_eq!(bench.command(Command::Arm), Ok(0.0));
    assert!(bench.status().armed);
}

#[test]
fn arms_only_when_the_sonar_of_the_mode_is_healthy() {
    let mut bench = Bench::new();
    bench.wall_us = [None; 3];
    bench.ticks(100);
    bench.command(Command::Mode(ModeId::FrontDistance)).unwrap();
    assert_eq!(bench.command(Command::Arm), Err(Refusal::SonarNotReady));
    bench.wall_us = [Some(5_824); 3];
    bench.ticks(100);
    assert_eq!(bench.command(Command::Arm), Ok(0.0));
}

#[test]
fn stops_within_500_ms_of_the_last_heartbeat() {
    // At any place of the last heartbeat between two ticks, and across the wrap of the clock.
    for start in [Micros(0), Micros(u32::MAX - 1_700_000)] {
        let mut bench = Bench::at(start);
        bench.ticks(50);
        bench.drive();
        bench.heartbeats = false;
        bench.send(&ToRobot::Heartbeat);
        let mut ticks = 0;
        while bench.is_driven() {
            bench.ticks(1);
            ticks += 1;
            assert!(ticks * 10 + 13 <= 500, "still driven after {ticks} ticks");
        }
        assert!(
            ticks > 30,
            "a live link was declared dead after {ticks} ticks"
        );
        bench.ticks(20);
        assert_eq!(bench.status().fault, Some(Fault::LinkLost));
    }
}

#[test]
fn drives_on_across_the_wrap_of_the_clock() {
    let mut bench = Bench::at(Micros(u32::MAX - 2_000_000));
    bench.ticks(50);
    bench.drive();
    bench.ticks(400);
    assert!(bench.now.0 < 10_000_000 && bench.is_driven());
    let steps: Vec<u16> = bench
        .telemetry()
        .windows(2)
        .map(|two| two[1].t_ms.wrapping_sub(two[0].t_ms))
        .collect();
    assert!(
        steps.len() > 100 && steps.iter().all(|step| *step == 40),
        "{steps:?}"
    );
}

#[test]
fn the_link_coming_back_does_not_start_the_robot_again() {
    let mut bench = Bench::alive();
    bench.drive();
    bench.heartbeats = false;
    bench.ticks(100);
    bench.heartbeats = true;
    bench.ticks(100);
    assert!(!bench.is_driven());
    assert_eq!(bench.command(Command::Arm), Err(Refusal::Faulted));
    assert_eq!(bench.command(Command::ClearFault), Ok(0.0));
    assert!(!bench.is_driven() && !bench.status().armed);
    assert_eq!(bench.command(Command::Arm), Ok(0.0));
    let lost = Fault::LinkLost;
    let story = [
        EventKind::Armed,
        EventKind::Faulted(lost),
        EventKind::Disarmed,
        EventKind::Cleared(lost),
        EventKind::Armed,
    ];
    assert_eq!(bench.events()[1..], story);
}

#[test]
fn stop_releases_the_wheels_at_the_next_tick_from_any_session() {
    for session in [SESSION, SESSION + 1] {
        let mut bench = Bench::alive();
        bench.drive();
        bench.send(&ToRobot::Command {
            session,
            number: 0,
            command: Command::Stop,
            seen: bench.seen,
        });
        bench.ticks(1);
        assert_eq!(bench.outputs.drive, Wheels::default());
        bench.ticks(20);
        assert_eq!(
            bench.acks().last().map(|ack| (ack.session, ack.result)),
            Some((session, Ok(0.0)))
        );
        assert!(!bench.status().armed);
    }
}

#[test]
fn a_mode_that_loses_its_wall_stops_and_reports_why() {
    let mut bench = Bench::alive();
    bench.command(Command::Mode(ModeId::FrontDistance)).unwrap();
    bench.ticks(60);
    bench.command(Command::Arm).unwrap();
    assert!(bench.is_driven());
    bench.wall_us = [None; 3];
    bench.ticks(100);
    assert!(!bench.is_driven());
    assert_eq!(bench.status().fault, Some(Fault::SonarFaulty));
    assert!(
        bench
            .events()
            .contains(&EventKind::Faulted(Fault::SonarFaulty))
    );
}

#[test]
fn a_held_robot_does_not_burn() {
    let mut bench = Bench::alive();
    bench.drive();
    bench.held = true;
    bench.ticks(70);
    assert!(!bench.is_driven());
    assert_eq!(bench.status().fault, Some(Fault::Blocked));
}

#[test]
fn an_empty_battery_stops_the_robot_and_a_dip_does_not() {
    let mut bench = Bench::alive();
    bench.battery_v = Some(7.4);
    bench.drive();
    bench.battery_v = Some(5.0);
    bench.ticks(20);
    bench.battery_v = Some(7.4);
    bench.ticks(100);
    assert!(bench.is_driven());
    bench.battery_v = Some(5.0);
    bench.ticks(100);
    assert!(!bench.is_driven());
    assert_eq!(bench.status().fault, Some(Fault::BatteryLow));
}

#[test]
fn a_loop_that_stood_still_stops_the_robot() {
    let mut bench = Bench::alive();
    bench.drive();
    bench.now = bench.now.after(200_000);
    bench.ticks(20);
    assert_eq!(bench.status().fault, Some(Fault::Overrun));
    assert_eq!(bench.status().overruns, 1);
}
