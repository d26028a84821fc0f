//! `rumbo identify`: the plant's parameters from recorded runs, or how well a robot file reproduces them.

mod drive;
mod session;

use crate::args::IdentifyArgs;
use crate::failure::Failure;
use crate::interrupt;
use crate::logs;
use crate::mark::Mark;
use crate::output::{self, figure};
use crate::place::{self, Guard};
use drive::Driving;
use indicatif::{ProgressBar, ProgressStyle};
use rumbo_experiment::files::{Library, RobotFile, bounded};
use rumbo_identify::sonar_stats::{self, Comparison};
use rumbo_identify::{
    AgainstTruth, FitProgress, Identification, IdentifyError, Recordings, RecordingsOutcome,
};
use rumbo_plant::params::Params;
use rumbo_plot::{Sheet, WIDTH, Words};
use rumbo_report::FileStamp;
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// The outcome as JSON.
#[derive(Serialize)]
struct Report<'a> {
    robot: &'a str,
    #[serde(flatten)]
    drive: &'a RecordingsOutcome,
    /// Measured and simulated figures of each sonar of the runs.
    sonars: &'a [Comparison],
    plots: Vec<String>,
    /// The log of the drive.
    log: Option<String>,
    /// A simulated robot's true parameters.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    against_truth: Vec<AgainstTruth>,
    /// Why the parameters are not to be believed.
    #[serde(skip_serializing_if = "<[String]>::is_empty")]
    doubts: &'a [String],
    written: Option<String>,
}

/// Identifies, or checks, and prints the result.
pub(crate) fn identify(args: &IdentifyArgs) -> Result<(), Failure> {
    let name = args.check.as_ref().unwrap_or(&args.robot);
    let robot = Library::new().robot(name)?;
    if let Some(path) = &args.write {
        place::try_file(path)?;
    }
    let driving = drive(args, name)?;
    let driven = driving.iter().map(|driving| driving.path.clone());
    let paths: Vec<PathBuf> = args.logs.iter().cloned().chain(driven).collect();
    let bytes = |path: &Path| {
        logs::mend(path);
        bounded::read_at_most(path, bounded::LONGEST_LOG)
    };
    let logs = Recordings::read(&paths, bytes).map_err(Failure::input)?;
    logs.notes.iter().for_each(|note| output::note(note));
    if let Some(folder) = &args.plots {
        check_plots(args, &logs, folder)?;
        place::try_folder(folder)?;
    }
    let bar = bar(args);
    let shown = |share: f64| bar.set_position((100.0 * share) as u64);
    let asked = interrupt::asked();
    let progress = FitProgress {
        report: &shown,
        stop: &asked,
    };
    let outcome = match args.check {
        _ if args.leave_one_out => logs.leave_one_out(&robot.plant, &progress),
        Some(_) => logs.check(&robot.plant),
        None => logs.identify(&robot.plant, &progress),
    }
    .map_err(|error| interrupted(error, bar.position(), driving.as_ref()))?;
    let found = outcome.identification();
    let doubts = match found {
        Some(found) => found.doubts(logs.check(&robot.plant).map_err(Failure::input)?.runs()),
        None => Vec::new(),
    };
    let is_believed = doubts.is_empty() || args.overwrite.force;
    let params = found.map_or(robot.plant, |found| found.params);
    let sonars = logs.compare_sonars(&params);
    let plots = match &args.plots {
        Some(folder) => plot(&logs, &outcome, &params, folder)?,
        None => Vec::new(),
    };
    bar.finish_and_clear();
    let into = match (&args.write, name.ends_with(".toml")) {
        (Some(path), _) => Some(path.as_path()),
        (None, true) => Some(Path::new(name)),
        (None, false) => None,
    };
    let written = match (found, into) {
        (Some(found), Some(path)) if is_believed => Some(write(path, &robot.text, found)?),
        _ => None,
    };
    let truth = driving.as_ref().and_then(|driving| driving.truth);
    let against_truth = match (found, truth) {
        (Some(found), Some(truth)) => found.against(&truth),
        _ => Vec::new(),
    };
    let report = Report {
        robot: name,
        drive: &outcome,
        sonars: &sonars,
        plots: plots.iter().map(|path| output::shown(path)).collect(),
        log: driving.as_ref().map(|driving| output::shown(&driving.path)),
        against_truth,
        doubts: &doubts,
        written: written.map(output::shown),
    };
    if args.json {
        output::json(&report)?;
        return refused(&doubts, is_believed);
    }
    print(&logs, &report, &plots)?;
    refused(&doubts, is_believed)?;
    match written {
        Some(path) => output::remark(&format!(
            "{}: its [plant] table is rewritten",
            path.display()
        )),
        None if args.check.is_none() => output::remark(
            "nothing is written: name a robot file with --write to have it in its [plant] table",
        ),
        None => Ok(()),
    }
}

/// Why a fit failed; of one that was interrupted, what is kept.
fn interrupted(error: IdentifyError, percent: u64, driving: Option<&Driving>) -> Failure {
    if !matches!(error, IdentifyError::Interrupted) {
        return Failure::input(error);
    }
    let log = driving.map(|driving| output::shown(&driving.path));
    let kept = log.map_or_else(String::new, |log| format!("; log of the drive: {log}"));
    output::note(&format!(
        "interrupted after {percent} % of the fit; nothing is written{kept}"
    ));
    Failure::Interrupted
}

/// The verdict on a fit with such doubts.
fn refused(doubts: &[String], is_believed: bool) -> Result<(), Failure> {
    if is_believed {
        doubts.iter().for_each(|doubt| output::note(doubt));
        return Ok(());
    }
    let doubts = doubts
        .iter()
        .map(|doubt| format!("the fit is refused: {doubt}"));
    let remedy = "nothing is written; --plots DIR shows each run beside its simulation, --force takes the fit all the same";
    Err(Failure::Inputs(doubts.chain([remedy.into()]).collect()))
}

/// Drives the robot, if one is to be driven.
fn drive(args: &IdentifyArgs, robot: &str) -> Result<Option<Driving>, Failure> {
    let Some(address) = &args.drive else {
        return Ok(None);
    };
    let folder = logs::recording(args.out.as_deref()).map(|recording| recording.folder);
    let drive = drive::Drive {
        folder: &folder.unwrap_or_else(|| PathBuf::from(".")),
        battery_v: args.battery,
    };
    match address.as_str() {
        drive::LAB => drive::in_lab(&drive, robot, args.seed.seed),
        address => drive::at_port(&drive, address, args.baud),
    }
    .map(Some)
}

/// What is being done, and how much of it is.
fn bar(args: &IdentifyArgs) -> ProgressBar {
    let doing = match (&args.check, args.leave_one_out) {
        (_, true) => "fitting without each run in turn",
        (Some(_), false) => "comparing with the plant",
        (None, false) => {
            "searching for the plant that repeats the runs; CSVs take two cores some three minutes"
        }
    };
    let style = ProgressStyle::with_template("{bar:20} {percent:>3} % {elapsed} {msg}");
    let bar = ProgressBar::new(100).with_message(doing);
    bar.enable_steady_tick(Duration::from_millis(100));
    match style {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}

/// Where the plot of a run goes.
fn place_of(folder: &Path, name: &str) -> PathBuf {
    folder.join(Path::new(name).with_extension("svg"))
}

fn stamp(name: &str) -> FileStamp {
    FileStamp::of("identify", &[name.to_owned()])
}

/// Refuses, before anything is fitted, plots that would be written over something else.
fn check_plots(args: &IdentifyArgs, logs: &Recordings, folder: &Path) -> Result<(), Failure> {
    let guard = Guard::new(&args.logs, args.overwrite.force);
    let mut results = Vec::new();
    for (number, log) in (1..).zip(&logs.drive) {
        let svg = place_of(folder, &log.name);
        guard.check(&svg, &Mark::of(&stamp(&log.name)))?;
        results.push((svg, format!("run {number}")));
    }
    place::distinct(&results)
}

fn plot(
    logs: &Recordings,
    outcome: &RecordingsOutcome,
    params: &Params,
    folder: &Path,
) -> Result<Vec<PathBuf>, Failure> {
    let mut plots = Vec::new();
    for run in outcome.runs() {
        for log in logs.drive.iter().filter(|log| log.name == run.name) {
            let plot = rumbo_identify::plot(log, params, run.nuisance);
            let picture = plot.picture(Words::default(), WIDTH);
            let svg = Sheet::new(1).with(&log.name, picture).svg();
            let path = place_of(folder, &log.name);
            place::write(&path, stamp(&log.name).put_on(svg))?;
            plots.push(path);
        }
    }
    Ok(plots)
}

/// Rewrites the `[plant]` table of a robot file, after checking that the result is a valid robot.
fn write<'a>(path: &'a Path, robot: &str, found: &Identification) -> Result<&'a Path, Failure> {
    let file = path.display().to_string();
    let wrong = |what: String| Failure::Input(format!("{file}: cannot be rewritten ({what})"));
    let text = match path.exists() {
        true => bounded::read_text(path).map_err(|error| wrong(error.to_string()))?,
        false => robot.to_owned(),
    };
    let today = rumbo_station::today_utc();
    let text =
        rumbo_identify::rewrite(&text, found, &today).map_err(|error| wrong(error.to_string()))?;
    RobotFile::parse("", &file, &text)?;
    place::write(path, text)?;
    Ok(path)
}

/// A simulated robot's parameters as a table.
fn beside_truth(parameters: &[AgainstTruth]) -> Vec<Vec<String>> {
    let head = ["", "found", "+- (95 %)", "truth", ""].map(String::from);
    let row = |parameter: &AgainstTruth| {
        let inside = (parameter.value - parameter.truth).abs() <= parameter.within;
        let figures = [parameter.value, parameter.within, parameter.truth].map(figure);
        let verdict = if inside { "inside" } else { "outside" };
        let name = std::iter::once(parameter.key.clone());
        name.chain(figures).chain([verdict.to_owned()]).collect()
    };
    std::iter::once(head.to_vec())
        .chain(parameters.iter().map(row))
        .collect()
}

/// Prints all but what was written.
fn print(logs: &Recordings, report: &Report<'_>, plots: &[PathBuf]) -> Result<(), Failure> {
    let text = match report.drive {
        RecordingsOutcome::Identified(found) => found.to_string(),
        RecordingsOutcome::Checked { runs } => runs.iter().map(ToString::to_string).collect(),
    };
    if !text.is_empty() {
        output::lines(text.trim())?;
    }
    for log in &logs.drive {
        if let Some(pair) = &log.pair {
            output::line(&format!("{}: {pair}", log.name))?;
        }
    }
    if !report.sonars.is_empty() {
        output::line("")?;
        output::lines(sonar_stats::table(report.sonars).trim_end())?;
    }
    for path in plots {
        output::line(&format!("plot: {}", path.display()))?;
    }
    if !report.against_truth.is_empty() {
        output::line("")?;
        output::table(&beside_truth(&report.against_truth))?;
    }
    match &report.log {
        Some(log) => output::remark(&format!("log of the drive: {log}")),
        None => Ok(()),
    }
}
