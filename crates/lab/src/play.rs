//! Its scenario commands the robot of the lab: bit for bit the run of the command line with this seed.

use rumbo_control::params::Params;
use rumbo_experiment::files::{FileError, Setup};
use rumbo_experiment::note::Note;
use rumbo_experiment::run::{Player, RunResult, parameters};
use rumbo_log::{Burst, ExperimentPhase, ExperimentState, LimitState};
use rumbo_sim::Sim;
use rumbo_sim::trace::SAMPLE_US;
use std::sync::Arc;

/// An experiment of the lab.
#[derive(Default)]
pub(crate) struct Experiment {
    /// While it goes on.
    player: Option<Player<Arc<Setup>>>,
    pub(crate) state: ExperimentState,
    /// The robot's parameters at its start.
    pub(crate) parameters: Option<Params>,
    /// What crossed the link and was not fetched yet.
    sent: Vec<Burst>,
    received: Vec<u8>,
    /// Time since the start, of which whole samples pass \[us\].
    given_us: u64,
}

impl Experiment {
    /// One that begins; these parameters are not its scenario's.
    pub(crate) fn new(
        player: Player<Arc<Setup>>,
        changed: Vec<(String, f64)>,
    ) -> Result<Self, FileError> {
        Ok(Self {
            state: ExperimentState {
                duration_s: player.setup().scenario.duration_s,
                limits: limits(player.setup()),
                parameters: changed,
                ..ExperimentState::default()
            },
            parameters: parameters(player.setup())?,
            player: Some(player),
            ..Self::default()
        })
    }

    /// Its scenario commands the robot.
    pub(crate) fn goes_on(&self) -> bool {
        self.player.is_some()
    }

    /// So much more time passes, also when it is over.
    pub(crate) fn pass(&mut self, sim: &mut Sim, dt_us: u64) {
        self.given_us += dt_us;
        let Some(player) = &mut self.player else {
            return sim.advance(self.given_us / SAMPLE_US * SAMPLE_US);
        };
        player.advance(sim, self.given_us);
        for burst in player.take_link(sim).iter() {
            match burst.to_robot {
                true => self.sent.push(Burst {
                    t_us: burst.t_us,
                    to_robot: true,
                    bytes: burst.bytes.to_vec(),
                }),
                false => self.received.extend(burst.bytes),
            }
        }
        if player.is_over(std::slice::from_ref(sim))
            && let Some(player) = self.player.take()
        {
            self.state = verdict(&self.state, &player.judge(sim));
        }
    }

    /// A person ends it.
    pub(crate) fn stop(&mut self) {
        if self.player.take().is_some() {
            self.state.phase = ExperimentPhase::Stopped;
        }
    }

    /// What it has sent since the last call.
    pub(crate) fn scripted(&mut self) -> Vec<Burst> {
        std::mem::take(&mut self.sent)
    }

    /// Appends what has arrived from the robot since the last call.
    pub(crate) fn receive(&mut self, into: &mut Vec<u8>) {
        into.append(&mut self.received);
    }
}

/// The limits of a setup, not judged yet.
fn limits(setup: &Setup) -> Vec<LimitState> {
    let limits = setup.scenario.limits.iter();
    limits
        .map(|(name, bounds)| LimitState {
            name: name.clone(),
            min: bounds.min,
            max: bounds.max,
            ..LimitState::default()
        })
        .collect()
}

fn verdict(state: &ExperimentState, result: &RunResult) -> ExperimentState {
    let mut state = state.clone();
    state.phase = match result.pass {
        true => ExperimentPhase::Passed,
        false => ExperimentPhase::Failed,
    };
    for limit in &mut state.limits {
        limit.value = result.metrics.get(&limit.name).copied();
        let is_missed =
            |note: &Note| matches!(note, Note::Limit { metric, .. } if *metric == limit.name);
        limit.kept = limit.value.is_some() && !result.failures.iter().any(is_missed);
    }
    state.failures = result.failures.iter().map(Note::to_string).collect();
    state
}
