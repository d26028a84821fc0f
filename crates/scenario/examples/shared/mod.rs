//! What the examples that compare programs have in common.

pub(crate) mod pages;

use rumbo_scenario::files::{FileError, Setup};
use rumbo_scenario::run::{RunResult, run_all};
use std::path::PathBuf;

/// A file beside the folder that this program was built into: of `target/debug/examples/NAME`, `target/FILE`.
pub(crate) fn built(file: &str) -> PathBuf {
    let here = std::env::current_exe().unwrap_or_default();
    let target = here.ancestors().nth(3).map(PathBuf::from);
    target.unwrap_or_default().join(file)
}

/// A run with each seed from 1 on.
///
/// # Errors
/// The scenario cannot be run.
pub(crate) fn runs(setup: &Setup, seeds: u64) -> Result<Vec<RunResult>, FileError> {
    let jobs: Vec<_> = (1..=seeds).map(|seed| (setup, seed)).collect();
    let mut results = Vec::new();
    run_all(&jobs, |_, result| {
        results.push(result);
        Ok::<(), FileError>(())
    })?;
    Ok(results)
}
