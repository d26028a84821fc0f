//! A run of one robot that the caller advances and watches: bit for bit that of [`super::run`].

use super::{Member, RunResult, judged, prepare};
use crate::files::{FileError, Setup};
use rumbo_sim::trace::SAMPLE_US;
use rumbo_sim::{Burst, Sim};
use std::borrow::Cow;
use std::sync::Arc;

/// The setup as it is run with a seed: with the goal of its world, and calibrated if its scenario asks for that.
///
/// # Errors
/// The setup's values do not fit together, or its calibration failed.
pub(crate) fn of_seed(setup: &Arc<Setup>, seed: u64) -> Result<Arc<Setup>, FileError> {
    let drawn = setup.of_seed(seed)?;
    let calibrated = match prepare(&drawn, seed)? {
        Cow::Owned(calibrated) => Some(calibrated),
        Cow::Borrowed(_) => None,
    };
    Ok(match (calibrated, drawn) {
        (Some(own), _) | (None, Cow::Owned(own)) => Arc::new(own),
        (None, Cow::Borrowed(_)) => setup.clone(),
    })
}

/// The scenario of a setup, as it commands a robot.
pub struct Player {
    setup: Arc<Setup>,
    member: Member<Arc<Setup>>,
    seed: u64,
    /// End of the next sample \[us\].
    sample_us: u64,
    end_us: u64,
}

impl Player {
    /// With the robot at its start.
    ///
    /// # Errors
    /// The setup's values do not fit together, or its calibration failed.
    pub fn new(setup: &Arc<Setup>, seed: u64) -> Result<(Sim, Self), FileError> {
        let setup = of_seed(setup, seed)?;
        let (mut sim, mut member) = Member::new(setup.clone(), seed)?;
        member.operator.step(&mut sim);
        let end_us = (setup.scenario.duration_s * 1e6) as u64;
        let player = Self {
            setup,
            member,
            seed,
            sample_us: SAMPLE_US.min(end_us),
            end_us,
        };
        Ok((sim, player))
    }

    /// What it plays.
    pub fn setup(&self) -> &Setup {
        &self.setup
    }

    /// Advances it to the last whole sample before this time \[us\].
    pub fn advance(&mut self, sim: &mut Sim, until_us: u64) {
        while self.sample_us <= until_us && !self.is_over(sim) {
            sim.advance(self.sample_us);
            self.member.trace.sample(sim);
            if !self.is_over(sim) {
                self.member.operator.step(sim);
                self.sample_us = (sim.now_us() + SAMPLE_US).min(self.end_us);
            }
        }
    }

    /// What has crossed the link since the last call.
    pub fn take_link(&mut self, sim: &mut Sim) -> Vec<Burst> {
        let bursts = sim.take_tapped();
        self.member.trace.link.extend(bursts.iter().cloned());
        bursts
    }

    /// The time is over, or the program has ended.
    pub fn is_over(&self, sim: &Sim) -> bool {
        sim.now_us() >= self.end_us || sim.verdict().is_some()
    }

    /// How it went.
    pub fn judge(self, sim: &mut Sim) -> RunResult {
        judged(&self.setup, self.member.result(sim, self.seed))
    }
}
