//! A calibration of a simulated robot as a run: trace and result, to be stored beside other runs and reproduced.

use crate::calibrate::simulated::{self, PLAN};
use crate::calibrate::{CalibrateError, Calibration, Linked, calibrate};
use crate::files::{FileError, Library, Overrides, Setup};
use crate::metrics::Metrics;
use crate::run::{self, RunResult};
use rumbo_sim::Sim;
use rumbo_sim::trace::{SAMPLE_US, Trace};

/// A finished calibration.
pub struct CalibrationRun {
    /// Its result, or why it failed.
    pub found: Result<Calibration, CalibrateError>,
    /// The simulation at its end.
    pub sim: Sim,
    /// The run: distance, time, contacts, each parameter found, and the trace. It passes if the calibration succeeded.
    pub result: RunResult,
}

/// The setup of a calibration: the built-in scenario of that name, by default in the world made for it.
///
/// # Errors
/// A mistake in the files.
pub fn calibration_setup(overrides: &Overrides) -> Result<Setup, FileError> {
    Library::new().setup(PLAN, overrides)
}

/// Calibrates the robot that `seed` draws in a setup of [`calibration_setup`], and records it. Floor, slip and noise
/// differ from those of a run of this seed, but are the same each time.
///
/// # Errors
/// The setup's values do not fit together.
pub fn run_calibration(setup: &Setup, seed: u64) -> Result<CalibrationRun, FileError> {
    let setup = &*setup.of_seed(seed)?;
    let mut sim = simulated::robot(setup, seed)?;
    sim.tap_link();
    let mut trace = Trace {
        parameters: run::parameters(setup)?,
        ..Trace::default()
    };
    let found = calibrate(&mut Watched {
        sim: &mut sim,
        trace: &mut trace,
    });
    if !sim.now_us().is_multiple_of(SAMPLE_US) {
        // What crossed the link since the last sample belongs to the run, too.
        trace.sample(&sim);
    }
    trace.link = sim.take_tapped();
    let result = RunResult {
        scenario: setup.scenario.name.clone(),
        seed,
        pass: found.is_ok(),
        metrics: metrics(&found, &sim),
        failures: found
            .as_ref()
            .err()
            .map(|error| error.to_string().into())
            .into_iter()
            .collect(),
        trace,
        ..RunResult::default()
    };
    Ok(CalibrationRun { found, sim, result })
}

fn metrics(found: &Result<Calibration, CalibrateError>, sim: &Sim) -> Metrics {
    let duration_s = sim.now_us() as f64 * 1e-6;
    let mut metrics = Metrics::from([
        ("contacts".to_owned(), f64::from(sim.truth().contacts)),
        ("duration_s".to_owned(), duration_s),
    ]);
    if let Ok(found) = found {
        metrics.insert("duration_s".into(), found.duration_s);
        metrics.insert("way_m".into(), found.way_m);
        let parameters = found.parameters().into_iter();
        metrics.extend(parameters.map(|(id, value)| (id.name().to_owned(), f64::from(value))));
    }
    metrics
}

/// A simulated robot behind its link, with its ground truth recorded.
struct Watched<'a> {
    sim: &'a mut Sim,
    trace: &'a mut Trace,
}

impl Linked for Watched<'_> {
    fn now_us(&self) -> u64 {
        self.sim.now_us()
    }

    fn send(&mut self, bytes: &[u8]) {
        self.sim.send(bytes);
    }

    fn receive(&mut self, into: &mut Vec<u8>) {
        self.sim.receive(into);
    }

    fn advance(&mut self, us: u64) {
        loop {
            let sample_us = (self.sim.now_us() / SAMPLE_US + 1) * SAMPLE_US;
            self.sim.advance(us.min(sample_us));
            if self.sim.now_us() >= sample_us {
                self.trace.sample(self.sim);
            }
            if self.sim.now_us() >= us {
                return;
            }
        }
    }
}
