//! Wires that fail in the more complex modes: along a wall (4), straight on (6), around boxes (8).

use super::drive::{Drive, setup};
use crate::is_full;
use rayon::prelude::*;
use rumbo_control::{Fault, SonarId};
use rumbo_plant::drivetrain::Side;
use rumbo_sim::wire_fault::{TimedWireFault, Wire, WireFault};

/// Where each mode is when a wire fails [s].
const DRIVES: [(&str, f64); 4] = [
    ("mode4-final", 2.0),
    ("mode6", 3.0),
    // At the first box, and between the boxes.
    ("mode8-obstacles", 2.0),
    ("mode8-obstacles", 6.0),
];
/// Observation time after the failure [s], longer where more is allowed.
const AFTER_S: f64 = 6.0;
/// Once released, it must stay so for this long [s].
const FOR_GOOD_S: f64 = 2.0;

/// One in so many failures is tried in the gate: another one in each drive. All in the full check.
const SAMPLE: usize = 4;

/// Failures of wires: of a sonar,
const ECHO_FAULTS: [WireFault; 5] = [
    WireFault::Low,
    WireFault::High,
    WireFault::Noisy(200.0),
    WireFault::Noisy(2_000.0),
    WireFault::Losing(0.3),
];
/// and of an encoder.
const ENCODER_FAULTS: [WireFault; 7] = [
    WireFault::Low,
    WireFault::High,
    WireFault::Noisy(20.0),
    WireFault::Noisy(200.0),
    WireFault::Noisy(2_000.0),
    WireFault::Losing(0.1),
    WireFault::Losing(0.5),
];

/// The faults that may be reported for an unreliable sonar.
const SONAR: &[Fault] = &[Fault::SonarFaulty, Fault::SonarStale];

/// How a drive continues after a wire has failed.
enum End {
    /// As if nothing were.
    AsBefore,
    /// Released within this time [s], for one of these causes.
    Released(f64, &'static [Fault]),
    /// The one or the other.
    Either(&'static [Fault]),
}

/// The documented behaviour for a wire in a mode (`docs/faults.md`).
fn documented(scenario: &str, wire: Wire, fault: WireFault) -> End {
    let stuck = matches!(fault, WireFault::Low | WireFault::High);
    match (scenario, wire) {
        // In the middle of a turn the wheels are asked for less. A line that jumps as it fails makes an edge: right after
        // another one that is implausible.
        (_, Wire::Encoder(Side::Left)) if stuck => {
            let causes = &[Fault::LeftEncoderSilent, Fault::LeftEncoderImplausible];
            End::Released(2.0, causes)
        }
        (_, Wire::Encoder(Side::Right)) if stuck => {
            let causes = &[Fault::RightEncoderSilent, Fault::RightEncoderImplausible];
            End::Released(2.0, causes)
        }
        // While it stands or turns slowly, no edges are missed. How long that is between the boxes depends on its path.
        (_, Wire::Encoder(side)) => {
            let within_s = match scenario {
                "mode8-obstacles" => 10.0,
                _ => 2.0,
            };
            // Echoes contradict a distance measured as half its true value: in a crawl that may be detected first.
            let misses = scenario == "mode8-obstacles" && fault == WireFault::Losing(0.5);
            // With half the edges lost several in a row are soon missing, and a noise pulse makes a wheel look fast, so
            // that edges
            // become overdue.
            let cause: &[Fault] = match (side, misses) {
                (Side::Left, false) => &[Fault::LeftEncoderImplausible, Fault::LeftEncoderSilent],
                (Side::Right, false) => {
                    &[Fault::RightEncoderImplausible, Fault::RightEncoderSilent]
                }
                (Side::Left, true) => &[
                    Fault::LeftEncoderImplausible,
                    Fault::LeftEncoderSilent,
                    Fault::SonarFaulty,
                ],
                (Side::Right, true) => &[
                    Fault::RightEncoderImplausible,
                    Fault::RightEncoderSilent,
                    Fault::SonarFaulty,
                ],
            };
            End::Released(within_s, cause)
        }
        ("mode6", _) | ("mode4-final", Wire::Echo(SonarId::Right)) => End::AsBefore,
        (_, Wire::Echo(_)) if stuck => End::Released(0.3, SONAR),
        (_, Wire::Echo(_)) => End::Either(&[Fault::SonarFaulty, Fault::SonarStale, Fault::Blocked]),
    }
}

/// Drives until a wire fails, and on; returns a description of undocumented behaviour.
fn judge(scenario: &str, at_s: f64, wire: Wire, fault: WireFault) -> Option<String> {
    let timed = TimedWireFault { at_s, wire, fault };
    let setup = setup(scenario, |setup| setup.scenario.wire_faults = vec![timed])?;
    let mut drive = Drive::under_way(&setup, at_s);
    let mut driven_s = at_s;
    let documented = documented(scenario, wire, fault);
    let after_s = match documented {
        End::Released(within_s, _) => AFTER_S.max(within_s),
        End::AsBefore | End::Either(_) => AFTER_S,
    };
    while drive.now_s() < at_s + after_s && drive.now_s() < driven_s + FOR_GOOD_S {
        drive.wait_s(0.01);
        if !drive.is_released() {
            driven_s = drive.now_s();
        }
    }
    let (status, took_s) = (drive.status(), driven_s - at_s);
    let contact_m_s = drive.sim.worst_contact_m_s();
    let as_documented = match (documented, status.fault) {
        (End::AsBefore, fault) => status.armed && fault.is_none(),
        (End::Released(within_s, causes), Some(fault)) => {
            took_s <= within_s && causes.contains(&fault)
        }
        (End::Either(causes), Some(fault)) => causes.contains(&fault),
        (End::Released(..), None) => false,
        (End::Either(_), None) => true,
    };
    let line = format!(
        "{scenario} at {at_s} s, {wire:?} {fault:?}: {:?}, driven for {took_s:.2} s, contact {contact_m_s} m/s",
        status.fault
    );
    println!("{line}");
    (!as_documented || contact_m_s > 0.0).then_some(line)
}

#[test]
fn a_wire_that_fails_ends_each_drive_as_documented() {
    let cases = DRIVES.into_iter().flat_map(|(scenario, at_s)| {
        Wire::ALL.into_iter().flat_map(move |(_, wire)| {
            let faults: &[WireFault] = match wire {
                Wire::Encoder(_) => &ENCODER_FAULTS,
                Wire::Echo(_) => &ECHO_FAULTS,
            };
            faults
                .iter()
                .map(move |fault| (scenario, at_s, wire, *fault))
        })
    });
    let every = if is_full() { 1 } else { SAMPLE };
    let cases: Vec<_> = cases.step_by(every).collect();
    let wrong: Vec<String> = cases
        .into_par_iter()
        .filter_map(|(scenario, at_s, wire, fault)| judge(scenario, at_s, wire, fault))
        .collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}
