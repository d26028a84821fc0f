//! Tuning from starts that miss their limits: each gain times a factor from 1/5 to 5, drawn until ten such starts are
//! found for a mode; each is tuned, and driven by 100 robots that the search has not seen.
//!
//! `cargo xtask campaign --only tune` starts it. Arguments: the number of starts, then names of scenarios (none: all of
//! [`MODES`]). Exit status 1 if a robot misses a limit after it. The time of a search is printed and depends on the
//! machine.

#![allow(missing_docs)]

use rumbo_control::params::{ParamId, Params};
use rumbo_experiment::files::{FileError, Library, Overrides, Setup};
use rumbo_experiment::run::run_all;
use rumbo_experiment::sweep::{Axis, Design, SweepPlan, Values};
use rumbo_experiment::tune::{Objective, Over, Search, tuned};
use std::process::ExitCode;
use std::time::Instant;

const STARTS: usize = 10;
const FACTOR: f64 = 5.0;
/// Starts drawn for a mode, at most.
const DRAWN: usize = 400;
/// Robots that show that a start misses its limits, and that it does not after tuning.
const TRIED: u64 = 20;
const HELD_OUT: u64 = 100;

/// Scenarios with their gains, and the metrics to make small (none: as far from all limits as can be).
const MODES: [(&str, &[&str], &str); 4] = [
    ("mode1", &["front_kp", "front_brake_m_s2"], "settling_s"),
    (
        "mode3",
        &[
            "wall_kp",
            "wall_ki",
            "wall_heading_kp",
            "speed_kp_left",
            "speed_kp_right",
        ],
        "",
    ),
    (
        "mode5",
        &[
            "kv",
            "speed_kp_left",
            "speed_kp_right",
            "speed_ki_left",
            "speed_ki_right",
        ],
        "",
    ),
    (
        "mode7",
        &["line_cross_kp", "line_heading_kp", "turn_brake_rad_s2"],
        "",
    ),
];

pub(crate) fn main() -> ExitCode {
    let mut args = crate::arguments();
    let starts = args.next().and_then(|starts| starts.parse().ok());
    let only: Vec<String> = args.collect();
    let mut met = true;
    for (scenario, gains, aims) in MODES {
        if !only.is_empty() && !only.iter().any(|name| name == scenario) {
            continue;
        }
        match campaign(scenario, gains, aims, starts.unwrap_or(STARTS)) {
            Ok(all) => met &= all,
            Err(error) => {
                eprintln!("tune: {error}");
                return ExitCode::from(2);
            }
        }
    }
    ExitCode::from(u8::from(!met))
}

/// Tunes from as many bad starts; returns whether all robots pass after each.
fn campaign(scenario: &str, gains: &[&str], aims: &str, starts: usize) -> Result<bool, FileError> {
    let setup = Library::new().setup(scenario, &Overrides::default())?;
    let ids: Vec<ParamId> = gains
        .iter()
        .filter_map(|name| ParamId::from_name(name))
        .collect();
    let plan = drawn(&setup, &ids)?;
    let objective: Objective = match aims {
        "" => Objective::default(),
        aims => aims.parse().map_err(said)?,
    };
    let (mut tried, mut whole) = (0, 0);
    for point in 0..plan.points.len() {
        if tried == starts {
            break;
        }
        let start = plan.setup(&setup, point)?;
        let before = passes(&start, 1..TRIED + 1)?;
        if before == TRIED as usize {
            continue;
        }
        tried += 1;
        let over: Vec<Over> = ids.iter().map(|id| Over::Name(*id)).collect();
        let over = tuned(&start, &over)?;
        let search = Search {
            setup: &start,
            over: &over,
            objective: &objective,
            seed: 1,
            budget: Search::default_budget(&start),
        };
        let begun = Instant::now();
        let found = search.run(|_| (), &|| true)?;
        let took = begun.elapsed();
        let held_out = 1 + Search::SEEDS..1 + Search::SEEDS + HELD_OUT;
        let pass = passes(&search.setup_of(&found.values)?, held_out)?;
        whole += usize::from(pass == HELD_OUT as usize);
        let values = over
            .iter()
            .zip(&found.values)
            .map(|(one, value)| format!("{} {:.3} -> {value:.3}", one.id.name(), one.start));
        println!(
            "{scenario}, start {tried}: {before} of {TRIED} pass; after {:.0} s {pass} of {HELD_OUT} ({})",
            took.as_secs_f64(),
            values.collect::<Vec<_>>().join(", ")
        );
    }
    println!("{scenario}: all {HELD_OUT} pass after {whole} of {tried} starts");
    Ok(whole == starts)
}

/// Starts: each gain times a factor.
fn drawn(setup: &Setup, gains: &[ParamId]) -> Result<SweepPlan, FileError> {
    let mut now = Params::default();
    for (id, value) in setup.control_parameters()? {
        // Checked when it was read.
        let _ = now.set(id, value);
    }
    let axis = |id: &ParamId| {
        let (value, limits) = (f64::from(now.get(*id)), id.limits());
        let within = |value: f64| value.clamp(f64::from(limits.min), f64::from(limits.max));
        Axis {
            name: id.name().to_owned(),
            values: Values::Range {
                from: within(value / FACTOR),
                to: within(value * FACTOR),
                count: None,
                log: true,
            },
        }
    };
    SweepPlan::new(
        gains.iter().map(axis).collect(),
        Design::Random(DRAWN),
        1,
        1,
    )
    .map_err(said)
}

fn passes(setup: &Setup, seeds: std::ops::Range<u64>) -> Result<usize, FileError> {
    let jobs: Vec<_> = seeds.map(|seed| (setup, seed)).collect();
    let mut pass = 0;
    run_all(&jobs, |_, result| {
        pass += usize::from(result.pass);
        Ok::<(), FileError>(())
    })?;
    Ok(pass)
}

fn said(error: impl ToString) -> FileError {
    FileError::Setting(error.to_string())
}
