//! The report's program as an Arduino sketch (`examples/arduino/memoria`) on the emulated Mega, beside its native form and our
//! core, natively and as the Mega's image: a metric of each scenario, and the chip's time.
//! `cargo xtask memoria` builds and starts it.
//!
//! Arguments: how many seeds (default 5), and scenarios (default all). All of them with 5 seeds go into
//! docs/theory/baseline.md, between its markers.

mod experiments;
mod time;

use crate::{factor, pages, runs};
use experiments::{Experiment, Metric, experiments};
use rumbo_experiment::files::{FileError, Library, NativeProgram, Overrides, Setup};
use rumbo_experiment::run::RunResult;
use std::process::ExitCode;
use time::Times;

const SEEDS: u64 = 5;

pub(crate) fn main() -> ExitCode {
    let mut names: Vec<String> = crate::arguments().collect();
    let seeds = names
        .first()
        .and_then(|first| first.parse().ok())
        .inspect(|_: &u64| drop(names.remove(0)));
    let printed = print(seeds.unwrap_or(SEEDS), &names);
    crate::ended("memoria", printed.map(|()| true))
}

/// Prints the tables, and writes the complete ones.
fn print(seeds: u64, names: &[String]) -> Result<(), FileError> {
    let mut whole = String::from(
        "| scenario | | the sketch | its native form | ours | ours on the Mega |\n\
         |---|---|---|---|---|---|\n",
    );
    let mut times = format!(
        "| the sketch, ours on the Mega | {} |\n{}\n",
        TIMES.map(|(what, _)| what).join(" | "),
        "|---".repeat(TIMES.len() + 1) + "|"
    );
    for experiment in experiments()? {
        if names.is_empty() || names.contains(&experiment.scenario) {
            eprintln!("{} ...", experiment.scenario);
            rows(&experiment, seeds, [&mut whole, &mut times])?;
        }
    }
    let whole = format!("{whole}\n{times}");
    println!("{whole}");
    if names.is_empty() && seeds == SEEDS {
        pages::write("docs/theory/baseline.md", "beside", &whole)?;
    }
    Ok(())
}

/// The scenario with our image.
fn our_setup(experiment: &Experiment) -> Result<Setup, FileError> {
    let overrides = Overrides {
        firmware: Some(pages::built("firmware/rumbo.elf")),
        ..Overrides::default()
    };
    Library::new().setup(&experiment.scenario, &overrides)
}

/// The scenario with the sketch at the pins.
fn sketch_setup(experiment: &Experiment) -> Result<Setup, FileError> {
    let overrides = Overrides {
        firmware: Some(pages::built(&format!(
            "sketches/memoria-{}.elf",
            experiment.sketch
        ))),
        ..Overrides::default()
    };
    slow(experiment, &overrides)
}

/// With the time that the report's program needs.
fn slow(experiment: &Experiment, overrides: &Overrides) -> Result<Setup, FileError> {
    let mut setup = Library::new().setup(&experiment.scenario, overrides)?;
    setup.scenario.duration_s = setup.scenario.duration_s.max(experiment.duration_s);
    if experiment.scenario == "mode8-goals" {
        for timed in setup.scenario.commands.iter_mut().skip(2) {
            timed.at_s *= 4.0;
        }
    }
    Ok(setup)
}

/// Appends the rows of a scenario to the tables of results and of times.
fn rows(
    experiment: &Experiment,
    seeds: u64,
    [whole, times]: [&mut String; 2],
) -> Result<(), FileError> {
    let natively = Overrides {
        program: NativeProgram::Baseline,
        ..Overrides::default()
    };
    let library = Library::new();
    let setups = [
        sketch_setup(experiment)?,
        slow(experiment, &natively)?,
        library.setup(&experiment.scenario, &Overrides::default())?,
        our_setup(experiment)?,
    ];
    let mut results = Vec::new();
    for setup in &setups {
        results.push(runs(setup, seeds)?);
    }
    let scenario = &experiment.scenario;
    let metric = &experiment.metric;
    *whole += &format!("| {scenario} | {} |", metric.what);
    for runs in &results {
        *whole += &format!(" {} |", cell(metric, runs));
    }
    *whole += "\n";
    let sketch = time::of_the_sketch(experiment)?;
    let mut ours = time::of_ours(experiment)?;
    // Without requested echoes, those of the idle sonars carry no information.
    ours.echo_to_pwm_ms = ours
        .echo_to_pwm_ms
        .filter(|_| sketch.echo_to_pwm_ms.is_some());
    let both = TIMES.map(|(_, figure)| [figure(&sketch), figure(&ours)].join(", "));
    *times += &format!("| {scenario} | {} |\n", both.join(" | "));
    Ok(())
}

/// A program's times as text, by name.
type Figure = fn(&Times) -> String;
const TIMES: [(&str, Figure); 7] = [
    ("period of the loop, median", |times| {
        format!("{:.0} ms", times.period_ms[0])
    }),
    ("longest", |times| format!("{:.1} ms", times.period_ms[1])),
    ("time that waits, at least", |times| percent(times.waits[1])),
    ("of it, for the line", |times| percent(times.waits[0])),
    ("echo to PWM, median", |times| {
        let text = times.echo_to_pwm_ms.map(|ms| format!("{ms:.1} ms"));
        text.unwrap_or_else(|| "-".to_owned())
    }),
    ("longest interrupt", |times| {
        format!("{:.1} us", times.interrupt_us)
    }),
    ("longest wait of an encoder's edge", |times| {
        let text = times.encoder_us.map(|us| format!("{us:.1} us"));
        text.unwrap_or_else(|| "-".to_owned())
    }),
];

fn percent(share: f64) -> String {
    format!("{:.0} %", 100.0 * share)
}

/// The results of the runs, in order.
fn sorted(metric: &Metric, runs: &[RunResult]) -> Vec<f64> {
    let value = |run: &RunResult| run.metrics.get(&metric.name).copied();
    let mut values: Vec<f64> = runs.iter().filter_map(value).collect();
    values.sort_by(f64::total_cmp);
    values
}

fn with_unit(number: String, metric: &Metric) -> String {
    if number == "never" {
        return number;
    }
    format!("{number} {}", metric.unit).trim_end().to_owned()
}

fn shown(metric: &Metric, value: f64) -> String {
    match value * factor(&metric.name, &metric.unit) {
        value if !value.is_finite() => "never".to_owned(),
        value if value.abs() >= 10.0 => format!("{value:.1}"),
        0.0 => "0".to_owned(),
        value => format!("{value:.2}"),
    }
}

/// Median, with min and max in parentheses.
fn cell(metric: &Metric, runs: &[RunResult]) -> String {
    let values = sorted(metric, runs);
    let (Some(least), Some(most)) = (values.first(), values.last()) else {
        return "-".to_owned();
    };
    let [median, least, most] =
        [values[values.len() / 2], *least, *most].map(|value| shown(metric, value));
    with_unit(format!("{median} ({least} to {most})"), metric)
}
