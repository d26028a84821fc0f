//! `cargo xtask campaign`: every scenario with a thousand seeds, mode 8 in a thousand random worlds and beside planners of
//! the literature there, everything that can fail in the middle of drives, mode 8 among what moves, a million frames over
//! a link with faults, and the image for 75 minutes under a flood of bytes, and beside the native robot; sweeps of the
//! Python package on Ray, a policy learned with it; the fuzz targets for ten minutes each.
//!
//! Runs and requirements are those of `rumbo_experiment::campaign`. Each program is built in release mode, and its
//! output is printed as it comes.

use crate::gradescope;
use crate::project::{Project, shown};
use crate::release;
use crate::test::wheel;
use crate::tools;
use std::process::Stdio;

/// What is no scenario: its name, and how it is run with so many seeds; true if its requirements were met.
type Part = (
    &'static str,
    fn(&Project, Option<u32>) -> Result<bool, String>,
);

const PARTS: [Part; 14] = [
    // Frames over a link with faults.
    ("link", |project, _| {
        let example = ["rumbo-session", "--example", "link_campaign"];
        program(project, example, &[])
    }),
    // The image under a flood of bytes.
    ("image", |project, _| soak(project)),
    // The image beside the native robot.
    ("medians", |project, seeds| {
        crate::firmware::run(project)?;
        tool(project, "medians", &[up_to(20, seeds)])
    }),
    ("fuzz", |project, _| {
        crate::fuzz::campaign(project, Some(FUZZ_SECONDS), &[])
    }),
    // A class of a hundred hand-ins, thirty of them hostile.
    ("grade", |project, _| {
        tools::arduino_core(project)?;
        tools::bubblewrap(project)?;
        let tests = made_longer(project, of_cli("grade::"), "RUMBO_FULL", "1")?;
        Ok(tool(project, "grade", &[])? && tests)
    }),
    // Gradescope's autograder in a system like its container.
    ("gradescope", |project, _| {
        gradescope::try_it(project)?;
        Ok(true)
    }),
    // Simulated robots with known parameters, driven and identified.
    ("identify", |project, seeds| {
        made_longer(
            project,
            of_cli("identify::"),
            "RUMBO_ROBOTS",
            &up_to(100, seeds),
        )
    }),
    // Tuning from gains far off.
    ("tune", |project, seeds| {
        tool(project, "tune", &[up_to(10, seeds)])
    }),
    // Everything that can fail, natively and on the image.
    ("faults", faults),
    // Mode 8 among people who cross its way and among other robots.
    ("moving", |project, seeds| {
        tool(project, "moving", &seeds_or_write(seeds))
    }),
    // Mode 8 beside planners of the literature.
    ("beside", |project, seeds| {
        tool(project, "beside", &seeds_or_write(seeds))
    }),
    // Sweeps of the Python package on Ray.
    ("ray", |project, _| {
        wheel::on_ray(project)?;
        Ok(true)
    }),
    // A policy for mode 9, learned by the example of the Python package.
    ("python", |project, _| {
        wheel::learning(project)?;
        Ok(true)
    }),
    // The release on a system with nothing else, and the crates that others can use alone.
    ("release", |project, _| {
        release::try_it(project)?;
        wheel::in_clean_systems(project)?;
        release::try_crates(project)?;
        Ok(true)
    }),
];

/// Seeds of each fault, and for the image seeds and instants per drive.
const FAULTS_SEEDS: u32 = 50;
const FAULTS_SEEDS_IMAGE: u32 = 5;
const FAULTS_INSTANTS_IMAGE: u32 = 2;
/// Seconds of each fuzz target.
const FUZZ_SECONDS: u32 = 600;
/// Minutes of the image: past the wrap of the microseconds at 71.6.
const IMAGE_MINUTES: &str = "75";

/// Seeds of each scenario.
const SEEDS: u32 = 1000;

/// Runs the scenarios named in `only` (all if empty); true if all requirements were met.
pub(crate) fn run(project: &Project, seeds: Option<u32>, only: &[String]) -> Result<bool, String> {
    let mut met = true;
    for (name, part) in PARTS {
        if only.is_empty() || only.iter().any(|each| each == name) {
            met &= part(project, seeds)?;
        }
    }
    let is_scenario = |name: &&String| PARTS.iter().all(|(part, _)| part != name);
    let mut scenarios = vec![seeds.unwrap_or(SEEDS).to_string()];
    scenarios.extend(only.iter().filter(is_scenario).cloned());
    if only.is_empty() || scenarios.len() > 1 {
        met &= tool(project, "campaign", &scenarios)?;
    }
    Ok(met)
}

/// So many seeds; all of them make the tables of the docs.
fn seeds_or_write(seeds: Option<u32>) -> Vec<String> {
    match seeds {
        Some(seeds) => vec!["--seeds".to_owned(), seeds.to_string()],
        None => vec!["--write".to_owned()],
    }
}

/// As many as were asked for, at most these.
fn up_to(most: u32, seeds: Option<u32>) -> String {
    seeds.unwrap_or(most).min(most).to_string()
}

/// Tests of the command line.
const fn of_cli(test: &str) -> [&str; 3] {
    ["rumbo-cli", "cli", test]
}

/// Runs tests of a package, of which this variable makes one longer; true if they passed.
fn made_longer(
    project: &Project,
    [package, program, test]: [&str; 3],
    variable: &str,
    value: &str,
) -> Result<bool, String> {
    let mut command = project.cargo(&["test", "--quiet", "--release", "--locked"]);
    command.args(["--package", package, "--test", program, test]);
    command.args(["--", "--nocapture"]).env(variable, value);
    let status = command
        .stdin(Stdio::null())
        .status()
        .map_err(|error| format!("{}: {error}", shown(&command)))?;
    Ok(status.success())
}

/// Breaks everything, natively and on the image; with all seeds the tables of the docs are made.
fn faults(project: &Project, seeds: Option<u32>) -> Result<bool, String> {
    crate::firmware::run(project)?;
    let native = seeds.unwrap_or(FAULTS_SEEDS);
    let image = native.min(FAULTS_SEEDS_IMAGE);
    let write = if seeds.is_none() { " --write" } else { "" };
    let mut met = true;
    for how in [
        format!("--seeds {native} --list{write}"),
        format!("--image --seeds {image} --instants {FAULTS_INSTANTS_IMAGE} --list{write}"),
    ] {
        let args: Vec<String> = how.split(' ').map(str::to_owned).collect();
        met &= tool(project, "faults", &args)?;
    }
    Ok(met)
}

/// Runs the image for long; true if its test passed.
fn soak(project: &Project) -> Result<bool, String> {
    crate::firmware::run(project)?;
    let tests = ["rumbo-firmware-tests", "firmware", "soak"];
    made_longer(project, tests, "RUMBO_SOAK_MINUTES", IMAGE_MINUTES)
}

/// Runs a program of `tools/`; true if it found all requirements met.
fn tool(project: &Project, name: &str, args: &[String]) -> Result<bool, String> {
    let args = [&[name.to_owned()], args].concat();
    program(project, ["rumbo-tools", "--bin", "rumbo-tools"], &args)
}

/// Runs a program of a package, `--bin` or `--example`; true if it found all requirements met.
fn program(
    project: &Project,
    [package, kind, name]: [&str; 3],
    args: &[String],
) -> Result<bool, String> {
    let mut command = project.cargo(&[
        "run",
        "--quiet",
        "--release",
        "--locked",
        "--package",
        package,
        kind,
        name,
        "--",
    ]);
    command.args(args);
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
