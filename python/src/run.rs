//! Runs from start to end, and their traces as columns.

use crate::guard::{call, detached, exception, threads};
use crate::setup::Setup;
use numpy::IntoPyArray;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rumbo_experiment::files::FileError;
use rumbo_experiment::note::Note;
use rumbo_experiment::run::{RunResult, run_all_on};
use rumbo_sim::trace::{Trace, TruthSample};

/// Why the runs ended early.
pub(crate) enum Stop {
    File(FileError),
    Python(PyErr),
}

impl Stop {
    pub(crate) fn into_exception(self) -> PyErr {
        match self {
            Self::File(error) => exception(&error),
            Self::Python(error) => error,
        }
    }
}

impl From<FileError> for Stop {
    fn from(error: FileError) -> Self {
        Self::File(error)
    }
}

/// Runs the scenario with each seed; a dictionary for each run, in the order of the seeds. `progress` is called with
/// the number of finished runs.
#[pyfunction]
#[pyo3(signature = (setup, seeds, *, threads, trace, progress))]
pub(crate) fn run<'py>(
    py: Python<'py>,
    setup: &Setup,
    seeds: Vec<u64>,
    threads: Option<i64>,
    trace: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<Vec<Bound<'py, PyDict>>> {
    let threads = self::threads(threads)?;
    let jobs: Vec<_> = seeds.iter().map(|seed| (&setup.files, *seed)).collect();
    let mut results: Vec<RunResult> = Vec::with_capacity(jobs.len());
    let ended = detached(py, || {
        let go_on = || Python::attach(|py| py.check_signals()).map_err(Stop::Python);
        run_all_on(threads.min(jobs.len()), &jobs, go_on, |_, mut result| {
            if !trace {
                result.trace = Default::default();
                for robot in &mut result.robots {
                    robot.trace = Default::default();
                }
            }
            results.push(result);
            call(progress.as_ref(), results.len()).map_err(Stop::Python)
        })
    })?;
    ended.map_err(Stop::into_exception)?;
    results
        .into_iter()
        .map(|result| in_python(py, result, trace))
        .collect()
}

fn in_python(py: Python<'_>, result: RunResult, trace: bool) -> PyResult<Bound<'_, PyDict>> {
    let run = PyDict::new(py);
    run.set_item("scenario", &result.scenario)?;
    run.set_item("seed", result.seed)?;
    run.set_item("passed", result.pass)?;
    let metrics = PyDict::new(py);
    for (name, value) in &result.metrics {
        metrics.set_item(name, value)?;
    }
    run.set_item("metrics", metrics)?;
    let lines = |notes: &[Note]| notes.iter().map(Note::to_string).collect::<Vec<_>>();
    run.set_item("failures", lines(&result.failures))?;
    run.set_item("notes", lines(&result.notes))?;
    if trace && result.robots.is_empty() {
        run.set_item("trace", columns(py, &result.trace)?)?;
    }
    let robots = result.robots.into_iter();
    let robots = robots.map(|robot| in_python(py, robot, trace));
    run.set_item("robots", robots.collect::<PyResult<Vec<_>>>()?)?;
    Ok(run)
}

/// A signal's name and its value in a sample.
type Column = (&'static str, fn(&Trace, &TruthSample) -> f64);

/// The samples as one array for each signal.
fn columns<'py>(py: Python<'py>, trace: &Trace) -> PyResult<Bound<'py, PyDict>> {
    let samples = &trace.samples;
    let found = PyDict::new(py);
    let numbers: [Column; 11] = [
        ("t_s", |_, sample| sample.t_s),
        ("x_m", |_, sample| sample.x_m),
        ("y_m", |_, sample| sample.y_m),
        ("heading_rad", |_, sample| sample.heading_rad),
        ("left_rad_s", |_, sample| sample.wheel_rad_s[0]),
        ("right_rad_s", |_, sample| sample.wheel_rad_s[1]),
        ("range_left_m", |trace, sample| trace.range_m(sample, 0)),
        ("range_right_m", |trace, sample| trace.range_m(sample, 1)),
        ("range_front_m", |trace, sample| trace.range_m(sample, 2)),
        ("servo_rad", |_, sample| sample.servo_rad),
        ("battery_v", |_, sample| sample.battery_v),
    ];
    for (name, value) in numbers {
        let column: Vec<f64> = samples.iter().map(|sample| value(trace, sample)).collect();
        found.set_item(name, column.into_pyarray(py))?;
    }
    for (name, side) in [("left_duty", 0), ("right_duty", 1)] {
        let column: Vec<i16> = samples.iter().map(|sample| sample.duty[side]).collect();
        found.set_item(name, column.into_pyarray(py))?;
    }
    let touching: Vec<bool> = samples.iter().map(|sample| sample.touching).collect();
    found.set_item("touching", touching.into_pyarray(py))?;
    Ok(found)
}
