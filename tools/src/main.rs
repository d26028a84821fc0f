//! Rumbo's tools: campaigns, comparisons and the figures of the docs, as `cargo xtask` starts them. The first argument is
//! the tool; those that follow are its own.

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
use std::process::ExitCode;

/// The names, as one types them.
const NAMES: [&str; 14] = [
    "alone",
    "beside",
    "campaign",
    "counts",
    "faults",
    "fidelity",
    "figures",
    "grade",
    "hashes",
    "medians",
    "memoria",
    "moving",
    "random_worlds",
    "tune",
];

fn main() -> ExitCode {
    match std::env::args().nth(1).unwrap_or_default().as_str() {
        "alone" => counts::chip_alone(),
        "beside" => beside::main(),
        "campaign" => campaign::main(),
        "counts" => counts::main(),
        "faults" => faults::main(),
        "fidelity" => fidelity::main(),
        "figures" => figures::main(),
        "grade" => grade::main(),
        "hashes" => hashes::main(),
        "medians" => medians::main(),
        "memoria" => memoria::main(),
        "moving" => moving::main(),
        "tune" => tune::main(),
        "random_worlds" => match random_worlds::main() {
            Ok(()) => ExitCode::SUCCESS,
            Err(error) => {
                eprintln!("random_worlds: {error}");
                ExitCode::FAILURE
            }
        },
        other => {
            eprintln!("no tool `{other}`; tools: {}", NAMES.join(", "));
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
