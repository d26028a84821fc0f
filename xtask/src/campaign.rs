//! `cargo xtask campaign`: every scenario with a thousand seeds, and mode 8 in a thousand random worlds.
//!
//! The runs and what is required of them are the scenario crate's (`rumbo_scenario::campaign`); its example is built as users get the
//! program, optimised, and printed as it comes.

use crate::project::{Project, shown};
use std::process::Stdio;

/// Seeds of each scenario.
const SEEDS: u32 = 1000;

/// Runs the scenarios named in `only` (all if empty); true if everything required was met.
pub(crate) fn run(project: &Project, seeds: Option<u32>, only: &[String]) -> Result<bool, String> {
    let mut command = project.cargo(&[
        "run",
        "--quiet",
        "--release",
        "--locked",
        "--package",
        "rumbo-scenario",
        "--example",
        "campaign",
        "--",
    ]);
    command.arg(seeds.unwrap_or(SEEDS).to_string()).args(only);
    let status = command
        .stdin(Stdio::null())
        .status()
        .map_err(|error| format!("{}: {error}", shown(&command)))?;
    match status.code() {
        Some(0) => Ok(true),
        Some(1) => Ok(false),
        _ => Err(format!("`{}` failed: {status}", shown(&command))),
    }
}
