//! `cargo xtask campaign`: every scenario with a thousand seeds, mode 8 in a thousand random worlds and beside planners of
//! the literature there, everything that can fail in the middle of drives, mode 8 among what moves, a million frames over
//! a link with faults, and the image for 75 minutes under a flood of bytes, and beside the native robot; sweeps of the
//! Python package on Ray, a policy learned with it; the fuzz targets for ten minutes each.
//!
//! Runs and requirements are those of `rumbo_experiment::campaign`. Each program is built in release mode, and its
//! output is printed as it comes.

use crate::project::{Project, shown};
use crate::release;
use crate::test::{Stop, tools, wheel};
use std::process::Stdio;

/// The part that is not a scenario.
const LINK: &str = "link";

/// The part that drives the image: a test, made longer.
const IMAGE: &str = "image";
/// The part that compares the image with the native robot.
const MEDIANS: &str = "medians";
/// Its seeds.
const MEDIANS_SEEDS: u32 = 20;
/// Everything that can fail, natively and on the image.
const FAULTS: &str = "faults";
/// Seeds of it, and for the image seeds and instants per drive.
const FAULTS_SEEDS: u32 = 50;
const FAULTS_SEEDS_IMAGE: u32 = 5;
const FAULTS_INSTANTS_IMAGE: u32 = 2;
/// Mode 8 among people who cross its way and among other robots.
const MOVING: &str = "moving";
/// Mode 8 beside planners of the literature.
const BESIDE: &str = "beside";
/// The fuzz targets.
const FUZZ: &str = "fuzz";
/// A class of a hundred hand-ins, thirty of them hostile.
const GRADE: &str = "grade";
/// Simulated robots with known parameters, driven and identified.
const IDENTIFY: &str = "identify";
const IDENTIFY_ROBOTS: u32 = 100;
/// Tuning from gains far off.
const TUNE: &str = "tune";
const TUNE_STARTS: u32 = 10;
/// Sweeps of the Python package on Ray.
const RAY: &str = "ray";
/// A policy for mode 9, learned by the example of the Python package.
const PYTHON: &str = "python";
/// The release on a system with nothing else, and the crates that others can use alone.
const RELEASE: &str = "release";
/// Seconds of each.
const FUZZ_SECONDS: u32 = 600;
/// Minutes of [`IMAGE`]: past the wrap of the microseconds at 71.6.
const IMAGE_MINUTES: &str = "75";

/// Seeds of each scenario.
const SEEDS: u32 = 1000;

/// Runs the scenarios named in `only` (all if empty); true if all requirements were met.
pub(crate) fn run(project: &Project, seeds: Option<u32>, only: &[String]) -> Result<bool, String> {
    let mut met = true;
    if only.is_empty() || only.iter().any(|name| name == LINK) {
        met &= program(
            project,
            ["rumbo-session", "--example", "link_campaign"],
            &[],
        )?;
    }
    if only.is_empty() || only.iter().any(|name| name == IMAGE) {
        met &= soak(project)?;
    }
    if only.is_empty() || only.iter().any(|name| name == MEDIANS) {
        crate::firmware::run(project)?;
        let seeds = seeds.unwrap_or(MEDIANS_SEEDS).min(MEDIANS_SEEDS);
        met &= tool(project, MEDIANS, &[seeds.to_string()])?;
    }
    if only.is_empty() || only.iter().any(|name| name == FUZZ) {
        met &= crate::fuzz::campaign(project, Some(FUZZ_SECONDS), &[])?;
    }
    if only.is_empty() || only.iter().any(|name| name == GRADE) {
        tools::arduino_core(project).map_err(said)?;
        tools::bubblewrap(project).map_err(said)?;
        met &= made_longer(project, "grade::", "RUMBO_FULL", "1")?;
        met &= tool(project, GRADE, &[])?;
    }
    if only.is_empty() || only.iter().any(|name| name == IDENTIFY) {
        let robots = seeds.unwrap_or(IDENTIFY_ROBOTS).min(IDENTIFY_ROBOTS);
        met &= made_longer(project, "identify::", "RUMBO_ROBOTS", &robots.to_string())?;
    }
    if only.is_empty() || only.iter().any(|name| name == TUNE) {
        let starts = seeds.unwrap_or(TUNE_STARTS).min(TUNE_STARTS);
        met &= tool(project, TUNE, &[starts.to_string()])?;
    }
    if only.is_empty() || only.iter().any(|name| name == FAULTS) {
        met &= faults(project, seeds)?;
    }
    if only.is_empty() || only.iter().any(|name| name == MOVING) {
        let args = match seeds {
            Some(seeds) => vec!["--seeds".to_owned(), seeds.to_string()],
            None => vec!["--write".to_owned()],
        };
        met &= tool(project, MOVING, &args)?;
    }
    if only.is_empty() || only.iter().any(|name| name == BESIDE) {
        let args = match seeds {
            Some(seeds) => vec!["--seeds".to_owned(), seeds.to_string()],
            None => vec!["--write".to_owned()],
        };
        met &= tool(project, BESIDE, &args)?;
    }
    if only.is_empty() || only.iter().any(|name| name == RAY) {
        wheel::on_ray(project).map_err(said)?;
    }
    if only.is_empty() || only.iter().any(|name| name == PYTHON) {
        wheel::learning(project).map_err(said)?;
    }
    if only.is_empty() || only.iter().any(|name| name == RELEASE) {
        release::try_it(project).map_err(said)?;
        release::try_crates(project)?;
    }
    let mut scenarios = vec![seeds.unwrap_or(SEEDS).to_string()];
    scenarios.extend(
        only.iter()
            .filter(|name| {
                ![
                    LINK, IMAGE, MEDIANS, FUZZ, GRADE, IDENTIFY, TUNE, FAULTS, MOVING, BESIDE, RAY,
                    PYTHON, RELEASE,
                ]
                .contains(&name.as_str())
            })
            .cloned(),
    );
    if only.is_empty() || scenarios.len() > 1 {
        met &= tool(project, "campaign", &scenarios)?;
    }
    Ok(met)
}

/// Runs tests of the command line, of which this variable makes one longer; true if they passed.
fn made_longer(project: &Project, test: &str, variable: &str, value: &str) -> Result<bool, String> {
    let mut command = project.cargo(&[
        "test",
        "--quiet",
        "--release",
        "--locked",
        "--package",
        "rumbo-cli",
        "--test",
        "cli",
        test,
        "--",
        "--nocapture",
    ]);
    command.env(variable, value);
    let status = command
        .stdin(Stdio::null())
        .status()
        .map_err(|error| format!("{}: {error}", shown(&command)))?;
    Ok(status.success())
}

/// Why a tool is not there.
fn said(stop: Stop) -> String {
    match stop {
        Stop::Failed(error) | Stop::Missing(error) => error,
    }
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
        met &= tool(project, FAULTS, &args)?;
    }
    Ok(met)
}

/// Runs the image for long; true if its test passed.
fn soak(project: &Project) -> Result<bool, String> {
    crate::firmware::run(project)?;
    let mut command = project.cargo(&[
        "test",
        "--quiet",
        "--release",
        "--locked",
        "--package",
        "rumbo-firmware-tests",
        "--test",
        "firmware",
        "soak",
        "--",
        "--nocapture",
    ]);
    command.env("RUMBO_SOAK_MINUTES", IMAGE_MINUTES);
    let status = command
        .stdin(Stdio::null())
        .status()
        .map_err(|error| format!("{}: {error}", shown(&command)))?;
    Ok(status.success())
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
