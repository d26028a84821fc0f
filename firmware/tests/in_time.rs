//! Duration of the ticks of real runs: from the inputs to the outputs, which are due 3 ms after the tick, and to the
//! end of the tick, which must come before the next one. The random inputs of `same_bits` do not reach the worst cases:
//! a wall being followed, a map full of echoes.

use crate::faults::drive::setup;
use crate::is_full;
use rumbo_experiment::files::FileError;
use rumbo_experiment::run::run_by;

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

/// Runs a scenario on the image and returns the most cycles of a tick from its inputs to its outputs and to its end;
/// `None` where the image has not been built.
fn longest(scenario: &str, seed: u64) -> Option<(u64, u64)> {
    let setup = setup(scenario, |_| {})?;
    let mut marks = Vec::new();
    run_by(&setup, seed, |run| {
        assert!(run.sim().mega_mut().unwrap().mark(&MARKS));
        while !run.is_over() {
            run.advance();
        }
        marks = run.sim().mega_mut().unwrap().take_marks();
        Ok::<(), FileError>(())
    })
    .unwrap();
    let (mut to_outputs, mut to_end, mut ticks) = (0, 0, 0);
    let mut began = None;
    for (mark, cycle) in marks {
        let took = cycle - began.unwrap_or(cycle);
        match mark {
            0 => {
                began = Some(cycle);
                ticks += 1;
            }
            1 => to_outputs = took.max(to_outputs),
            _ => to_end = took.max(to_end),
        }
    }
    println!(
        "{scenario}, seed {seed}: {ticks} ticks; most cycles to the outputs {to_outputs}, to the end {to_end}"
    );
    assert!(ticks > 500, "{ticks}");
    Some((to_outputs, to_end))
}

/// Runs them all and checks the limits of a tick.
fn are_in_time(runs: impl IntoIterator<Item = (&'static str, u64)>) {
    let mut late = Vec::new();
    for (scenario, seed) in runs {
        let Some((to_outputs, to_end)) = longest(scenario, seed) else {
            return;
        };
        if to_outputs > MOST_TO_OUTPUTS || to_end > MOST_TO_END {
            late.push((scenario, seed, to_outputs, to_end));
        }
    }
    assert!(late.is_empty(), "{late:?}");
}

/// Those whose ticks are the longest; all of them are in the table of docs/firmware.md.
#[test]
fn no_tick_of_a_run_is_late_or_longer_than_its_period() {
    are_in_time([
        ("mode1", 1),
        ("mode2", 1),
        ("mode3", 1),
        ("mode4-final", 1),
        ("pursuit-curve", 1),
        ("mode8-lane", 1),
        ("mode8-obstacles", 1),
        ("mode8-obstacles", 19),
        // Obstacles with others beside their ends, and silences to ingest: the longest ticks.
        ("mode8-random", 11),
        // The origin moves to the goal.
        ("mode8-random", 19),
        ("mode9-random", 1),
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
