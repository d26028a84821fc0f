//! Rumbo's tools: campaigns, comparisons and the figures of the docs, as `cargo xtask` starts them. The first argument is
//! the tool; those that follow are its own.

mod arguments;
mod beside;
mod campaign;
mod counts;
mod faults;
mod fidelity;
mod figures;
mod grade;
mod hashes;
mod medians;
mod memoria;
mod moving;
mod pages;
mod random_worlds;
mod tune;

use rumbo_experiment::files::{FileError, Setup};
use rumbo_experiment::run::{RunResult, run_all};
use serde::de::DeserializeOwned;
use std::f64::consts::PI;
use std::fmt::Display;
use std::process::ExitCode;

/// A tool: its name, as one types it, and what it does.
type Tool = (&'static str, fn() -> ExitCode);

const TOOLS: [Tool; 14] = [
    ("alone", counts::chip_alone),
    ("beside", beside::main),
    ("campaign", campaign::main),
    ("counts", counts::main),
    ("faults", faults::main),
    ("fidelity", fidelity::main),
    ("figures", figures::main),
    ("grade", grade::main),
    ("hashes", hashes::main),
    ("medians", medians::main),
    ("memoria", memoria::main),
    ("moving", moving::main),
    ("random_worlds", random_worlds::main),
    ("tune", tune::main),
];

fn main() -> ExitCode {
    let name = std::env::args().nth(1).unwrap_or_default();
    let Some((_, tool)) = TOOLS.iter().find(|(known, _)| *known == name) else {
        let names = TOOLS.map(|(known, _)| known).join(", ");
        eprintln!("no tool `{name}`; tools: {names}");
        return ExitCode::from(2);
    };
    tool()
}

/// What a metric is multiplied with to be shown in a unit; a duty is shown as PWM, of 255.
fn factor(metric: &str, unit: &str) -> f64 {
    match unit {
        "cm" => 100.0,
        "deg" => 180.0 / PI,
        "ms" => 1_000.0,
        "rpm" => 30.0 / PI,
        "" if metric.ends_with("_duty") => 255.0,
        _ => 1.0,
    }
}

/// A file of `tools/data`.
fn data<T: DeserializeOwned>(text: &str) -> Result<T, FileError> {
    toml::from_str(text).map_err(|error| FileError::Setting(format!("tools/data: {error}")))
}

/// The status of a tool that found its requirements met or missed, or ended by an error.
fn ended(name: &str, met: Result<bool, impl Display>) -> ExitCode {
    match met {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("{name}: {error}");
            ExitCode::from(2)
        }
    }
}

/// The arguments of the tool.
fn arguments() -> impl Iterator<Item = String> {
    std::env::args().skip(2)
}

/// A run with each seed from 1 on.
///
/// # Errors
/// The scenario cannot be run.
fn runs(setup: &Setup, seeds: u64) -> Result<Vec<RunResult>, FileError> {
    let jobs: Vec<_> = (1..=seeds).map(|seed| (setup, seed)).collect();
    let mut results = Vec::new();
    run_all(&jobs, |_, result| {
        results.push(result);
        Ok::<(), FileError>(())
    })?;
    Ok(results)
}
