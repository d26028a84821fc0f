//! Mode 8 among people who cross its way and among other robots: how many arrive, and how fast they touch.
//!
//! `cargo xtask campaign --only moving` builds and starts it. Arguments: `--seeds N` (200), `--from N` first seed (1),
//! `--write` (the table of docs/theory/mission.md), `--print` (scenario and world of the first seed, instead of running
//! it), and names of places (none: all). Exit status 1 if a requirement is missed.

use crate::arguments::Arguments;
use crate::pages;
use rumbo_experiment::campaign::faults::GENTLE_M_S;
use rumbo_experiment::campaign::moving::{MovingDraw, MovingOutcome, drive};
use rumbo_experiment::files::FileError;
use std::process::ExitCode;

/// Share of robots that must arrive, and of runs that may have a touch faster than [`GENTLE_M_S`].
const ARRIVE: f64 = 0.9;
const TOUCH: f64 = 0.01;

pub(crate) fn main() -> ExitCode {
    crate::ended("moving", campaign())
}

fn campaign() -> Result<bool, FileError> {
    let names = MovingDraw::ALL.map(|place| place.to_string());
    let known = names.each_ref().map(String::as_str);
    let args = Arguments::read(&["--seeds", "--from"], &["--print", "--write"], &known)?;
    let places = MovingDraw::ALL.into_iter();
    let places = places.filter(|place| args.wants(&place.to_string()));
    let from = args.number("--from", 1);
    if args.has("--print") {
        for place in places {
            let (scenario, world) = place.draw(from);
            println!("{scenario}\n{}", world.unwrap_or_default());
        }
        return Ok(true);
    }
    let seeds = from..from + args.number("--seeds", 200);
    let mut table = String::from(
        "| where | robots that arrive within 120 s | runs with a touch above 0.1 m/s | fastest touch |\n|---|---|---|---|\n",
    );
    let mut met = true;
    for place in places {
        let outcomes = drive(place, seeds.clone())?;
        let (row, is_met) = row(place, &outcomes);
        table += &row;
        met &= is_met;
    }
    println!("{table}");
    if args.has("--write") {
        pages::write("docs/theory/mission.md", "moving", &table)?;
    }
    Ok(met)
}

fn row(place: MovingDraw, outcomes: &[MovingOutcome]) -> (String, bool) {
    let sum = |of: fn(&MovingOutcome) -> usize| outcomes.iter().map(of).sum::<usize>() as f64;
    let arrived = sum(|run| run.arrived) / sum(|run| run.robots);
    let hard = outcomes
        .iter()
        .filter(|run| run.fastest_m_s > GENTLE_M_S)
        .count();
    let touched = hard as f64 / outcomes.len() as f64;
    let fastest_m_s = outcomes
        .iter()
        .map(|run| run.fastest_m_s)
        .fold(0.0, f64::max);
    let row = format!(
        "| {place} | {:.1} % | {hard} of {} | {fastest_m_s:.2} m/s |\n",
        100.0 * arrived,
        outcomes.len()
    );
    (row, arrived >= ARRIVE && touched <= TOUCH)
}
