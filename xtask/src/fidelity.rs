//! `cargo xtask fidelity`: where the report's robot lies among simulated ones, by `tools/src/fidelity/`.

use crate::project::{Project, run as run_command};

/// Prints the table of `seeds` robots and the scenarios in `only`. Without either it goes into the docs.
pub(crate) fn run(project: &Project, seeds: Option<u32>, only: &[String]) -> Result<bool, String> {
    if std::env::var_os("RUMBO_DATA").is_none() {
        return Err("fidelity needs the recorded runs; set RUMBO_DATA to their folder".to_owned());
    }
    let mut command = project.cargo(&["run", "--locked", "-p", "rumbo-tools", "--", "fidelity"]);
    if let Some(seeds) = seeds {
        command.args(["--seeds", &seeds.to_string()]);
    }
    command.args(only);
    if only.is_empty() && seeds.is_none() {
        command.arg("--write");
    }
    run_command(&mut command)?;
    Ok(true)
}
