//! Runs of a scenario: headless, as fast as the machine can, many seeds on all cores.
//!
//! A run depends on its setup and seed alone, so its result is the same on one thread and on many.

use crate::calibrate::calibrate_simulated;
use crate::files::{FileError, Setup};
use crate::mega::Mega;
use crate::metrics::{self, Metrics};
use crate::operator::Operator;
use crate::sim::Sim;
use crate::trace::{SAMPLE_US, Trace};
use rayon::prelude::*;
use serde::Serialize;
use std::borrow::Cow;

/// What a run gave.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RunResult {
    /// Name of the scenario.
    pub scenario: String,
    /// The seed.
    pub seed: u64,
    /// No limit is missed, and the robot refused nothing and reported no fault.
    pub pass: bool,
    /// All metrics; units in the names.
    pub metrics: Metrics,
    /// Why it did not pass, a line each.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub failures: Vec<String>,
    /// What a reader should know besides, a line each.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<String>,
    /// What really happened.
    #[serde(skip)]
    pub trace: Trace,
}

/// Runs a scenario once.
///
/// # Errors
/// If the setup's values do not fit together, or the calibration that it asks for came to no end.
pub fn run(setup: &Setup, seed: u64) -> Result<RunResult, FileError> {
    let setup = &*setup.of_seed(seed)?;
    let setup = &*prepare(setup, seed)?;
    let scenario = &setup.scenario;
    let mut sim = Sim::new(setup, seed)?;
    let mut operator = Operator::new(setup);
    let mut trace = Trace::default();
    operator.brief(&mut sim)?;
    sim.tap_link();
    let end_us = (scenario.duration_s * 1e6) as u64;
    trace.samples.reserve((end_us / SAMPLE_US) as usize + 1);
    while sim.now_us() < end_us {
        operator.step(&mut sim);
        sim.advance((sim.now_us() + SAMPLE_US).min(end_us));
        trace.take(&sim);
        trace.listen(&mut sim);
        if sim.verdict().is_some() {
            break;
        }
    }
    trace.heard = operator.heard;
    trace.link = sim.take_tapped();
    let metrics = metrics::compute(setup, &sim, &trace);
    let mut failures = operator.complaints;
    failures.extend(sim.verdict());
    let mut notes = operator.notes;
    notes.extend(sim.mega().map(Mega::notes).into_iter().flatten());
    for (name, bounds) in &scenario.limits {
        match metrics.get(name) {
            Some(value) if bounds.admit(*value) => {}
            Some(value) => failures.push(format!("{name} = {value:.4}: limit {bounds}")),
            None => failures.push(format!(
                "{name}: this scenario has no such metric; it has {}",
                known(&metrics)
            )),
        }
    }
    Ok(RunResult {
        scenario: scenario.name.clone(),
        seed,
        pass: failures.is_empty(),
        metrics,
        failures,
        notes,
        trace,
    })
}

/// The setup as it is run: if its scenario asks for it, with the parameters that a calibration of this seed's robot gives. Those of the
/// scenario itself win over them; the report's program knows none.
///
/// # Errors
/// The calibration came to no end.
pub fn prepare(setup: &Setup, seed: u64) -> Result<Cow<'_, Setup>, FileError> {
    if !setup.scenario.calibrated || !setup.takes_parameters() {
        return Ok(Cow::Borrowed(setup));
    }
    // Whatever rig the experiment has: sonars are moved back after a calibration, wheels stay.
    let mut own = setup.clone();
    // An image that speaks our frames has our control core: the native one gives the same parameters sooner.
    own.firmware = None;
    if let Some(rig) = own.robot.rigs.get("final") {
        own.rig = *rig;
        "final".clone_into(&mut own.scenario.rig);
    }
    let (found, _) = calibrate_simulated(&own, seed, false)?;
    let found = found.map_err(|error| {
        let name = &setup.scenario.name;
        FileError::Setting(format!(
            "scenario {name}, calibration of seed {seed}: {error}"
        ))
    })?;
    let mut setup = setup.clone();
    let mut parameters = found.parameters();
    parameters.append(&mut setup.scenario.parameters);
    setup.scenario.parameters = parameters;
    Ok(Cow::Owned(setup))
}

fn known(metrics: &Metrics) -> String {
    metrics
        .keys()
        .map(String::as_str)
        .collect::<Vec<_>>()
        .join(", ")
}

/// Runs started together: enough for every thread to be busy, few enough that their traces fit in memory.
const BATCH: usize = 64;

/// Runs all `jobs`, each a setup and a seed, on all threads of the current pool, and hands the results to `handle`
/// in the order of the jobs.
///
/// # Errors
/// The first error, of a setup or of `handle`; no further batch is begun.
pub fn run_all<E: From<FileError>>(
    jobs: &[(&Setup, u64)],
    mut handle: impl FnMut(&Setup, RunResult) -> Result<(), E>,
) -> Result<(), E> {
    for batch in jobs.chunks(BATCH) {
        let results: Vec<_> = batch
            .par_iter()
            .map(|(setup, seed)| run(setup, *seed))
            .collect();
        for ((setup, _), result) in batch.iter().zip(results) {
            handle(setup, result?)?;
        }
    }
    Ok(())
}
