//! The experiments on the shipped image: the chip passes wherever the native robot passes, and no tick is late.
//!
//! One seed of each here; `cargo xtask campaign --only medians` runs twenty and compares the metrics.

use crate::board::image_path;
use crate::in_time::timed;
use crate::is_full;
use rayon::prelude::*;
use rumbo_experiment::files::firmware::beside;
use rumbo_experiment::files::{Kind, Library, Overrides, Setup};
use rumbo_experiment::run::run;
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

/// Runs each once natively, then those that passed on the image, where no tick may be late either; returns their names,
/// with their rigs.
fn what_passes_natively_passes(setups: Vec<Setup>) -> Vec<(String, String)> {
    let Some(image) = image_path() else {
        return Vec::new();
    };
    let firmware = Overrides {
        firmware: Some(image),
        ..Overrides::default()
    };
    let firmware = Library::new().setup("free", &firmware).unwrap().firmware;
    let mut passed: Vec<Setup> = setups
        .into_par_iter()
        .filter(|setup| run(setup, seed(&setup.scenario.name)).unwrap().pass)
        .collect();
    for setup in &mut passed {
        let image = firmware.as_deref().unwrap().clone();
        let with_policy = beside(image, setup.policy.as_ref()).unwrap();
        setup.firmware = Some(Arc::new(with_policy));
    }
    let failed = passed.par_iter().filter_map(|setup| {
        let (result, longest) = timed(setup, seed(&setup.scenario.name));
        let rig = &setup.scenario.rig;
        (!result.pass || !longest.is_in_time()).then_some((result, longest, rig))
    });
    let failed: Vec<_> = failed.collect();
    assert!(failed.is_empty(), "{failed:#?}");
    let name = |setup: Setup| (setup.scenario.name, setup.scenario.rig);
    passed.into_iter().map(name).collect()
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
