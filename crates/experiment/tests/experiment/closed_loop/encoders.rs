//! Encoders that lose edges or pick up noise are reported before the robot touches anything; sound ones are trusted
//! with any disc.

use super::{seeds, setup};
use rumbo_control::Fault;
use rumbo_experiment::files::{FileError, Kind, Library, Setup};
use rumbo_experiment::run::{RunResult, run_all};
use rumbo_plant::drivetrain::Side;
use rumbo_sim::wire_fault::{TimedWireFault, Wire, WireFault};
use rumbo_wire::{EventKind, FromRobot};

/// When the robot stopped [s], and why.
pub(super) fn fault(run: &RunResult) -> Option<(f64, Fault)> {
    run.trace
        .messages
        .iter()
        .find_map(|message| match message.what {
            FromRobot::Event(event) => match event.kind {
                EventKind::Faulted(fault) => Some((message.t_s, fault)),
                _ => None,
            },
            _ => None,
        })
}

#[test]
fn an_encoder_that_loses_edges_or_picks_up_noise_is_named_and_nothing_is_touched() {
    let sides = [
        (Side::Left, Fault::LeftEncoderImplausible),
        (Side::Right, Fault::RightEncoderImplausible),
    ];
    // 20 pulses a second are a tenth more edges at 0.2 m/s.
    let faults = [
        WireFault::Losing(0.1),
        WireFault::Losing(0.5),
        WireFault::Noisy(20.0),
        WireFault::Noisy(200.0),
        WireFault::Noisy(2_000.0),
    ];
    for scenario in ["mode1-final", "mode4-final", "mode6", "mode8-obstacles"] {
        for (n, kind) in faults.into_iter().enumerate() {
            let (side, named) = sides[n % 2];
            let mut setup = setup(scenario);
            setup.scenario.wire_faults = vec![TimedWireFault {
                at_s: 1.0,
                wire: Wire::Encoder(side),
                fault: kind,
            }];
            for run in seeds(&setup, 1..4) {
                let what = format!("{scenario}, {kind:?}, seed {}", run.seed);
                let (at_s, fault) = fault(&run).expect(&what);
                println!("{what}: {fault:?} at {at_s:.2} s");
                // Of half the edges several in a row are missing soon.
                let silent = match side {
                    Side::Left => Fault::LeftEncoderSilent,
                    Side::Right => Fault::RightEncoderSilent,
                };
                let half = kind == WireFault::Losing(0.5);
                assert!(
                    fault == named || (half && fault == silent),
                    "{what}: {fault:?}"
                );
                assert_eq!(run.metrics["contacts"], 0.0, "{what}");
            }
        }
    }
}

#[test]
fn a_cut_encoder_does_not_drive_its_wheel_harder() {
    let names = [
        ("mode4-final", 3.0),
        ("mode6", 3.0),
        ("mode8-obstacles", 4.0),
        ("mode8-lane", 2.0),
    ];
    for ((scenario, at_s), side) in names.into_iter().flat_map(|name| [(name, 0), (name, 1)]) {
        let sound = setup(scenario);
        let mut cut = sound.clone();
        cut.scenario.wire_faults = vec![TimedWireFault {
            at_s,
            wire: Wire::Encoder([Side::Left, Side::Right][side]),
            fault: WireFault::Low,
        }];
        for (run, sound) in seeds(&cut, 1..6).into_iter().zip(seeds(&sound, 1..6)) {
            let what = format!("{scenario}, wheel {side}, seed {}", run.seed);
            let (stopped_s, _) = fault(&run).expect(&what);
            let fastest = |run: &RunResult, from_s| {
                let between = run.trace.between(from_s, stopped_s + 1.0).iter();
                between
                    .map(|sample| sample.wheel_rad_s[side].abs())
                    .fold(0.0, f64::max)
            };
            // Ramps and turns go on: what the wheel of a sound robot does about that time is no excess. One that is cut as a
            // ramp begins is up to 0.08 m/s faster than that (of 108 cuts around boxes at 3 to 8 s), until it is known.
            let (usual, after) = (fastest(&sound, at_s - 2.0), fastest(&run, at_s));
            assert!(
                after <= usual + 3.0,
                "{what}: {usual:.1} rad/s is usual, not {after:.1}"
            );
        }
    }
}

#[test]
fn no_encoder_is_doubted_for_its_disc_or_what_the_wheels_roll_on() {
    // The most uneven disc that can be described, a floor and a battery beyond those of the seeds.
    let plants = [
        [
            ("encoder.spacing_error", 0.45),
            ("floor.friction_scale", 1.0),
        ],
        [("floor.friction_scale", 2.0), ("floor.roughness", 0.3)],
        [
            ("battery.open_circuit_v", 5.2),
            ("encoder.spacing_error", 0.2),
        ],
    ];
    let names = Library::new().list(Kind::Scenario);
    let setups: Vec<Setup> = (plants.iter())
        .flat_map(|plant| names.iter().map(move |name| (plant, name)))
        .map(|(plant, name)| {
            let mut setup = setup(name);
            let values = plant.map(|(name, value)| (name.to_owned(), value));
            setup.scenario.plant.extend(values);
            setup
        })
        .collect();
    let jobs: Vec<_> = setups.iter().map(|setup| (setup, 1)).collect();
    run_all(&jobs, |_, run| {
        let fault = fault(&run).map(|(_, fault)| fault);
        let doubted = matches!(
            fault,
            Some(Fault::LeftEncoderImplausible | Fault::RightEncoderImplausible)
        );
        assert!(!doubted, "{}: {fault:?}", run.scenario);
        Ok::<(), FileError>(())
    })
    .unwrap();
}
