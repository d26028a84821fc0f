//! The experiments on the shipped image: what the native robot passes, the chip passes.

use crate::faults::drive::setup;
use rumbo_scenario::run::run;

/// One seed of each; `cargo xtask campaign` takes more, natively.
fn pass(scenarios: &[&str]) {
    for scenario in scenarios {
        let Some(setup) = setup(scenario, |_| {}) else {
            return;
        };
        let result = run(&setup, 1).unwrap();
        assert!(result.pass, "{scenario}: {:?}", result.failures);
    }
}

#[test]
fn fronts_walls_and_speeds() {
    pass(&[
        "mode1",
        "mode2",
        "mode3",
        "mode4",
        "mode5",
        "mode5-reversal",
        "mode6",
    ]);
}

#[test]
fn the_final_rig() {
    pass(&["mode1-final", "mode2-final", "mode3-final", "mode4-final"]);
}

#[test]
fn routes_and_missions() {
    pass(&[
        "mode7",
        "pursuit-line",
        "pursuit-curve",
        "mode8-goals",
        "mode8-lane",
    ]);
}
