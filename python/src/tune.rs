//! Tuning: the search of `rumbo tune`, and its check on robots that the search has not seen.

use crate::guard::{exception, pool, threads, watched};
use crate::setup::Setup;
use crate::study::refuse;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rumbo_experiment::tune::{Objective, Over, Search, TuningPlan, TuningRequest};
use std::sync::atomic::Ordering;

/// Searches, and drives the robots that the search has not seen with the present values and the found ones: a
/// dictionary. `progress` is called with the share of all runs that is done.
#[pyfunction]
#[pyo3(signature = (setup, over, *, aims, runs, held_out, threads, progress))]
#[allow(clippy::too_many_arguments, reason = "keywords of one Python call")]
pub(crate) fn tune<'py>(
    py: Python<'py>,
    setup: &Setup,
    over: Vec<String>,
    aims: Option<&str>,
    runs: Option<u32>,
    held_out: Vec<u64>,
    threads: Option<i64>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let pool = pool(self::threads(threads)?)?;
    let over: Vec<Over> = over
        .iter()
        .map(|one| one.parse())
        .collect::<Result<_, _>>()
        .map_err(|error| exception(&error))?;
    let objective: Objective = match aims {
        Some(aims) => aims.parse().map_err(refuse)?,
        None => Objective::default(),
    };
    // So a search from seed 1 is checked as that of the command is.
    let first = held_out.first().copied().unwrap_or_default();
    let request = TuningRequest {
        over,
        objective,
        seed: first.wrapping_sub(Search::SEEDS),
        runs,
        held_out,
    };
    let plan = TuningPlan::new(setup.files.clone(), &setup.own, request);
    let plan = plan.map_err(|error| exception(&error))?;
    let done = watched(py, &pool, progress.as_ref(), |shares, stop| {
        let tell = |share| {
            // An error: nobody listens any more, and `stop` is set.
            let _ = shares.send(share);
        };
        plan.run(&tell, &|| !stop.load(Ordering::Relaxed))
    })?;
    let outcome = done.map_err(|error| exception(&error))?;
    let values = plan.over().iter().zip(&outcome.found.values);
    let values = values.map(|(one, value)| (one.id.name(), one.start, *value));
    let parts = PyDict::new(py);
    parts.set_item("values", values.collect::<Vec<_>>())?;
    parts.set_item("runs", outcome.found.runs)?;
    parts.set_item("passed", outcome.passes)?;
    parts.set_item("seeds", plan.seeds())?;
    let metrics = outcome.runs.map(|one| one.metrics);
    parts.set_item("metrics", metrics.to_vec())?;
    Ok(parts)
}
