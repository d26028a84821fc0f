//! Runs of a scenario: headless, as fast as the machine can, many seeds on all cores.
//!
//! A run depends on its setup and seed alone, so its result is the same on one thread and on many.

#[cfg(feature = "host")]
mod batch;

#[cfg(feature = "host")]
pub use batch::{in_order, run_all, run_all_on};

use crate::calibrate::calibrate_simulated;
use crate::files::{Calibrated, FileError, Setup, near, unknown};
use crate::metrics::{self, Metrics};
use crate::operator::Operator;
use rumbo_control::params::{ParamId, Params};
use rumbo_emulator::observe::waveform::Waveform;
use rumbo_sim::Sim;
use rumbo_sim::mega::Mega;
use rumbo_sim::trace::{SAMPLE_US, Trace};
use serde::Serialize;
use std::borrow::Cow;
use std::fs::File;
use std::io::{self, BufWriter};

/// The file of a run's waveforms.
pub(crate) type Waves = Waveform<BufWriter<File>>;

/// The result of a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct RunResult {
    /// Name of the scenario.
    pub scenario: String,
    /// The seed.
    pub seed: u64,
    /// Path of the scenario, if it is not built in.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub path: Option<String>,
    /// No limit is missed, and the robot refused nothing and reported no fault.
    pub pass: bool,
    /// All metrics; units in the names.
    pub metrics: Metrics,
    /// Why it did not pass, a line each.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub failures: Vec<String>,
    /// Notes for the reader, a line each.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<String>,
    /// How the program ended, if it could not go on.
    #[serde(skip)]
    pub ended: Option<String>,
    /// Ground truth.
    #[serde(skip)]
    pub trace: Trace,
}

/// A run in progress.
pub struct Run<'a> {
    setup: &'a Setup,
    seed: u64,
    sim: Sim,
    operator: Operator<&'a Setup>,
    trace: Trace,
    end_us: u64,
    /// End of the current sample [us].
    sample_us: u64,
    /// Destination of the pins' waveforms, if they are recorded.
    waves: Option<Waves>,
    undrawn: io::Result<()>,
}

impl<'a> Run<'a> {
    pub(crate) fn new(setup: &'a Setup, seed: u64) -> Result<Self, FileError> {
        let mut sim = setup.sim(seed)?;
        let mut operator = Operator::new(setup);
        operator.brief(&mut sim)?;
        sim.tap_link();
        let end_us = (setup.scenario.duration_s * 1e6) as u64;
        let mut trace = Trace {
            parameters: parameters(setup)?,
            ..Trace::default()
        };
        trace.samples.reserve((end_us / SAMPLE_US) as usize + 1);
        Ok(Self {
            setup,
            seed,
            sample_us: sim.now_us(),
            sim,
            operator,
            trace,
            end_us,
            waves: None,
            undrawn: Ok(()),
        })
    }

    /// Robot and program.
    pub fn sim(&mut self) -> &mut Sim {
        &mut self.sim
    }

    pub(crate) fn mega(&self) -> Option<&Mega> {
        self.sim.mega()
    }

    /// The messages received from the robot so far.
    #[cfg(feature = "host")]
    pub(crate) fn received(&self) -> &[rumbo_sim::trace::TimedMessage] {
        &self.operator.received
    }

    /// Ground truth so far.
    #[cfg(feature = "host")]
    pub(crate) fn trace(&self) -> &Trace {
        &self.trace
    }

    /// The time is over, or the program has ended.
    pub fn is_over(&self) -> bool {
        self.sim.now_us() >= self.end_us || self.sim.verdict().is_some()
    }

    /// Advances to the end of a sample, or to where a debugger halts the program.
    pub fn advance(&mut self) {
        if self.sim.now_us() >= self.sample_us {
            self.operator.step(&mut self.sim);
            self.sample_us = (self.sim.now_us() + SAMPLE_US).min(self.end_us);
        }
        self.sim.advance(self.sample_us);
        self.draw_levels();
        if self.sim.now_us() >= self.sample_us || self.sim.verdict().is_some() {
            self.trace.sample(&self.sim);
            self.trace.listen(&mut self.sim);
        }
    }

    /// Records the pins' waveforms from now on.
    pub(crate) fn draw(&mut self, waves: Waves) {
        self.waves = Some(waves);
    }

    fn draw_levels(&mut self) {
        if let (Some(waves), Some(mega)) = (&mut self.waves, self.sim.mega_mut()) {
            for level in mega.chip_mut().take_levels() {
                if self.undrawn.is_ok() {
                    self.undrawn = waves.put(level);
                }
            }
        }
    }

    /// Ends the recording of waveforms.
    ///
    /// # Errors
    /// It could not be written.
    pub(crate) fn finish_drawing(&mut self) -> io::Result<()> {
        self.draw_levels();
        std::mem::replace(&mut self.undrawn, Ok(()))?;
        match (self.waves.take(), self.sim.mega()) {
            (Some(waves), Some(mega)) => waves.finish(mega.chip().cycle()),
            _ => Ok(()),
        }
    }

    fn judge(mut self) -> RunResult {
        let (setup, scenario) = (self.setup, &self.setup.scenario);
        self.trace.messages = self.operator.received;
        self.trace.link = self.sim.take_tapped();
        let metrics = metrics::compute(setup, &self.sim, &self.trace);
        let mut failures = self.operator.complaints;
        let verdict = self.sim.verdict();
        let ended = verdict.is_some();
        failures.extend(verdict.clone());
        let mut notes = self.operator.notes;
        notes.extend(self.sim.mega().map(Mega::notes).into_iter().flatten());
        // What its program could no longer do is not judged: the verdict suffices.
        let limits = scenario.limits.iter().filter(|_| !ended);
        for (name, bounds) in limits {
            match metrics.get(name) {
                Some(value) if bounds.admit(*value) => {}
                Some(value) if value.is_finite() => {
                    failures.push(format!("{name} = {value:.4}: limit {bounds}"));
                }
                // The measured event did not happen.
                Some(_) => failures.push(format!("{name} = never: limit {bounds}")),
                None if !self.trace.drove() => failures.push(format!(
                    "{name} = never: limit {bounds}; the robot was not armed, or its program drove no wheel"
                )),
                None => failures.push(format!(
                    "{name}: this scenario has no such metric; {}",
                    instead(name, &metrics)
                )),
            }
        }
        RunResult {
            scenario: scenario.name.clone(),
            seed: self.seed,
            path: scenario.path.clone(),
            pass: failures.is_empty(),
            metrics,
            failures,
            notes,
            ended: verdict,
            trace: self.trace,
        }
    }
}

/// The parameters of a robot before the first command, if it has a table of them.
pub(crate) fn parameters(setup: &Setup) -> Result<Option<Params>, FileError> {
    if !setup.takes_parameters() {
        return Ok(None);
    }
    let mut parameters = Params::default();
    for (id, value) in setup.control_parameters()? {
        // Checked when it was read.
        let _ = parameters.set(id, value);
    }
    Ok(Some(parameters))
}

/// Runs a scenario once.
///
/// # Errors
/// If the setup's values do not fit together, or its calibration failed.
pub fn run(setup: &Setup, seed: u64) -> Result<RunResult, FileError> {
    run_by(setup, seed, |run| {
        while !run.is_over() {
            run.advance();
        }
        Ok(())
    })
}

/// Runs a scenario once, driven by the caller; the run is judged when the caller returns.
///
/// # Errors
/// As [`run`], or the caller's.
pub fn run_by<E: From<FileError>>(
    setup: &Setup,
    seed: u64,
    go_on: impl FnOnce(&mut Run<'_>) -> Result<(), E>,
) -> Result<RunResult, E> {
    let setup = &*setup.of_seed(seed)?;
    let setup = &*prepare(setup, seed)?;
    let mut run = Run::new(setup, seed)?;
    go_on(&mut run)?;
    Ok(run.judge())
}

/// The setup to run: if its scenario requests it, with the parameters from a calibration of this seed's robot. The
/// scenario's own parameters win over them; the report's program has none.
///
/// # Errors
/// The calibration failed.
pub fn prepare(setup: &Setup, seed: u64) -> Result<Cow<'_, Setup>, FileError> {
    if !setup.scenario.calibrated || !setup.takes_parameters() {
        return Ok(Cow::Borrowed(setup));
    }
    let mut parameters = calibration(setup, seed)?;
    let mut setup = setup.clone();
    parameters.append(&mut setup.scenario.parameters);
    setup.scenario.parameters = parameters;
    Ok(Cow::Owned(setup))
}

/// The parameters that the calibration of a seed's robot finds. Parameters of the scenario are of its run, not of the
/// calibration before it.
fn calibration(setup: &Setup, seed: u64) -> Result<Vec<(ParamId, f32)>, FileError> {
    let mut own = setup.clone();
    own.scenario.parameters.clear();
    // An image with our frames has our control core: the native one finds the same parameters sooner.
    own.firmware = None;
    // For any rig of the experiment: sonars are moved back after a calibration, wheels stay.
    if let Some(rig) = own.robot.rigs.get("final") {
        own.rig = *rig;
        "final".clone_into(&mut own.scenario.rig);
    }
    let (robot, before) = (own.drawn_params(seed)?, own.control_parameters()?);
    if let Some(found) = setup.calibrations.found(seed, &robot, &before) {
        return Ok(found);
    }
    let (found, _) = calibrate_simulated(&own, seed, false)?;
    let found = found.map_err(|error| {
        let name = &setup.scenario.name;
        FileError::Setting(format!(
            "scenario {name}, calibration of seed {seed}: {error}"
        ))
    })?;
    let found = found.parameters();
    let calibrated = Calibrated {
        robot,
        before,
        found: found.clone(),
    };
    setup.calibrations.keep(seed, calibrated);
    Ok(found)
}

/// Refuses metrics that the runs of a scenario do not have, bare or with their step, after one run.
///
/// # Errors
/// A metric with the near ones, or that of the run.
pub fn check_metrics<'a>(
    mut names: impl Iterator<Item = &'a str>,
    setup: &Setup,
    seed: u64,
) -> Result<(), FileError> {
    let run = run(setup, seed)?;
    let known: Vec<&str> = run.metrics.keys().map(String::as_str).collect();
    let bare = known.iter().map(|name| metrics::bare(name));
    let all: Vec<&str> = known.iter().copied().chain(bare).collect();
    match names.find(|name| !all.contains(name)) {
        Some(name) => Err(unknown("metric", name, all.iter().copied())),
        None => Ok(()),
    }
}

fn instead(name: &str, metrics: &Metrics) -> String {
    let known = || metrics.keys().map(String::as_str);
    match &near::near(name, known())[..] {
        [] => format!("it has {}", known().collect::<Vec<_>>().join(", ")),
        near => near::did_you_mean(&near.iter().map(ToString::to_string).collect::<Vec<_>>()),
    }
}
