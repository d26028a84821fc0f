//! Runs of a scenario: headless, as fast as the machine can, many seeds on all cores.
//!
//! A run depends on its setup and seed alone, so its result is the same on one thread and on many.

#[cfg(feature = "host")]
mod batch;

#[cfg(feature = "host")]
pub use batch::run_all;

use crate::calibrate::calibrate_simulated;
use crate::files::{FileError, Setup, near};
use crate::metrics::{self, Metrics};
use crate::operator::Operator;
use rumbo_control::params::Params;
use rumbo_emulator::observe::waveform::Waveform;
use rumbo_sim::Sim;
use rumbo_sim::mega::Mega;
use rumbo_sim::trace::{Heard, SAMPLE_US, Trace};
use serde::Serialize;
use std::borrow::Cow;
use std::fs::File;
use std::io::{self, BufWriter};

/// The file of a run's waveforms.
pub(crate) type Waves = Waveform<BufWriter<File>>;

/// What a run gave.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct RunResult {
    /// Name of the scenario.
    pub scenario: String,
    /// The seed.
    pub seed: u64,
    /// Path of the scenario, if it is none of the built-in ones.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub path: Option<String>,
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
    /// How the program ended, if it could not go on.
    #[serde(skip)]
    pub ended: Option<String>,
    /// What really happened.
    #[serde(skip)]
    pub trace: Trace,
}

/// A run under way.
pub struct Run<'a> {
    setup: &'a Setup,
    seed: u64,
    sim: Sim,
    operator: Operator<'a>,
    trace: Trace,
    end_us: u64,
    /// Where the sample under way ends [us].
    sample_us: u64,
    /// Where the pins are drawn, if anybody wants to see them.
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

    /// What the robot has said so far, as metrics need it.
    pub(crate) fn heard(&self) -> &[Heard] {
        &self.operator.heard
    }

    /// What really happened so far.
    pub(crate) fn trace(&self) -> &Trace {
        &self.trace
    }

    /// The time is over, or the program has ended.
    pub fn is_over(&self) -> bool {
        self.sim.now_us() >= self.end_us || self.sim.verdict().is_some()
    }

    /// Goes on to the end of a sample, or to where a debugger halts the program.
    pub fn advance(&mut self) {
        if self.sim.now_us() >= self.sample_us {
            self.operator.step(&mut self.sim);
            self.sample_us = (self.sim.now_us() + SAMPLE_US).min(self.end_us);
        }
        self.sim.advance(self.sample_us);
        self.draw_levels();
        if self.sim.now_us() >= self.sample_us || self.sim.verdict().is_some() {
            self.trace.take(&self.sim);
            self.trace.listen(&mut self.sim);
        }
    }

    /// From here on the pins are drawn there.
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

    /// The drawing ends here.
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
        self.trace.heard = self.operator.heard;
        self.trace.link = self.sim.take_tapped();
        let metrics = metrics::compute(setup, &self.sim, &self.trace);
        let mut failures = self.operator.complaints;
        let verdict = self.sim.verdict();
        let ended = verdict.is_some();
        failures.extend(verdict.clone());
        let mut notes = self.operator.notes;
        notes.extend(self.sim.mega().map(Mega::notes).into_iter().flatten());
        // What its program did not live to do is not judged: the verdict says enough.
        let limits = scenario.limits.iter().filter(|_| !ended);
        for (name, bounds) in limits {
            match metrics.get(name) {
                Some(value) if bounds.admit(*value) => {}
                Some(value) if value.is_finite() => {
                    failures.push(format!("{name} = {value:.4}: limit {bounds}"));
                }
                // What is measured did not happen.
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

/// What the table of a robot holds before the first command, if it has one.
pub(crate) fn parameters(setup: &Setup) -> Result<Option<Params>, FileError> {
    if !setup.takes_parameters() {
        return Ok(None);
    }
    let mut parameters = Params::default();
    for (id, value) in setup.control_parameters()? {
        // Checked where it was read.
        let _ = parameters.set(id, value);
    }
    Ok(Some(parameters))
}

/// Runs a scenario once.
///
/// # Errors
/// If the setup's values do not fit together, or the calibration that it asks for came to no end.
pub fn run(setup: &Setup, seed: u64) -> Result<RunResult, FileError> {
    run_by(setup, seed, |run| {
        while !run.is_over() {
            run.advance();
        }
        Ok(())
    })
}

/// Runs a scenario once as the caller lets it go on; what it has come to by then is judged.
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

fn instead(name: &str, metrics: &Metrics) -> String {
    let known = || metrics.keys().map(String::as_str);
    match &near::near(name, known())[..] {
        [] => format!("it has {}", known().collect::<Vec<_>>().join(", ")),
        near => near::did_you_mean(&near.iter().map(ToString::to_string).collect::<Vec<_>>()),
    }
}
