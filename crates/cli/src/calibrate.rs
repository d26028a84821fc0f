//! `rumbo calibrate`: the calibration of a simulated robot, beside its true values.

use crate::args::{CalibrateArgs, OverwriteArgs};
use crate::failure::Failure;
use crate::output::{self, figure};
use crate::place;
use crate::run_log::{Kept, RunSource};
use rumbo_experiment::calibrate::{self, Calibration, CalibrationRow};
use rumbo_experiment::calibration_run;
use rumbo_experiment::files::{Library, Overrides, RobotFile, Setup, bounded};
use rumbo_log::LogKind;
use rumbo_plant::rewrite::RewriteError;
use rumbo_station::Extras;
use serde::Serialize;
use std::path::Path;

/// The outcome as JSON.
#[derive(Serialize)]
struct Report<'a> {
    robot: &'a str,
    seed: u64,
    duration_s: f64,
    way_m: f64,
    contacts: u32,
    quantities: &'a [CalibrationRow],
    parameters: Vec<(&'static str, f64)>,
    written: Option<String>,
}

/// The calibration of the robot in the dashboard, started by its button.
pub(crate) fn in_dashboard() -> Extras {
    Extras {
        calibration: Some(rumbo_lab::calibration),
        ..Extras::default()
    }
}

/// Calibrates and prints the result.
pub(crate) fn calibrate(args: &CalibrateArgs) -> Result<(), Failure> {
    let overrides = Overrides {
        robot: Some(args.robot.clone()),
        rig: args.rig.clone(),
        world: args.world.clone(),
        parameters: args.parameters.params.clone(),
        ..Overrides::default()
    };
    let setup = calibration_run::calibration_setup(&overrides)?;
    if let Some(path) = &args.out {
        check_robot(path, &args.robot, calibrate::is_calibrated, args.overwrite)?;
    }
    let run = calibration_run::run_calibration(&setup, args.seed.seed)?;
    let source = RunSource {
        kind: LogKind::Calibration,
        library: &Library::new(),
        overrides: &overrides,
    };
    let mut kept = Kept::of(1, !args.no_record);
    kept.take(&source, &setup, &run.result);
    kept.report();
    let found = run.found.map_err(Failure::input)?;
    let rows = calibrate::rows(&found, Some(run.sim.params()));
    let contacts = run.sim.truth().contacts;
    let written = args.out.as_deref();
    if let Some(path) = written {
        write(path, &setup, &found)?;
    }
    let parameters = found.parameters().into_iter();
    let parameters: Vec<(&'static str, f64)> = parameters
        .map(|(id, value)| (id.name(), rumbo_experiment::files::parameters::exact(value)))
        .collect();
    if args.json {
        return output::json(&Report {
            robot: &args.robot,
            seed: args.seed.seed,
            duration_s: found.duration_s,
            way_m: found.way_m,
            contacts,
            quantities: &rows,
            parameters,
            written: written.map(output::shown),
        });
    }
    report(&found, &rows, contacts, args.seed.seed)?;
    match written {
        Some(path) => output::remark(&format!(
            "{}: its [parameters] table holds what was found",
            path.display()
        )),
        None => {
            output::remark("[parameters]")?;
            parameters
                .iter()
                .try_for_each(|(name, value)| output::line(&format!("{name} = {value}")))
        }
    }
}

fn report(
    found: &Calibration,
    rows: &[CalibrationRow],
    contacts: u32,
    seed: u64,
) -> Result<(), Failure> {
    output::line(&format!(
        "seed {seed}: {:.1} m along the wall in {:.0} s, contacts {contacts}",
        found.way_m, found.duration_s
    ))?;
    let mut table = vec![
        ["", "found", "standard error", "truth", "off by"]
            .map(String::from)
            .to_vec(),
    ];
    for row in rows {
        let exactly = |value: f64| format!("{value:.6}");
        table.push(vec![
            row.name.clone(),
            exactly(row.found),
            row.standard_error.map(figure).unwrap_or_default(),
            row.truth.map(exactly).unwrap_or_default(),
            row.truth
                .map(|truth| format!("{:+.3} %", (row.found / truth - 1.0) * 100.0))
                .unwrap_or_default(),
        ]);
    }
    output::table(&table)?;
    match found.radius_m {
        Some(sonar) if sonar.error < found.radius_before_m.error => {
            output::line("  mean radius: the front sonar's is taken")
        }
        Some(_) => output::line(
            "  mean radius: stays as it is; the front sonar knows it no better than the speed of sound is known, 0.9 % either way",
        ),
        None => output::line("  mean radius: stays as it is; the front sonar saw nothing ahead"),
    }
}

/// Refuses, before anything runs, to write over parameters that a person chose, unless they are those of the robot at
/// hand.
pub(crate) fn check_robot(
    path: &Path,
    robot: &str,
    is_ours: impl FnOnce(&str) -> bool,
    overwrite: OverwriteArgs,
) -> Result<(), Failure> {
    let is_robot = same_file::is_same_file(path, robot).unwrap_or(false);
    place::try_file(path)?;
    if overwrite.force || is_robot || !path.is_file() {
        return Ok(());
    }
    let file = path.display().to_string();
    let read = bounded::read_text(path);
    let text = read.map_err(|error| Failure::Input(format!("{file}: cannot be read ({error})")))?;
    let before = RobotFile::parse("", &file, &text)?;
    if before.parameters.is_empty() || is_ours(&text) {
        return Ok(());
    }
    Err(Failure::Input(format!(
        "{file}: has [parameters] that were not found by this command; choose another place, or replace them with --force"
    )))
}

fn write(path: &Path, setup: &Setup, found: &Calibration) -> Result<(), Failure> {
    rewrite_robot(path, setup, |text, today| {
        calibrate::rewrite(text, found, today)
    })
}

/// Writes parameters into a robot file: an existing one is rewritten, a new one starts as a copy of the robot's.
/// `rewrite` gets the text and the date.
pub(crate) fn rewrite_robot(
    path: &Path,
    setup: &Setup,
    rewrite: impl FnOnce(&str, &str) -> Result<String, RewriteError>,
) -> Result<(), Failure> {
    let file = path.display().to_string();
    let wrong = |what: String| Failure::Input(format!("{file}: {what}"));
    let text = if path.exists() {
        bounded::read_text(path).map_err(|error| wrong(format!("cannot be read ({error})")))?
    } else {
        setup.robot.text.clone()
    };
    place::write(path, rewritten(&file, &text, rewrite)?)
}

/// The text of a robot file, which messages call `file`, with other parameters; `rewrite` gets it and the date.
pub(crate) fn rewritten(
    file: &str,
    text: &str,
    rewrite: impl FnOnce(&str, &str) -> Result<String, RewriteError>,
) -> Result<String, Failure> {
    let today = rumbo_station::today_utc();
    let text = rewrite(text, &today)
        .map_err(|error| Failure::Input(format!("{file}: is no robot file ({error})")))?;
    RobotFile::parse("", file, &text)?;
    Ok(text)
}
