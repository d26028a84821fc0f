//! Duration of the ticks of real runs: from the inputs to the outputs, which are due 3 ms after the tick, and to the
//! end of the tick, which must come before the next one. The random inputs of `same_bits` do not reach the worst cases:
//! a wall being followed, a map full of echoes.

use crate::faults::drive::setup;
use crate::is_full;
use rumbo_experiment::files::{FileError, Setup};
use rumbo_experiment::run::{RunResult, run_by};

/// Where a tick begins, where its outputs are left, and where the loop waits for the next one.
const MARKS: [&str; 3] = [
    "rumbo_inputs_latched",
    "rumbo_outputs_left",
    "rumbo::hal::power::sleep_after",
];
/// Most cycles from the inputs to the outputs, interrupts included.
const MOST_TO_OUTPUTS: u64 = 45_000;
/// Most cycles from the inputs to the end, of a period's 160,000; up to 165,000 the next outputs would still be in time.
const MOST_TO_END: u64 = 158_000;

/// The longest tick of a run.
#[derive(Debug, Default)]
pub(crate) struct Longest {
    ticks: u32,
    /// Most cycles from the inputs to the outputs, and to the end.
    to_outputs: u64,
    to_end: u64,
}

impl Longest {
    fn of(marks: impl IntoIterator<Item = (usize, u64)>) -> Longest {
        let (mut longest, mut began) = (Longest::default(), None);
        for (mark, cycle) in marks {
            let took = cycle - began.unwrap_or(cycle);
            match mark {
                0 => {
                    began = Some(cycle);
                    longest.ticks += 1;
                }
                1 => longest.to_outputs = took.max(longest.to_outputs),
                _ => longest.to_end = took.max(longest.to_end),
            }
        }
        longest
    }

    /// Whether every tick kept the limits.
    pub(crate) fn is_in_time(&self) -> bool {
        self.to_outputs <= MOST_TO_OUTPUTS && self.to_end <= MOST_TO_END
    }
}

/// Runs a scenario on the image and watches its ticks.
pub(crate) fn timed(setup: &Setup, seed: u64) -> (RunResult, Longest) {
    let mut longest = Longest::default();
    let result = run_by(setup, seed, |run| {
        assert!(run.sim().mega_mut().unwrap().mark(&MARKS));
        while !run.is_over() {
            run.advance();
        }
        longest = Longest::of(run.sim().mega_mut().unwrap().take_marks());
        Ok::<(), FileError>(())
    });
    println!("{}, seed {seed}: {longest:?}", setup.scenario.name);
    assert!(longest.ticks >= 100, "{longest:?}");
    (result.unwrap(), longest)
}

/// Runs them all and checks the limits of a tick.
fn are_in_time(runs: impl IntoIterator<Item = (&'static str, u64)>) {
    let late = runs.into_iter().filter_map(|(scenario, seed)| {
        let (_, longest) = timed(&setup(scenario, |_| {})?, seed);
        (!longest.is_in_time()).then_some((scenario, seed, longest))
    });
    let late: Vec<_> = late.collect();
    assert!(late.is_empty(), "{late:?}");
}

/// Those whose ticks are the longest, beside those of [`crate::experiments`]; all are in the table of docs/firmware.md.
#[test]
fn no_tick_of_a_run_is_late_or_longer_than_its_period() {
    are_in_time([
        ("mode8-obstacles", 19),
        // Obstacles with others beside their ends, and silences to ingest: the longest ticks.
        ("mode8-random", 11),
        // The origin moves to the goal.
        ("mode8-random", 19),
    ]);
}

#[test]
fn nor_one_of_any_mode() {
    if !is_full() {
        return println!("with RUMBO_FULL=1: the table of docs/firmware.md");
    }
    let once = [
        "mode1",
        "mode1-final",
        "mode2",
        "mode2-final",
        "mode3",
        "mode3-final",
        "mode4",
        "mode4-final",
        "mode5",
        "mode5-reversal",
        "mode6",
        "mode7",
        "pursuit-line",
        "pursuit-curve",
        "mode8-goals",
        "mode8-lane",
    ];
    let often = ["mode8-obstacles", "mode8-random", "mode9-random"];
    let seeds = |name| (1..=20).map(move |seed| (name, seed));
    are_in_time(
        once.map(|name| (name, 1))
            .into_iter()
            .chain(often.into_iter().flat_map(seeds)),
    );
}
