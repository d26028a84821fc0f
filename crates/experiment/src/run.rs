//! Runs of a scenario: headless, as fast as the machine can, many seeds on all cores.
//!
//! A run depends on its setup and seed alone, so its result is the same on one thread and on many.

#[cfg(feature = "host")]
mod batch;

mod judge;
mod lost;
mod player;
mod still;

use judge::{judged, together};
pub use player::Player;
pub(crate) use player::of_seed;

#[cfg(feature = "host")]
pub use batch::{in_order, run_all, run_all_on, run_each};

use crate::calibrate::calibrate_simulated;
use crate::files::{Calibrated, FileError, Setup, unknown};
use crate::metrics::{self, Metrics};
use crate::note::Note;
use crate::operator::Operator;
use rumbo_control::params::{ParamId, Params};
use rumbo_emulator::observe::waveform::Waveform;
use rumbo_sim::Sim;
use rumbo_sim::fleet::Fleet;
use rumbo_sim::mega::Mega;
use rumbo_sim::trace::{SAMPLE_US, Trace};
use serde::Serialize;
use std::borrow::Cow;
use std::collections::BTreeSet;
use std::fs::File;
use std::io::{self, BufWriter};
use std::ops::Deref;
use std::sync::atomic::{AtomicBool, Ordering};

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
    #[serde(rename = "passed")]
    pub pass: bool,
    /// All metrics; units in the names.
    pub metrics: Metrics,
    /// Why it did not pass, a line each.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub failures: Vec<Note>,
    /// Notes for the reader, a line each.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<Note>,
    /// How the program ended, if it could not go on.
    #[serde(skip)]
    pub ended: Option<Note>,
    /// Ground truth; of several robots each has its own.
    #[serde(skip)]
    pub trace: Trace,
    /// The results of the robots, if there are several, each by its name and without limits.
    #[serde(skip)]
    pub robots: Vec<RunResult>,
}

impl RunResult {
    /// A robot has driven a wheel.
    fn drove(&self) -> bool {
        self.trace.drove() || self.robots.iter().any(RunResult::drove)
    }
}

/// A robot in a run, its commands, and what is known of it.
struct Member<S> {
    setup: S,
    operator: Operator<S>,
    trace: Trace,
}

/// A run in progress: of one robot, or of all in a world.
pub struct Run<'a> {
    player: Player<&'a Setup>,
    fleet: Fleet,
    /// Its robots, in order.
    sims: Vec<Sim>,
    /// Destination of the pins' waveforms, if they are recorded.
    waves: Option<Waves>,
    undrawn: io::Result<()>,
}

impl<'a> Run<'a> {
    /// `robots` are those of `setup`, prepared for the seed.
    pub(crate) fn new(
        setup: &'a Setup,
        robots: impl IntoIterator<Item = &'a Setup>,
        seed: u64,
    ) -> Result<Self, FileError> {
        let (mut sims, player) = Player::of(setup, robots, seed)?;
        let fleet = Fleet::new(&mut sims).map_err(|error| {
            FileError::Setting(format!("scenario {}: {error}", setup.scenario.name))
        })?;
        Ok(Self {
            player,
            fleet,
            sims,
            waves: None,
            undrawn: Ok(()),
        })
    }

    /// Robot and program; of several the first.
    pub fn sim(&mut self) -> &mut Sim {
        &mut self.sims[0]
    }

    pub(crate) fn mega(&self) -> Option<&Mega> {
        self.sims[0].mega()
    }

    /// The messages received from the robot so far.
    #[cfg(feature = "host")]
    pub(crate) fn received(&self) -> &[rumbo_sim::trace::TimedMessage] {
        &self.player.members[0].operator.received
    }

    /// Ground truth so far.
    #[cfg(feature = "host")]
    pub(crate) fn trace(&self) -> &Trace {
        &self.player.members[0].trace
    }

    /// The time is over, or a program has ended.
    pub fn is_over(&self) -> bool {
        self.player.is_over(&self.sims)
    }

    /// Advances to the end of a sample, or to where a debugger halts the program.
    pub fn advance(&mut self) {
        self.player.operate(&mut self.sims);
        self.fleet.advance(&mut self.sims, self.player.sample_us);
        self.draw_levels();
        if self.player.sample(&self.sims) {
            self.player.listen(&mut self.sims);
        }
    }

    /// Records the pins' waveforms from now on.
    pub(crate) fn draw(&mut self, waves: Waves) {
        self.waves = Some(waves);
    }

    fn draw_levels(&mut self) {
        if let (Some(waves), Some(mega)) = (&mut self.waves, self.sims[0].mega_mut()) {
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
        match (self.waves.take(), self.sims[0].mega()) {
            (Some(waves), Some(mega)) => waves.finish(mega.chip().cycle()),
            _ => Ok(()),
        }
    }

    fn judge(mut self) -> RunResult {
        let setup = self.player.setup;
        let mut robots = self.player.results(&mut self.sims);
        let whole = match &mut robots[..] {
            [only] => std::mem::take(only),
            _ => together(&self.fleet, &self.sims, robots),
        };
        judged(setup, whole)
    }
}

impl<S: Deref<Target = Setup> + Clone> Member<S> {
    /// With its robot at its start.
    fn new(setup: S, seed: u64) -> Result<(Sim, Self), FileError> {
        let mut sim = setup.sim(seed)?;
        let mut operator = Operator::new(setup.clone());
        operator.brief(&mut sim)?;
        sim.tap_link();
        let mut trace = Trace {
            parameters: parameters(&setup)?,
            ..Trace::default()
        };
        let samples = setup.scenario.duration_s * 1e6 / SAMPLE_US as f64;
        trace.samples.reserve(samples as usize + 1);
        let member = Self {
            setup,
            operator,
            trace,
        };
        Ok((sim, member))
    }

    /// What became of it, not yet judged by limits.
    fn result(mut self, sim: &mut Sim, seed: u64) -> RunResult {
        self.trace.messages = self.operator.received;
        self.trace.link.append(sim.take_tapped());
        let mut failures = self.operator.complaints;
        let mut notes = self.operator.notes;
        let mut ended = None;
        if let Some(mega) = sim.mega() {
            let name = mega.firmware().name();
            let of_program = |note| Note::Program {
                name: name.to_owned(),
                note,
            };
            ended = mega.verdict().map(of_program);
            notes.extend(mega.notes().into_iter().map(of_program));
            notes.extend(mega.data_sheet().map(Note::from));
            notes.extend(still::in_vain(&self.trace.samples));
            notes.extend(lost::its_line(&self.setup, &self.trace));
        }
        failures.extend(ended.clone());
        RunResult {
            scenario: self.setup.scenario.name.clone(),
            seed,
            metrics: metrics::compute(&self.setup, sim, &self.trace),
            failures,
            notes,
            ended,
            trace: self.trace,
            ..RunResult::default()
        }
    }
}

/// The parameters of a robot before the first command, if it has a table of them.
///
/// # Errors
/// The setup's values do not fit together.
pub fn parameters(setup: &Setup) -> Result<Option<Params>, FileError> {
    let takes_parameters = setup.takes_parameters();
    takes_parameters.then(|| setup.params()).transpose()
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

/// The same, unless that is `over` before the run is.
///
/// # Errors
/// As [`run`].
pub fn run_unless(
    setup: &Setup,
    seed: u64,
    over: &AtomicBool,
) -> Result<Option<RunResult>, FileError> {
    let mut given_up = false;
    let result = run_by(setup, seed, |run| {
        while !run.is_over() && !given_up {
            run.advance();
            given_up = over.load(Ordering::Relaxed);
        }
        Ok::<(), FileError>(())
    })?;
    Ok((!given_up).then_some(result))
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
    let robots = setup.robots().iter().map(|robot| prepare(robot, seed));
    let robots: Vec<_> = robots.collect::<Result<_, _>>()?;
    let mut run = Run::new(setup, robots.iter().map(|robot| &**robot), seed)?;
    go_on(&mut run)?;
    Ok(run.judge())
}

/// The setup to run with a seed: with boxes and goal of its world, and, if its scenario requests it, with the
/// parameters from a calibration of this seed's robot. The scenario's own parameters win over them; the report's
/// program has none.
///
/// # Errors
/// A random world that finds no room, or the calibration failed.
pub fn prepare(setup: &Setup, seed: u64) -> Result<Cow<'_, Setup>, FileError> {
    let drawn = setup.of_seed(seed)?;
    if !drawn.scenario.calibrated || !drawn.takes_parameters() {
        return Ok(drawn);
    }
    let mut parameters = calibration(&drawn, seed)?;
    let mut setup = drawn.into_owned();
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
    let all: BTreeSet<&str> = known.iter().copied().chain(bare).collect();
    match names.find(|name| !all.contains(name)) {
        Some(name) => Err(unknown("metric", name, all.iter().copied())),
        None => Ok(()),
    }
}
