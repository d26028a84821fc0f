//! The report's program as an Arduino sketch (`examples/arduino/memoria`) on the emulated Mega, beside its native form and our
//! core: a table of metrics per scenario, and where the chip's time goes. `cargo xtask bench --only memoria`.
//!
//! Arguments: how many seeds (default 5), and scenarios (default all).

mod experiments;
mod time;

use experiments::{EXPERIMENTS, Experiment, Metric};
use rumbo_scenario::files::{FileError, Library, Overrides, Program, Setup};
use rumbo_scenario::run::{RunResult, run_all};
use std::path::PathBuf;
use std::process::ExitCode;

/// Robots that turn as the report's did (docs/theory/original.md).
const AS_RECORDED: [(&str, f64); 2] = [
    ("body.yaw_inertia_kg_m2", 0.0047),
    ("floor.yaw_damping_n_m_s", 0.016),
];

fn main() -> ExitCode {
    let mut names: Vec<String> = std::env::args().skip(1).collect();
    let seeds = names
        .first()
        .and_then(|first| first.parse().ok())
        .inspect(|_: &u64| drop(names.remove(0)));
    match print(seeds.unwrap_or(5), &names) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("memoria: {error}");
            ExitCode::FAILURE
        }
    }
}

fn print(seeds: u64, names: &[String]) -> Result<(), FileError> {
    let wanted: Vec<&Experiment> = EXPERIMENTS
        .iter()
        .filter(|one| names.is_empty() || names.iter().any(|name| name == one.scenario))
        .collect();
    for experiment in &wanted {
        println!("{}", table(experiment, seeds)?);
    }
    println!("{}", time::table(&wanted)?);
    Ok(())
}

/// Path of a sketch's image.
fn image(sketch: &str) -> PathBuf {
    // target/debug/examples/memoria -> target/sketches
    let here = std::env::current_exe().unwrap_or_default();
    let target = here.ancestors().nth(3).map(PathBuf::from);
    let target = target.unwrap_or_default();
    target.join(format!("sketches/memoria-{sketch}.elf"))
}

/// The scenario with the sketch at the pins.
fn sketch_setup(experiment: &Experiment, plant: &[(&str, f64)]) -> Result<Setup, FileError> {
    let overrides = Overrides {
        firmware: Some(image(experiment.sketch)),
        parameters: plant
            .iter()
            .map(|(name, value)| ((*name).to_owned(), *value))
            .collect(),
        ..Overrides::default()
    };
    slow(experiment, &overrides)
}

/// With the time that the report's program needs.
fn slow(experiment: &Experiment, overrides: &Overrides) -> Result<Setup, FileError> {
    let mut setup = Library::new().setup(experiment.scenario, overrides)?;
    setup.scenario.duration_s = setup.scenario.duration_s.max(experiment.duration_s);
    if experiment.scenario == "mode8-goals" {
        for timed in setup.scenario.commands.iter_mut().skip(2) {
            timed.at_s *= 4.0;
        }
    }
    Ok(setup)
}

fn table(experiment: &Experiment, seeds: u64) -> Result<String, FileError> {
    let natively = Overrides {
        program: Program::Original,
        ..Overrides::default()
    };
    let library = Library::new();
    let columns = [
        ("sketch", sketch_setup(experiment, &[])?),
        (
            "robots as recorded",
            sketch_setup(experiment, &AS_RECORDED)?,
        ),
        ("native form", slow(experiment, &natively)?),
        (
            "ours",
            library.setup(experiment.scenario, &Overrides::default())?,
        ),
    ];
    let mut text = format!("| {} |", experiment.scenario);
    for (title, _) in &columns {
        text += &format!(" {title} |");
    }
    text += "\n|---|---|---|---|---|\n";
    let mut results = Vec::new();
    for (_, setup) in &columns {
        results.push(runs(setup, seeds)?);
    }
    for metric in experiment.metrics {
        text += &format!("| {} |", metric.what);
        for runs in &results {
            text += &format!(" {} |", cell(metric, runs));
        }
        text += "\n";
    }
    Ok(text)
}

fn runs(setup: &Setup, seeds: u64) -> Result<Vec<RunResult>, FileError> {
    let jobs: Vec<_> = (1..=seeds).map(|seed| (setup, seed)).collect();
    let mut results = Vec::new();
    run_all(&jobs, |_, result| {
        results.push(result);
        Ok::<(), FileError>(())
    })?;
    Ok(results)
}

/// Median, and in parentheses least and most.
fn cell(metric: &Metric, runs: &[RunResult]) -> String {
    let value = |run: &RunResult| run.metrics.get(metric.name).copied();
    let mut values: Vec<f64> = runs.iter().filter_map(value).collect();
    values.sort_by(f64::total_cmp);
    let (Some(least), Some(most)) = (values.first(), values.last()) else {
        return "-".to_owned();
    };
    let shown = |value: f64| match value * metric.factor {
        value if !value.is_finite() => "never".to_owned(),
        value if value.abs() >= 10.0 => format!("{value:.1}"),
        0.0 => "0".to_owned(),
        value => format!("{value:.2}"),
    };
    let median = values[values.len() / 2];
    format!(
        "{} ({} to {}) {}",
        shown(median),
        shown(*least),
        shown(*most),
        metric.unit
    )
    .trim_end()
    .to_owned()
}
