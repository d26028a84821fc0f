//! Mode 8 among people who cross its way and among other robots: how many arrive, and how fast they touch.
//!
//! `cargo xtask campaign --only moving` builds and starts it. Arguments: `--seeds N` (200), `--from N` first seed (1),
//! `--list` (each run with a touch), `--set NAME=VALUE` (a parameter), `--write` (the table of docs/theory/mission.md),
//! `--print` (scenario and world of the first seed, instead of running it), and names of places (none: all). Exit status 1
//! if a requirement is missed.

use crate::pages;
use rumbo_experiment::campaign::faults::GENTLE_M_S;
use rumbo_experiment::campaign::moving::{MovingDraw, MovingOutcome, drive};
use rumbo_experiment::files::{FileError, Overrides};
use std::process::ExitCode;

/// Share of robots that must arrive, and of runs that may have a touch faster than [`GENTLE_M_S`].
const ARRIVE: f64 = 0.9;
const TOUCH: f64 = 0.01;

struct Args {
    seeds: u64,
    from: u64,
    list: bool,
    write: bool,
    print: bool,
    overrides: Overrides,
    places: Vec<MovingDraw>,
}

fn parse() -> Option<Args> {
    let mut parsed = Args {
        seeds: 200,
        from: 1,
        list: false,
        write: false,
        print: false,
        overrides: Overrides::default(),
        places: Vec::new(),
    };
    let mut args = crate::arguments();
    while let Some(arg) = args.next() {
        match arg.as_str() {
            "--seeds" => parsed.seeds = args.next()?.parse().ok()?,
            "--from" => parsed.from = args.next()?.parse().ok()?,
            "--list" => parsed.list = true,
            "--write" => parsed.write = true,
            "--print" => parsed.print = true,
            "--set" => {
                let text = args.next()?;
                let (name, value) = text.split_once('=')?;
                let value = value.parse().ok()?;
                parsed.overrides.parameters.push((name.to_owned(), value));
            }
            name => {
                let mut places = MovingDraw::ALL.into_iter();
                parsed
                    .places
                    .push(places.find(|place| place.to_string() == name)?);
            }
        }
    }
    if parsed.places.is_empty() {
        parsed.places = MovingDraw::ALL.to_vec();
    }
    Some(parsed)
}

pub(crate) fn main() -> ExitCode {
    let Some(args) = parse() else {
        eprintln!("moving: see the head of tools/src/moving.rs for the arguments");
        return ExitCode::from(2);
    };
    if args.print {
        for place in &args.places {
            let (scenario, world) = place.draw(args.from);
            println!("{scenario}\n{}", world.unwrap_or_default());
        }
        return ExitCode::SUCCESS;
    }
    crate::ended("moving", campaign(&args))
}

fn campaign(args: &Args) -> Result<bool, FileError> {
    let seeds = args.from..args.from + args.seeds;
    let mut table = String::from(
        "| where | robots that arrive within 120 s | runs with a touch above 0.1 m/s | fastest touch |\n|---|---|---|---|\n",
    );
    let mut met = true;
    for place in &args.places {
        let outcomes = drive(*place, seeds.clone(), &args.overrides)?;
        let (row, is_met) = row(*place, &outcomes);
        table += &row;
        met &= is_met;
        if args.list {
            outcomes
                .iter()
                .filter(|run| !run.touches.is_empty())
                .for_each(|run| list(*place, run));
        }
    }
    println!("{table}");
    if args.write {
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

fn list(place: MovingDraw, run: &MovingOutcome) {
    println!(
        "{place} seed {}: fastest {:.3} m/s, {} of {} arrived",
        run.seed, run.fastest_m_s, run.arrived, run.robots
    );
    for touch in &run.touches {
        println!(
            "  robot {} at {:.2} s in state {} at {:.2} m/s",
            touch.robot, touch.at_s, touch.state, touch.speed_m_s
        );
    }
}
