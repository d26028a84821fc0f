//! Sweeps, and the differences of variants pair by pair.

use crate::guard::{detached, exception, threads};
use crate::run::{Stop, call};
use crate::setup::Setup;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rumbo_experiment::compare::{Variant, differences as of_variants};
use rumbo_experiment::metrics::Metrics;
use rumbo_experiment::sweep::{Axis, Design, Plan, Row};
use std::fmt::Display;

fn refuse(error: impl Display) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// Runs a scenario at every point of `axes`, written `NAME=VALUES`; returns the points, each a value for every axis, and
/// the runs in order: number of the point, seed, whether it passed, metrics. `count` points are drawn unless it is a grid.
#[pyfunction]
#[pyo3(signature = (setup, axes, *, design, count, seed, runs, threads, progress))]
#[allow(clippy::too_many_arguments, reason = "keywords of one Python call")]
#[allow(clippy::type_complexity, reason = "taken apart by the caller at once")]
pub(crate) fn sweep(
    py: Python<'_>,
    setup: &Setup,
    axes: Vec<String>,
    design: &str,
    count: usize,
    seed: u64,
    runs: u32,
    threads: Option<i64>,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Vec<Vec<f64>>, Vec<(usize, u64, bool, Metrics)>)> {
    let threads = self::threads(threads)?;
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
    let plan = Plan::new(axes, design, seed, runs).map_err(refuse)?;
    plan.check(&setup.files)
        .map_err(|error| exception(&error))?;
    let mut rows: Vec<Row> = Vec::with_capacity(plan.len());
    let ended = detached(py, || {
        plan.run(&setup.files, 0, threads, |row| {
            rows.push(row);
            call(progress.as_ref(), rows.len())
        })
    })?;
    ended.map_err(Stop::into_exception)?;
    let rows = rows
        .into_iter()
        .map(|row| (row.point, row.seed, row.pass, row.metrics));
    Ok((plan.points, rows.collect()))
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
