//! `cargo xtask memoria`: the report's program as an Arduino sketch, its native form, our core and our image, scenario by scenario.
//!
//! The tables of docs/theory/baseline.md come from here;
//! `tools/src/memoria/` runs all of it.

use crate::project::{Project, run as run_command};
use crate::sketches;

/// Prints the tables: of `seeds` robots, of the scenarios in `only` (all if empty).
pub(crate) fn run(project: &Project, seeds: Option<u32>, only: &[String]) -> Result<bool, String> {
    sketches::run(project)?;
    crate::firmware::run(project)?;
    let mut program = project.cargo(&["run", "--locked", "-p", "rumbo-tools", "--", "memoria"]);
    program
        .args(seeds.map(|seeds| seeds.to_string()))
        .args(only);
    run_command(&mut program).map(|()| true)
}
