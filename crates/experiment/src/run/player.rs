//! What scenarios have to do with robots that the caller advances, in samples: bit for bit a run of [`super::run`].

use super::{Member, RunResult, judged, prepare};
use crate::files::{FileError, Setup};
use rumbo_sim::trace::SAMPLE_US;
use rumbo_sim::{LinkTape, Sim};
use std::borrow::Cow;
use std::ops::Deref;
use std::sync::Arc;

/// The setup as [`prepare`] has it, shared.
///
/// # Errors
/// The same.
pub(crate) fn of_seed(setup: &Arc<Setup>, seed: u64) -> Result<Arc<Setup>, FileError> {
    Ok(match prepare(setup, seed)? {
        Cow::Owned(own) => Arc::new(own),
        Cow::Borrowed(_) => setup.clone(),
    })
}

/// The scenario of a setup, as it commands its robots.
pub struct Player<S> {
    pub(super) setup: S,
    pub(super) members: Vec<Member<S>>,
    seed: u64,
    /// End of the current sample \[us\].
    pub(super) sample_us: u64,
    end_us: u64,
}

impl<S: Deref<Target = Setup> + Clone> Player<S> {
    /// With `robots`, those of `setup`, prepared for the seed, at their start.
    pub(super) fn of(
        setup: S,
        robots: impl IntoIterator<Item = S>,
        seed: u64,
    ) -> Result<(Vec<Sim>, Self), FileError> {
        let members = robots.into_iter().map(|robot| Member::new(robot, seed));
        let members: Vec<_> = members.collect::<Result<_, _>>()?;
        let (sims, members): (Vec<Sim>, _) = members.into_iter().unzip();
        let player = Self {
            end_us: (setup.scenario.duration_s * 1e6) as u64,
            sample_us: sims.first().map_or(0, Sim::now_us),
            setup,
            members,
            seed,
        };
        Ok((sims, player))
    }

    /// What it plays.
    pub fn setup(&self) -> &Setup {
        &self.setup
    }

    /// The time is over, or a program has ended.
    pub fn is_over(&self, sims: &[Sim]) -> bool {
        sims[0].now_us() >= self.end_us || has_ended(sims)
    }

    /// Before a sample: what the operators send.
    pub(super) fn operate(&mut self, sims: &mut [Sim]) {
        if sims[0].now_us() >= self.sample_us {
            for (sim, member) in std::iter::zip(&mut *sims, &mut self.members) {
                member.operator.step(sim);
            }
            self.sample_us = (sims[0].now_us() + SAMPLE_US).min(self.end_us);
        }
    }

    /// At its end, or that of a program: ground truth. Whether it is there.
    pub(super) fn sample(&mut self, sims: &[Sim]) -> bool {
        let due = sims[0].now_us() >= self.sample_us || has_ended(sims);
        if due {
            for (sim, member) in std::iter::zip(sims, &mut self.members) {
                member.trace.sample(sim);
            }
        }
        due
    }

    /// After a sample: what their programs say and show.
    pub(super) fn listen(&mut self, sims: &mut [Sim]) {
        for (sim, member) in std::iter::zip(sims, &mut self.members) {
            member.trace.listen(sim);
        }
    }

    /// What became of each robot, not yet judged by limits.
    pub(super) fn results(self, sims: &mut [Sim]) -> Vec<RunResult> {
        std::iter::zip(sims, self.members)
            .map(|(sim, member)| member.result(sim, self.seed))
            .collect()
    }
}

fn has_ended(sims: &[Sim]) -> bool {
    sims.iter().any(|robot| robot.verdict().is_some())
}

impl Player<Arc<Setup>> {
    /// With the only robot of a setup, at its start.
    ///
    /// # Errors
    /// The setup's values do not fit together, or its calibration failed.
    pub fn new(setup: &Arc<Setup>, seed: u64) -> Result<(Sim, Self), FileError> {
        let setup = of_seed(setup, seed)?;
        let (mut sims, mut player) = Self::of(setup.clone(), [setup], seed)?;
        player.operate(&mut sims);
        Ok((sims.swap_remove(0), player))
    }

    /// Advances it to the last whole sample before this time \[us\].
    pub fn advance(&mut self, sim: &mut Sim, until_us: u64) {
        let sims = std::slice::from_mut(sim);
        while self.sample_us <= until_us && !self.is_over(sims) {
            sims[0].advance(self.sample_us);
            self.sample(sims);
            if !self.is_over(sims) {
                self.operate(sims);
            }
        }
    }

    /// What has crossed the link since the last call.
    pub fn take_link(&mut self, sim: &mut Sim) -> LinkTape {
        let tape = sim.take_tapped();
        let members = self.members.iter_mut();
        members.for_each(|member| member.trace.link.append(tape.clone()));
        tape
    }

    /// How it went.
    pub fn judge(self, sim: &mut Sim) -> RunResult {
        let setup = self.setup.clone();
        let mut results = self.results(std::slice::from_mut(sim));
        judged(&setup, results.swap_remove(0))
    }
}
