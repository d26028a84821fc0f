//! One robot of a batch: its simulation, and who commands it.

use super::pilot::{Driver, Pilot, TRUE};
use crate::files::{FileError, Setup};
use rumbo_control::policy::Observation;
use rumbo_control::{ServoAngle, TICK_US};
use rumbo_plant::world::World;
use rumbo_sim::Sim;
use rumbo_sim::trace::Trace;
use rumbo_wire::{Command, Refusal};
use std::sync::{Arc, OnceLock};

/// A robot under way. A clone is a snapshot, which continues bit for bit the same.
#[derive(Clone)]
pub struct Robot {
    seed: u64,
    sim: Sim,
    pilot: Pilot,
    /// What was recorded of it, if it is.
    trace: Option<Box<Trace>>,
}

impl Robot {
    /// The robot of a seed at its start.
    ///
    /// # Errors
    /// The setup's values do not fit together, its calibration failed, or its program takes no commands of a caller.
    pub fn new(setup: &Arc<Setup>, driver: Driver, seed: u64) -> Result<Self, FileError> {
        let (sim, pilot) = Pilot::new(setup, driver, seed)?;
        Ok(Self {
            seed,
            sim,
            pilot,
            trace: None,
        })
    }

    /// The seed it was drawn for.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// The simulation.
    pub fn sim(&self) -> &Sim {
        &self.sim
    }

    /// The world it drives in.
    pub fn world(&self) -> &World {
        self.sim.world()
    }

    /// Records it from now on, as the log of a run has it, in place of what was recorded before. It goes on bit for bit as
    /// without.
    ///
    /// # Errors
    /// The setup's values do not fit together.
    pub fn record(&mut self) -> Result<(), FileError> {
        let parameters = self.pilot.parameters(&mut self.sim)?;
        self.sim.tap_link();
        self.trace = Some(Box::new(Trace {
            parameters,
            ..Trace::default()
        }));
        Ok(())
    }

    /// What was recorded since [`Robot::record`]; `None` without it.
    pub fn trace(&self) -> Option<&Trace> {
        self.trace.as_deref()
    }

    /// The goal of its world as seen from its start: ahead, left [m].
    pub fn goal_m(&self) -> Option<[f32; 2]> {
        self.pilot.goal_m()
    }

    /// Keeps its world in common with others if it is the same.
    pub(super) fn share_world(&mut self, common: &OnceLock<Arc<World>>) {
        self.sim.share_world(common);
    }

    /// Advances by this many control ticks of 10 ms, or to the end of a program that cannot go on.
    pub fn advance(&mut self, ticks: u32) {
        if !self.needs_every_tick() {
            let until_us = self.sim.now_us() + u64::from(ticks) * u64::from(TICK_US);
            return self.sim.advance(until_us);
        }
        for _ in 0..ticks {
            if self.sim.verdict().is_some() {
                return;
            }
            self.operate();
            self.sim.advance(self.sim.now_us() + u64::from(TICK_US));
            self.sample();
        }
    }

    /// An operator or a recorder looks at it at each tick.
    fn needs_every_tick(&self) -> bool {
        !self.pilot.is_caller() || self.trace.is_some()
    }

    /// Before a tick: what its operator sends.
    fn operate(&mut self) {
        let received = self.pilot.operate(&mut self.sim);
        match &mut self.trace {
            Some(trace) => trace.messages.extend(received),
            None => drop(received),
        }
    }

    /// After a tick, if it is recorded.
    fn sample(&mut self) {
        if let Some(trace) = &mut self.trace {
            trace.sample(&self.sim);
            trace.listen(&mut self.sim);
            trace.link.append(&mut self.sim.take_tapped());
        }
    }

    /// Applies a command at once; gives the value in force, 0 where there is none.
    ///
    /// # Errors
    /// Why the robot refuses it; `None` if its scenario commands it.
    pub fn command(&mut self, command: &Command) -> Result<f32, Option<Refusal>> {
        self.pilot.command(&mut self.sim, command)
    }

    /// Applies a command in the words of a scenario's `[[command]]`, without its time: `arm = true`, `reference_m = 0.3`.
    ///
    /// # Errors
    /// What is wrong with the text, or why the robot refuses it.
    pub fn instruct(&mut self, text: &str) -> Result<(), FileError> {
        self.pilot.instruct(&mut self.sim, text)
    }

    /// Points the servo, whatever the mode requests; `None` leaves it to the mode again. A scenario's robot does not obey.
    pub fn aim(&mut self, servo: Option<ServoAngle>) {
        self.pilot.aim(&mut self.sim, servo);
    }

    /// What its program knows after its last tick: see [`super::OBSERVED`].
    pub fn observed(&self) -> Observation {
        self.pilot.observed(&self.sim)
    }

    /// Ground truth now: see [`TRUE`].
    pub fn true_values(&self) -> [f64; TRUE.len()] {
        self.pilot.true_values(&self.sim)
    }
}
