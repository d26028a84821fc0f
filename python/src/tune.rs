//! Tuning: the search of `rumbo tune`, and its check on robots that the search has not seen.

use crate::guard::{exception, pool, threads, watched};
use crate::setup::Setup;
use crate::study::refuse;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rumbo_experiment::compare::{Variant, run_variants};
use rumbo_experiment::files::{FileError, Setup as Files};
use rumbo_experiment::run::check_metrics;
use rumbo_experiment::tune::{Found, Objective, Over, Search, Tuned, tuned};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::Sender;

/// What is done, apart from how.
struct Task<'a> {
    setup: &'a Files,
    over: &'a [Tuned],
    objective: &'a Objective,
    seed: u64,
    budget: usize,
    held_out: u32,
}

/// Searches, and drives the robots that the search has not seen with the present values and the found ones: a
/// dictionary. `progress` is called with the share of the budget that is used.
#[pyfunction]
#[pyo3(signature = (setup, over, *, aims, seed, runs, held_out, threads, progress))]
#[allow(clippy::too_many_arguments, reason = "keywords of one Python call")]
pub(crate) fn tune<'py>(
    py: Python<'py>,
    setup: &Setup,
    over: Vec<String>,
    aims: Option<&str>,
    seed: u64,
    runs: Option<u32>,
    held_out: u32,
    threads: Option<i64>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let pool = pool(self::threads(threads)?)?;
    let over: Vec<Over> = over
        .iter()
        .map(|one| one.parse())
        .collect::<Result<_, _>>()
        .map_err(|error| exception(&error))?;
    over.iter()
        .try_for_each(|one| one.check(&setup.own))
        .map_err(|error| exception(&error))?;
    let objective: Objective = match aims {
        Some(aims) => aims.parse().map_err(refuse)?,
        None => Objective::default(),
    };
    let setup = &setup.files;
    let over = tuned(setup, &over).map_err(|error| exception(&error))?;
    let task = Task {
        setup,
        over: &over,
        objective: &objective,
        seed,
        budget: runs.map_or_else(|| Search::default_budget(setup), |runs| runs as usize),
        held_out,
    };
    let done = watched(py, &pool, progress.as_ref(), |shares, stop| {
        task.run(shares, stop)
    })?;
    let (found, variants) = done.map_err(|error| exception(&error))?;
    let passed = |variant: &Variant| {
        let runs = variant.passes.iter().zip(&variant.metrics);
        let passed = runs.filter(|(pass, run)| **pass && objective.admits(run));
        passed.count()
    };
    let values = over.iter().zip(&found.values);
    let values = values.map(|(one, value)| (one.id.name(), one.start, *value));
    let parts = PyDict::new(py);
    parts.set_item("values", values.collect::<Vec<_>>())?;
    parts.set_item("runs", found.runs)?;
    parts.set_item("passed", variants.iter().map(passed).collect::<Vec<_>>())?;
    parts.set_item("seeds", task.seeds())?;
    let metrics: Vec<_> = variants.into_iter().map(|one| one.metrics).collect();
    parts.set_item("metrics", metrics)?;
    Ok(parts)
}

impl Task<'_> {
    /// Robots that the search does not see.
    fn seeds(&self) -> Vec<u64> {
        let first = self.seed.wrapping_add(Search::SEEDS);
        let seeds = 0..u64::from(self.held_out);
        seeds.map(|index| first.wrapping_add(index)).collect()
    }

    /// Until `stop` is set; then what it returns is of no use.
    fn run(
        &self,
        shares: &Sender<f64>,
        stop: &AtomicBool,
    ) -> Result<(Found, Vec<Variant>), FileError> {
        let goes_on = || !stop.load(Ordering::Relaxed);
        check_metrics(self.objective.names(), self.setup, self.seed)?;
        let search = Search {
            setup: self.setup,
            over: self.over,
            objective: self.objective,
            seed: self.seed,
            budget: self.budget,
        };
        let found = search.run(|share| {
            // Nobody listens any more: `stop` is set.
            let _ = shares.send(share);
            goes_on()
        })?;
        let variants = [
            ("now".to_owned(), self.setup.clone()),
            ("tuned".to_owned(), search.setup_of(&found.values)?),
        ];
        let seeds = self.seeds();
        let variants = run_variants(&variants, &seeds, || match goes_on() {
            true => Ok(()),
            false => Err(FileError::Setting("interrupted".to_owned())),
        })?;
        Ok((found, variants))
    }
}
