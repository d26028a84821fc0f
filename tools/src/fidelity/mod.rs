//! Where the report's robot lies among simulated ones: its recorded figures beside those of drawn robots that its own
//! program drives.
//!
//! ```text
//! recordings (RUMBO_DATA) ──► battery and floor of that day ──┐
//! robot file ──► robots drawn by seed ────────────────────────┴─► runs of the report's program ──► table, drawing
//! ```
//!
//! `cargo xtask fidelity` starts it. Arguments: `--seeds N` (200), `--write` (into the docs), and scenarios (none: all).

#![allow(missing_docs)]

mod days;
mod drawing;
mod figures;
mod measured;
mod place;
mod robots;

use crate::arguments::Arguments;
use crate::{factor, pages};
use days::Days;
use figures::{Experiment, experiments};
use measured::Recorded;
use place::Place;
use robots::Robots;
use rumbo_experiment::files::FileError;
use std::path::PathBuf;
use std::process::ExitCode;

/// The page that holds the table, seen from the root.
const PAGE: &str = "docs/theory/baseline.md";

/// Robots drawn.
const SEEDS: u64 = 200;

pub(crate) fn main() -> ExitCode {
    crate::ended("fidelity", compare().map(|()| true))
}

/// Prints the table and draws it.
fn compare() -> Result<(), FileError> {
    let experiments = experiments()?;
    let scenarios: Vec<&str> = experiments
        .iter()
        .map(|one| one.scenario.as_str())
        .collect();
    let arguments = Arguments::read(&["--seeds"], &["--write"], &scenarios)?;
    let recordings = recordings()?;
    let robots = Robots::new(arguments.number("--seeds", SEEDS))?;
    let days = Days::read(&recordings, &experiments, robots.plant())?;
    let mut table = String::from(
        "| run | figure | recorded | drawn robots, median (5 to 95 %) | recorded lies at | 5 to 95 % | 25 to 75 % | on that day |\n\
         |---|---|---|---|---|---|---|---|\n",
    );
    let (mut all, mut near_on_the_day, mut on_the_day) = (Vec::new(), 0, 0);
    let wanted = |one: &&Experiment| arguments.wants(&one.scenario);
    for experiment in experiments.iter().filter(wanted) {
        eprintln!("{}: {} robots", experiment.name, robots.seeds);
        let steps = match (experiment.is_measured(), &experiment.recording) {
            (true, Some(name)) => Some(Recorded::read(&recordings.join(name))?),
            _ => None,
        };
        let drawn = runs(&robots, experiment, steps.as_ref(), &[])?;
        let that_day = match days.of(experiment) {
            Some(day) => Some(runs(&robots, experiment, steps.as_ref(), &day)?),
            None => None,
        };
        let settling_s = steps.as_ref().map(Recorded::settling_s);
        for (index, figure) in experiment.figures.iter().enumerate() {
            let settled_s = settling_s.as_ref().zip(figure.measured_step());
            let settled_s = settled_s.and_then(|(settling_s, step)| settling_s.get(step).copied());
            let recorded = settled_s.unwrap_or(figure.recorded);
            let place = Place::new(&drawn[index], recorded);
            let day = that_day
                .as_ref()
                .map(|runs| Place::new(&runs[index], recorded));
            if let Some(day) = &day {
                on_the_day += 1;
                near_on_the_day += usize::from(day.is_near());
            }
            table += &place.row(&experiment.name, figure, day.as_ref());
            all.push((experiment.name.as_str(), figure.what.as_str(), place));
        }
    }
    table += &summary(&all, robots.seeds, [near_on_the_day, on_the_day]);
    println!("{table}");
    if arguments.has("--write") {
        pages::write(PAGE, "fidelity", &table)?;
        pages::write_figure("fidelity", &drawing::svg(&all))?;
    }
    Ok(())
}

/// What the page says below the table; of the figures with a recording, how many medians are near, and all.
fn summary(all: &[(&str, &str, Place)], robots: u64, [near, recorded]: [usize; 2]) -> String {
    let share =
        |within: fn(&Place) -> bool| all.iter().filter(|(_, _, place)| within(place)).count();
    format!(
        "\n{robots} robots. Of {} figures {} lie within 5 to 95 % of the drawn robots and {} within 25 to 75 %; of {recorded} with a recording,\n\
         {near} medians of robots with that day's battery and floor are within 20 % of it.",
        all.len(),
        share(Place::within_ninety),
        share(Place::within_fifty),
    )
}

/// The folder of the recorded runs.
fn recordings() -> Result<PathBuf, FileError> {
    let unset = "RUMBO_DATA is not set; set it to the folder of the recorded runs (mode1_stop_at_wall.csv and others)";
    let folder = std::env::var_os("RUMBO_DATA").map(PathBuf::from);
    folder.ok_or_else(|| FileError::Setting(unset.to_owned()))
}

/// The figures of an experiment on each drawn robot, with these numbers of the plant set; what never happened is
/// infinite.
fn runs(
    robots: &Robots,
    experiment: &Experiment,
    recorded: Option<&Recorded>,
    day: &[(String, f64)],
) -> Result<Vec<Vec<f64>>, FileError> {
    let mut setup = robots.setup(&experiment.scenario, day)?;
    setup.scenario.duration_s = experiment.duration_s.unwrap_or(setup.scenario.duration_s);
    for timed in setup.scenario.commands.iter_mut().skip(2) {
        timed.at_s *= experiment.later.unwrap_or(1.0);
    }
    if let Some(recorded) = recorded {
        recorded.steer(&mut setup);
    }
    let mut figures = vec![Vec::new(); experiment.figures.len()];
    robots.run(&setup, |result| {
        let measured = recorded.map(|recorded| recorded.simulated_settling_s(result));
        for (values, figure) in figures.iter_mut().zip(&experiment.figures) {
            let value = match (figure.measured_step(), &measured) {
                (Some(step), Some(measured)) => measured.get(step).copied(),
                _ => result.metrics.get(&figure.metric).copied(),
            };
            let value = value.filter(|value| !value.is_nan());
            values.push(value.map_or(f64::INFINITY, |value| {
                value * factor(&figure.metric, &figure.unit)
            }));
        }
    })?;
    Ok(figures)
}
