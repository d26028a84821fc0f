//! Code shared by the tools.

pub mod pages;

use rumbo_experiment::files::{FileError, Setup};
use rumbo_experiment::run::{RunResult, run_all};

/// A run with each seed from 1 on.
///
/// # Errors
/// The scenario cannot be run.
pub fn runs(setup: &Setup, seeds: u64) -> Result<Vec<RunResult>, FileError> {
    let jobs: Vec<_> = (1..=seeds).map(|seed| (setup, seed)).collect();
    let mut results = Vec::new();
    run_all(&jobs, |_, result| {
        results.push(result);
        Ok::<(), FileError>(())
    })?;
    Ok(results)
}
