//! Identification: the plant's parameters from recorded runs.

use crate::guard::{exception, pool, threads, watched};
use crate::setup::library;
use crate::study::refuse;
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use rumbo_experiment::files::{RobotFile, bounded};
use rumbo_identify::sonar_stats::Comparison;
use rumbo_identify::{FitProgress, IdentifyError, Recordings, RecordingsOutcome, rewrite};
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::sync::mpsc::Sender;

/// What comes of it, as JSON.
#[derive(Serialize)]
struct Found {
    #[serde(flatten)]
    outcome: RecordingsOutcome,
    sonars: Vec<Comparison>,
    notes: Vec<String>,
    /// The robot file with what was found, and its content.
    toml: String,
    robot: toml::Table,
}

/// Fits the plant of a robot to the runs of these files, or repeats them on it as it is: JSON. `held` is as for a setup,
/// `date` stands in the robot file. `progress` is called with the share that is done.
#[pyfunction]
#[pyo3(signature = (paths, robot, *, held, fit, date, threads, progress))]
#[allow(clippy::too_many_arguments, reason = "keywords of one Python call")]
pub(crate) fn identify(
    py: Python<'_>,
    paths: Vec<PathBuf>,
    robot: &str,
    held: Vec<(String, String, String)>,
    fit: bool,
    date: &str,
    threads: Option<i64>,
    progress: Option<Py<PyAny>>,
) -> PyResult<String> {
    let pool = pool(self::threads(threads)?)?;
    let robot = library(held)?
        .robot(robot)
        .map_err(|error| exception(&error))?;
    let work = |shares: &Sender<f64>, stop: &AtomicBool| {
        let bytes = |path: &Path| bounded::read_at_most(path, bounded::LONGEST_LOG);
        let recordings = Recordings::read(&paths, bytes)?;
        let report = |share| {
            // Nobody listens any more: `stop` is set.
            let _ = shares.send(share);
        };
        let progress = FitProgress {
            report: &report,
            stop,
        };
        let outcome = match fit {
            true => recordings.identify(&robot.plant, &progress)?,
            false => recordings.check(&robot.plant)?,
        };
        let found = outcome.identification();
        let sonars = recordings.compare_sonars(found.map_or(&robot.plant, |found| &found.params));
        Ok((outcome, sonars, recordings.notes))
    };
    let done = watched(py, &pool, progress.as_ref(), work)?;
    let (outcome, sonars, notes) = done.map_err(|error| match error {
        IdentifyError::Interrupted => PyKeyboardInterrupt::new_err(()),
        error => refuse(error),
    })?;
    let toml = match outcome.identification() {
        Some(found) => rewrite(&robot.text, found, date).map_err(refuse)?,
        None => robot.text,
    };
    RobotFile::parse("", &robot.name, &toml).map_err(|error| exception(&error))?;
    let found = Found {
        outcome,
        sonars,
        notes,
        robot: toml::from_str(&toml).map_err(refuse)?,
        toml,
    };
    serde_json::to_string(&found).map_err(refuse)
}
