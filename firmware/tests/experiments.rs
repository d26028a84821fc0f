//! The experiments on the shipped image: the chip passes wherever the native robot passes, and no tick is late.
//!
//! One seed of each here; `cargo xtask campaign --only medians` runs twenty and compares the metrics.

use crate::board::image_path;
use crate::in_time::timed;
use crate::is_full;
use rayon::prelude::*;
use rumbo_experiment::files::firmware::beside;
use rumbo_experiment::files::{Kind, Library, Overrides, Setup};
use rumbo_experiment::run::{RunResult, run};
use std::sync::Arc;

/// The robot of each run. Which way it takes around boxes may depend on a few cycles, and now and then the longer one
/// misses a limit (docs/firmware.md says how often): a seed with an unambiguous way.
fn seed(scenario: &str) -> u64 {
    match scenario {
        "mode8-random" => 3,
        _ => 1,
    }
}

/// A scenario of each mode, to be run in every rig.
const OF_EACH_MODE: [&str; 13] = [
    "manual-straight-speed",
    "mode1",
    "mode2",
    "mode3",
    "mode3-right",
    "mode4",
    "mode4-right",
    "mode5",
    "mode6",
    "mode7",
    "pursuit-line",
    "mode8-goals",
    "mode8-lane",
];

/// One in so many modes and rigs is tried in the gate; all in the full check.
const SAMPLE: usize = 3;

/// Pulses have steps of 0.007 rad, and the robots of mode 9 part ways.
const SAME_LOOK_RAD: f64 = 0.02;

/// Runs each once natively, then those that passed on the image, where no tick may be late either and the servo turns
/// as far; returns their names, with their rigs.
fn what_passes_natively_passes(setups: Vec<Setup>) -> Vec<(String, String)> {
    let Some(image) = image_path() else {
        return Vec::new();
    };
    let firmware = Overrides {
        firmware: Some(image),
        ..Overrides::default()
    };
    let firmware = Library::new().setup("free", &firmware).unwrap().firmware;
    let natively = setups.into_par_iter().filter_map(|setup| {
        let result = run(&setup, seed(&setup.scenario.name)).unwrap();
        result.pass.then(|| (looked_rad(&result), setup))
    });
    let (looked, mut passed): (Vec<[f64; 2]>, Vec<Setup>) = natively.unzip();
    for setup in &mut passed {
        let image = firmware.as_deref().unwrap().clone();
        let with_policy = beside(image, setup.policy.as_ref()).unwrap();
        setup.firmware = Some(Arc::new(with_policy));
    }
    let failed = passed.par_iter().zip(looked).filter_map(|(setup, looked)| {
        let (result, longest) = timed(setup, seed(&setup.scenario.name));
        let rig = &setup.scenario.rig;
        let mut looks = looked.into_iter().zip(looked_rad(&result));
        let looked_there = looks.all(|(native, chip)| (native - chip).abs() < SAME_LOOK_RAD);
        let good = result.pass && longest.is_in_time() && looked_there;
        (!good).then_some((result, longest, rig))
    });
    let failed: Vec<_> = failed.collect();
    assert!(failed.is_empty(), "{failed:#?}");
    let name = |setup: Setup| (setup.scenario.name, setup.scenario.rig);
    passed.into_iter().map(name).collect()
}

/// The furthest that the servo turned to the right and to the left.
fn looked_rad(result: &RunResult) -> [f64; 2] {
    let samples = result.trace.between(0.0, f64::MAX);
    let angles = || samples.iter().map(|sample| sample.servo_rad);
    [angles().fold(0.0, f64::min), angles().fold(0.0, f64::max)]
}

#[test]
fn every_scenario_keeps_its_limits() {
    let library = Library::new();
    let names = library.list(Kind::Scenario);
    let own = |name: &String| library.setup(name, &Overrides::default()).unwrap();
    let passed = what_passes_natively_passes(names.iter().map(own).collect());
    let passed: Vec<_> = passed.into_iter().map(|(name, _)| name).collect();
    assert!(passed.is_empty() || passed == names, "{passed:?}");
}

#[test]
fn every_mode_keeps_its_limits_in_every_rig_that_can_do_it() {
    let library = Library::new();
    let rigs = library.setup("free", &Overrides::default()).unwrap();
    let rigs: Vec<_> = rigs.robot.rigs.keys().cloned().collect();
    let in_rig = |name: &str, rig: &String| {
        let overrides = Overrides {
            rig: Some(rig.clone()),
            ..Overrides::default()
        };
        let setup = library.setup(name, &overrides).unwrap();
        let own = library.setup(name, &Overrides::default()).unwrap();
        (own.scenario.rig != *rig).then_some(setup)
    };
    let setups = OF_EACH_MODE
        .iter()
        .flat_map(|name| rigs.iter().filter_map(|rig| in_rig(name, rig)));
    let every = if is_full() { 1 } else { SAMPLE };
    let passed = what_passes_natively_passes(setups.step_by(every).collect());
    println!("{passed:?}");
    // Driving by the wheels alone is possible in all five rigs, by sonars where they look the right way.
    let few = passed.len() * every < 24;
    assert!(passed.is_empty() || !few, "{}", passed.len());
}
