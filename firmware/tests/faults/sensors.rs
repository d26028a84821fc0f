//! Sonars, encoders and battery fail.

use super::drive::{Drive, setup, setup_of};
use rumbo_control::{Fault, SonarId};
use rumbo_experiment::files::Setup;
use rumbo_plant::drivetrain::Side;
use rumbo_sim::wire_fault::{TimedWireFault, Wire, WireFault};
use rumbo_wire::{Command, EventKind, Refusal};
use std::path::Path;

/// Drives a scenario until `at_s`, when the wire fails.
fn failing(scenario: &str, at_s: f64, wire: Wire, fault: WireFault) -> Option<Drive> {
    let fault = TimedWireFault { at_s, wire, fault };
    let setup = setup(scenario, |setup| setup.scenario.wire_faults = vec![fault])?;
    Some(Drive::under_way(&setup, at_s))
}

/// The fault that latched.
fn latched(drive: &mut Drive) -> Fault {
    drive.wait_s(0.7);
    drive.status().fault.unwrap()
}

#[test]
fn an_echo_line_stuck_at_either_level_stops_the_approach_to_a_wall() {
    let front = Wire::Echo(SonarId::Front);
    for fault in [WireFault::High, WireFault::Low] {
        let Some(mut drive) = failing("mode1-final", 1.4, front, fault) else {
            return;
        };
        let took_s = drive.released_after_s(1.4, 0.7);
        println!("{fault:?}: released after {took_s:.2} s");
        let latched = latched(&mut drive);
        assert!(
            matches!(latched, Fault::SonarFaulty | Fault::SonarStale),
            "{latched:?}"
        );
        assert_eq!(drive.command(Command::ClearFault), Ok(0.0));
        assert_eq!(drive.command(Command::Arm), Err(Refusal::SonarNotReady));
    }
}

#[test]
fn an_echo_line_that_loses_a_third_of_its_edges_changes_little() {
    let front = Wire::Echo(SonarId::Front);
    let Some(mut drive) = failing("mode1-final", 1.4, front, WireFault::Losing(0.3)) else {
        return;
    };
    drive.wait_s(3.5);
    let distance_m = drive.sim.truth().range_m[2].unwrap();
    println!("stands {distance_m:.3} m before the wall");
    drive.touched_nothing();
    match drive.status().fault {
        None => assert!((0.26..0.34).contains(&distance_m), "{distance_m}"),
        Some(fault) => assert!(matches!(fault, Fault::SonarFaulty | Fault::SonarStale)),
    }
}

#[test]
fn a_cut_encoder_stops_the_robot_and_is_named() {
    for (side, fault) in [
        (Side::Left, Fault::LeftEncoderSilent),
        (Side::Right, Fault::RightEncoderSilent),
    ] {
        for scenario in ["mode5", "mode1-final"] {
            let Some(mut drive) = failing(scenario, 1.4, Wire::Encoder(side), WireFault::Low)
            else {
                return;
            };
            let took_s = drive.released_after_s(1.4, 1.5);
            println!("{scenario}, {side:?}: released after {took_s:.2} s");
            drive.latched(fault);
        }
    }
}

#[test]
fn a_noisy_encoder_stops_the_robot_and_is_named() {
    for rate_hz in [200.0, 2_000.0] {
        let noisy = WireFault::Noisy(rate_hz);
        let left = Wire::Encoder(Side::Left);
        let Some(mut drive) = failing("mode1-final", 1.4, left, noisy) else {
            return;
        };
        let took_s = drive.released_after_s(1.4, 0.5);
        println!("{rate_hz} Hz: released after {took_s:.2} s");
        drive.latched(Fault::LeftEncoderImplausible);
    }
}

/// An old battery, and something besides the motors that draws on it.
const WEAK: [(&str, f64); 3] = [
    ("battery.open_circuit_v", 7.0),
    ("battery.capacity_ah", 0.1),
    ("battery.electronics_a", 2.0),
];

#[test]
fn a_battery_below_its_limit_stops_the_robot_and_it_does_not_start_again() {
    let robot = include_str!("../../../robots/memoria.toml").replace(
        "[wiring.final]\n",
        "[wiring.final]\nbattery = { pin = 57, ratio = 2.5 }\n",
    );
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("with_divider.toml");
    std::fs::write(&path, robot).unwrap();
    let changes = |setup: &mut Setup| {
        let weak = WEAK.map(|(name, value)| (name.to_owned(), value));
        setup.scenario.plant.extend(weak);
    };
    for scenario in ["mode5", "mode4-final", "mode6", "mode8-obstacles"] {
        let Some(setup) = setup_of(path.to_str().unwrap(), scenario, changes) else {
            return;
        };
        println!("{scenario}");
        runs_down(&setup);
    }
}

/// Drives until the battery is too low.
fn runs_down(setup: &Setup) {
    let mut drive = Drive::new(setup);
    drive.wait_s(0.3);
    for (id, value) in setup.control_parameters().unwrap() {
        let id = id as u8;
        drive.command(Command::SetParam { id, value }).unwrap();
    }
    drive.command(Command::Mode(setup.scenario.mode)).unwrap();
    drive.follow(setup, 6.0);
    while drive
        .event_s(EventKind::Faulted(Fault::BatteryLow))
        .is_none()
    {
        drive.wait_s(0.1);
        assert!(drive.now_s() < 30.0, "{:?}", drive.status());
    }
    let volts = drive.sim.truth().battery_v;
    let measured_v = drive.status().battery_v.unwrap();
    println!(
        "stopped at {:.1} s, {volts:.2} V, measured {measured_v:.2} V",
        drive.now_s()
    );
    let from_s = drive.now_s();
    drive.released_after_s(from_s, 0.1);
    drive.latched(Fault::BatteryLow);
    drive.command(Command::ClearFault).unwrap();
    drive.wait_s(1.0);
    if drive.sim.truth().battery_v < 6.0 {
        assert_eq!(drive.command(Command::Arm), Err(Refusal::BatteryLow));
    }
}
