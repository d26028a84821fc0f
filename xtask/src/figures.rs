//! `cargo xtask figures`: the figures and tables of docs/theory, drawn by `tools/src/figures/`.

use crate::project::{Project, run as run_command};

/// Writes what is out of date: all sections, or those of these names.
pub(crate) fn run(project: &Project, only: &[String]) -> Result<bool, String> {
    draw(project, only).map(|()| true)
}

/// Fails if a figure or a table differs from what the sources give; writes nothing.
pub(crate) fn check(project: &Project) -> Result<(), String> {
    draw(project, &["--check".to_owned()])
}

/// Built as the tests are: the bytes are the same with any optimisation, and CI has already built these crates.
fn draw(project: &Project, args: &[String]) -> Result<(), String> {
    let program = project.program("rumbo-tools")?;
    run_command(project.command(program).arg("figures").args(args))
}
