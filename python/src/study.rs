//! Sweeps, and the differences of variants pair by pair.

use crate::guard::{call, detached, threads};
use crate::run::Stop;
use crate::setup::Setup;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rumbo_experiment::compare::{Variant, differences as of_variants};
use rumbo_experiment::metrics::Metrics;
use rumbo_experiment::run::{in_order, run_unless};
use rumbo_experiment::sweep::{Axis, Design, SweepPlan};
use std::fmt::Display;
use std::sync::atomic::AtomicBool;

/// Points that are checked between two looks for Ctrl-C: some 10 ms.
const LOOK_POINTS: usize = 100;

pub(crate) fn refuse(error: impl Display) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// The points of a sweep over `axes`, written `NAME=VALUES`: a value for every axis, checked. `count` points are drawn
/// unless it is a grid.
#[pyfunction]
#[pyo3(signature = (setup, axes, *, design, count, seed, runs))]
#[allow(clippy::too_many_arguments, reason = "keywords of one Python call")]
pub(crate) fn plan(
    py: Python<'_>,
    setup: &Setup,
    axes: Vec<String>,
    design: &str,
    count: usize,
    seed: u64,
    runs: u32,
) -> PyResult<Vec<Vec<f64>>> {
    let axes = axes.iter().map(|axis| axis.parse::<Axis>());
    let axes: Vec<Axis> = axes.collect::<Result<_, _>>().map_err(refuse)?;
    let design = match design {
        "grid" => Design::Grid,
        "random" => Design::Random(count),
        "sobol" => Design::Sobol(count),
        other => {
            return Err(refuse(format!(
                "design = {other:?}: must be \"grid\", \"random\" or \"sobol\""
            )));
        }
    };
    let plan = SweepPlan::new(axes, design, seed, runs).map_err(refuse)?;
    let checked = detached(py, || {
        for point in 0..plan.points.len() {
            plan.setup(&setup.files, point)?;
            if point.is_multiple_of(LOOK_POINTS) {
                call(None, 0.0).map_err(Stop::Python)?;
            }
        }
        Ok(())
    })?;
    checked.map_err(Stop::into_exception)?;
    Ok(plan.points)
}

/// Runs the scenario once for each job, which has a value for every parameter in `names`, and a seed. `handle` is called
/// with whether the run passed and its metrics, in the order of the jobs.
#[pyfunction]
#[pyo3(signature = (setup, names, jobs, *, threads, handle))]
pub(crate) fn run_jobs(
    py: Python<'_>,
    setup: &Setup,
    names: Vec<String>,
    jobs: Vec<(Vec<f64>, u64)>,
    threads: Option<i64>,
    handle: Py<PyAny>,
) -> PyResult<()> {
    let threads = self::threads(threads)?;
    let work = |index: usize, over: &AtomicBool| {
        let (values, seed) = &jobs[index];
        let names = names.iter().map(String::as_str);
        let values: Vec<_> = names.zip(values.iter().copied()).collect();
        run_unless(&setup.files.with_parameters(&values)?, *seed, over)
    };
    let ended = detached(py, || {
        let go_on = || Python::attach(|py| py.check_signals()).map_err(Stop::Python);
        in_order(threads, jobs.len(), work, go_on, |_, result| {
            // Given up: nobody waits for it any more.
            let Some(result) = result? else {
                return Ok(());
            };
            Python::attach(|py| {
                py.check_signals()?;
                handle.call1(py, (result.pass, result.metrics))
            })
            .map(drop)
            .map_err(Stop::Python)
        })
    })?;
    ended.map_err(Stop::into_exception)
}

/// The differences of two variants over the same seeds: for each metric that both have, a dictionary.
#[pyfunction]
pub(crate) fn differences<'py>(
    py: Python<'py>,
    first: Vec<Metrics>,
    second: Vec<Metrics>,
) -> PyResult<Vec<Bound<'py, PyDict>>> {
    let variant = |metrics: Vec<Metrics>| Variant {
        name: String::new(),
        passes: vec![true; metrics.len()],
        metrics,
    };
    let all = of_variants(&variant(first), &variant(second));
    all.into_iter()
        .map(|one| {
            let found = PyDict::new(py);
            found.set_item("metric", one.metric)?;
            found.set_item("pairs", one.pairs)?;
            found.set_item("never", (one.never[0], one.never[1]))?;
            found.set_item("medians", (one.medians[0], one.medians[1]))?;
            found.set_item("mean", one.mean)?;
            found.set_item("interval", (one.interval[0], one.interval[1]))?;
            found.set_item("effect", one.effect)?;
            found.set_item("better", one.better)?;
            found.set_item("worse", one.worse)?;
            Ok(found)
        })
        .collect()
}
