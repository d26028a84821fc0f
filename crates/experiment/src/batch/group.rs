//! The robots of a seed: one, or several in one world that go on together.

use super::history::{Act, History};
use super::pilot::{DrivenBy, TRUE};
use super::robot::Robot;
use super::{Life, Made};
use crate::files::{FileError, Setup};
use rumbo_control::TICK_US;
use rumbo_control::policy::OBSERVED;
use rumbo_sim::fleet::Fleet;
use std::sync::Arc;

/// Robots in one world. By their scenario they are bit for bit those of [`crate::run::run`], without its records.
#[derive(Clone)]
pub struct Group {
    seed: u64,
    robots: Vec<Robot>,
    fleet: Fleet,
}

impl Group {
    /// A robot of each setup at its start, driven so; `made` is called after each one, and its error ends it.
    pub(super) fn new(
        setups: &[Arc<Setup>],
        drivers: &[DrivenBy],
        seed: u64,
        made: Made<'_>,
    ) -> Result<Self, FileError> {
        let mut robots = Vec::with_capacity(setups.len());
        for (setup, driver) in std::iter::zip(setups, drivers) {
            let mut robot = Robot::new(setup, *driver, seed)?;
            if setups.len() > 1 {
                robot.seek_first_goal(setup);
            }
            robots.push(robot);
            made()?;
        }
        let fleet = Fleet::new(&mut sims(&mut robots))
            .map_err(|error| FileError::Setting(error.to_string()))?;
        Ok(Self {
            seed,
            robots,
            fleet,
        })
    }

    /// What defines it.
    pub(super) fn life(&self) -> Life {
        let histories = self.robots.iter().map(Robot::history).collect();
        (self.seed, histories)
    }

    /// Does to its robots, at their start, what was done to those of these histories.
    pub(super) fn relive(&mut self, histories: &[Vec<u8>]) -> Result<(), FileError> {
        let acts = histories.iter().map(|history| History::acts(history));
        let mut acts: Vec<_> = acts.collect::<Result<_, _>>()?;
        acts.iter_mut().for_each(|acts| acts.reverse());
        loop {
            let mut next = None;
            for (robot, acts) in std::iter::zip(&mut self.robots, &mut acts) {
                while let Some(act) = acts.pop() {
                    if let Act::Advance(ticks) = act {
                        next = Some(next.map_or(ticks, |next: u32| next.min(ticks)));
                        acts.push(act);
                        break;
                    }
                    robot.redo(act)?;
                }
            }
            let Some(ticks) = next else {
                return Ok(());
            };
            self.advance(ticks);
            for acts in &mut acts {
                if let Some(Act::Advance(left)) = acts.pop()
                    && left > ticks
                {
                    acts.push(Act::Advance(left - ticks));
                }
            }
        }
    }

    /// The robots, in the order of the scenario.
    pub fn robots(&self) -> &[Robot] {
        &self.robots
    }

    /// The robots, to be commanded one by one.
    pub fn robots_mut(&mut self) -> &mut [Robot] {
        &mut self.robots
    }

    /// Advances all by this many control ticks of 10 ms, or to the end of a program that cannot go on.
    pub fn advance(&mut self, ticks: u32) {
        if let [only] = &mut self.robots[..] {
            return only.advance(ticks);
        }
        let robots = self.robots.iter_mut();
        robots.for_each(|robot| robot.note_ticks(ticks));
        for _ in 0..ticks {
            if self.robots.iter().any(|robot| robot.ended().is_some()) {
                return;
            }
            self.robots.iter_mut().for_each(Robot::operate);
            let mut sims = sims(&mut self.robots);
            let until_us = sims[0].now_us() + u64::from(TICK_US);
            self.fleet.advance(&mut sims, until_us);
            self.robots.iter_mut().for_each(Robot::sample);
        }
    }

    /// Writes a row for each robot, in the order of [`OBSERVED`] and [`TRUE`].
    pub(super) fn observe(&self, known: &mut [f32], truth: &mut [f64]) {
        let known = known.chunks_exact_mut(OBSERVED.len());
        let rows = known.zip(truth.chunks_exact_mut(TRUE.len()));
        for (robot, (known, truth)) in self.robots.iter().zip(rows) {
            known.copy_from_slice(&robot.observed());
            truth.copy_from_slice(&robot.true_values());
        }
    }
}

fn sims(robots: &mut [Robot]) -> Vec<&mut rumbo_sim::Sim> {
    robots.iter_mut().map(Robot::sim_mut).collect()
}
