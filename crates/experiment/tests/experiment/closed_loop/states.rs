//! The state machines in the modes' descriptions match what happens.

use rumbo_control::mode::ModeId;
use rumbo_experiment::files::{FileError, Kind, Library, Overrides};
use rumbo_experiment::run::run_by;
use std::collections::BTreeSet;

/// Each change of state in a run, as (mode, from, to).
fn changes(scenario: &str, seed: u64) -> BTreeSet<(u8, u8, u8)> {
    let setup = Library::new()
        .setup(scenario, &Overrides::default())
        .unwrap();
    let mut found = BTreeSet::new();
    let ended: Result<_, FileError> = run_by(&setup, seed, |run| {
        let mut before = None;
        while !run.is_over() {
            run.advance();
            let now = run.sim().mode_state();
            if let (Some((mode, from)), Some((same, to))) = (before, now)
                && mode == same
                && from != to
            {
                found.insert((mode as u8, from, to));
            }
            before = now;
        }
        Ok(())
    });
    ended.unwrap();
    found
}

/// The states of mode 8 that are left within the tick in which they are entered: initialise and decide.
const AT_ONCE: [u8; 2] = [2, 6];

fn is_known(mode: u8, from: u8, to: u8) -> bool {
    let states = ModeId::from_number(mode).unwrap().description().states;
    let joined = |from: u8, to| {
        let ways = states[usize::from(from)].ways;
        ways.iter().any(|way| way.to == to)
    };
    let through = |middle: &u8| mode == 8 && joined(from, *middle) && joined(*middle, to);
    joined(from, to) || AT_ONCE.iter().any(through)
}

#[test]
fn every_change_of_state_in_every_experiment_is_in_the_tables() {
    let mut unknown = BTreeSet::new();
    let mut seen = BTreeSet::new();
    for name in Library::new().list(Kind::Scenario) {
        for (mode, from, to) in (1..=2).flat_map(|seed| changes(&name, seed)) {
            seen.insert((mode, from, to));
            if !is_known(mode, from, to) {
                unknown.insert((mode, from, to, name.clone()));
            }
        }
    }
    assert!(unknown.is_empty(), "not in the tables: {unknown:?}");
    assert!(seen.len() > 30, "the experiments show little: {seen:?}");
}
