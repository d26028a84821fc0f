//! The robots of a scenario with several, in one world, stepped by a caller.

use super::Made;
use super::history::{Act, History};
use super::pilot::{Driver, Pilot, TRUE};
use crate::files::{FileError, Setup};
use rumbo_control::policy::OBSERVED;
use rumbo_control::{Drive, ServoAngle, TICK_US, Wheels};
use rumbo_plant::world::World;
use rumbo_sim::fleet::Fleet;
use rumbo_wire::{Command, Refusal};
use std::sync::Arc;

/// Robots under way in one world. By their scenario they are bit for bit those of [`crate::run::run`], without its records.
/// A clone is a snapshot, which continues bit for bit the same.
#[derive(Clone)]
pub struct Team {
    fleet: Fleet,
    pilots: Vec<Pilot>,
    seed: u64,
    history: History,
}

impl Team {
    /// The robots of a seed at their start. `driver` says by its number who commands each. One without a goal of its world
    /// has the first one of its scenario's commands.
    ///
    /// # Errors
    /// The setup's values do not fit together, a calibration failed, or a program takes no commands of a caller.
    pub fn new(
        setup: &Setup,
        driver: impl Fn(usize) -> Driver,
        seed: u64,
    ) -> Result<Self, FileError> {
        Self::made(setup, driver, seed, &|| Ok(()))
    }

    /// The same; `made` is called after each robot is made, and its error ends it.
    ///
    /// # Errors
    /// As [`Team::new`], and that of `made`.
    pub fn made(
        setup: &Setup,
        driver: impl Fn(usize) -> Driver,
        seed: u64,
        made: Made<'_>,
    ) -> Result<Self, FileError> {
        let (mut sims, mut pilots) = (Vec::new(), Vec::new());
        for (index, robot) in setup.robots().iter().enumerate() {
            let robot = Arc::new(robot.clone());
            let (sim, mut pilot) = Pilot::new(&robot, driver(index), seed)?;
            pilot.seek_first_goal(&robot);
            sims.push(sim);
            pilots.push(pilot);
            made()?;
        }
        let fleet = Fleet::new(sims).map_err(|error| {
            FileError::Setting(format!("scenario {}: {error}", setup.scenario.name))
        })?;
        Ok(Self {
            fleet,
            pilots,
            seed,
            history: History::default(),
        })
    }

    /// Does to it, at its start, what was done to another one of its setup, drivers and seed, which it then is: see
    /// [`Team::history`].
    ///
    /// # Errors
    /// These are no bytes of a history.
    pub fn relive(&mut self, history: &[u8]) -> Result<(), FileError> {
        let mut own = 0;
        for act in History::acts(history)? {
            match act {
                Act::Of(index) => own = usize::from(index),
                Act::Advance(ticks) => self.advance(ticks),
                Act::Command(command) => {
                    // What was refused then is refused again.
                    let _ = self.command(own, &command);
                }
                Act::Aim(servo) => self.aim(own, servo),
                Act::Drive(wheels, servo) => self.drive(own, wheels, servo),
                Act::Duty(..)
                | Act::Instruct(_)
                | Act::Record
                | Act::Probe
                | Act::Type(..)
                | Act::Apply(..) => {}
            }
        }
        Ok(())
    }

    /// What was done to it since its start, for [`Team::relive`].
    pub fn history(&self) -> Vec<u8> {
        self.history.to_bytes()
    }

    /// How many robots there are.
    pub fn count(&self) -> usize {
        self.pilots.len()
    }

    /// The seed they were drawn for.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// The world around a robot, with the others as bodies that move; `None` beyond the last robot.
    pub fn world(&self, index: usize) -> Option<&World> {
        self.fleet.robots().get(index).map(|sim| sim.world())
    }

    /// The fault that a robot has latched, in words.
    pub fn fault(&self, index: usize) -> Option<&'static str> {
        let fault = self.fleet.robots().get(index)?.fault();
        fault.map(|fault| fault.explanation())
    }

    /// Advances all by this many control ticks of 10 ms, or to the end of a program that cannot go on.
    pub fn advance(&mut self, ticks: u32) {
        self.history.push(&Act::Advance(ticks));
        for _ in 0..ticks {
            let mut robots = self.fleet.robots().iter();
            if robots.any(|robot| robot.verdict().is_some()) {
                return;
            }
            for (sim, pilot) in std::iter::zip(self.fleet.robots_mut(), &mut self.pilots) {
                drop(pilot.operate(sim));
            }
            let until_us = self.fleet.now_us() + u64::from(TICK_US);
            self.fleet.advance(until_us);
        }
    }

    /// Applies a command at once to a robot that the caller commands; gives the value in force, 0 where there is none.
    ///
    /// # Errors
    /// Why the robot refuses it; `None` if there is no such robot, or its scenario commands it.
    pub fn command(&mut self, index: usize, command: &Command) -> Result<f32, Option<Refusal>> {
        self.note(index, || Act::Command(*command));
        let sim = self.fleet.robot_mut(index).ok_or(None)?;
        let pilot = self.pilots.get_mut(index).ok_or(None)?;
        pilot.command(sim, command)
    }

    /// Points the servo of a robot that the caller commands, whatever its mode requests; `None` leaves it to the mode again.
    pub fn aim(&mut self, index: usize, servo: Option<ServoAngle>) {
        self.note(index, || Act::Aim(servo));
        if let (Some(sim), Some(pilot)) = (self.fleet.robot_mut(index), self.pilots.get(index)) {
            pilot.aim(sim, servo);
        }
    }

    /// Gives the wheels of a robot that the caller commands speeds [rad/s], and points its servo.
    pub fn drive(&mut self, index: usize, wheels: Wheels<f32>, servo: ServoAngle) {
        self.note(index, || Act::Drive(wheels, servo));
        let robot = self.fleet.robot_mut(index);
        if let (Some(sim), Some(pilot)) = (robot, self.pilots.get_mut(index)) {
            pilot.drive(sim, &Drive::WheelSpeed(wheels), servo);
        }
    }

    /// What a caller does; a scenario's robot does not obey.
    fn note(&mut self, index: usize, act: impl FnOnce() -> Act) {
        let is_caller = self.pilots.get(index).is_some_and(Pilot::is_caller);
        if let (true, Ok(number)) = (is_caller, u8::try_from(index)) {
            self.history.push(&Act::Of(number));
            self.history.push(&act());
        }
    }

    /// Writes a row for each robot into `known` and `truth`, in the order of [`OBSERVED`] and [`TRUE`].
    pub fn observe(&self, known: &mut [f32], truth: &mut [f64]) {
        let rows = known
            .chunks_exact_mut(OBSERVED.len())
            .zip(truth.chunks_exact_mut(TRUE.len()));
        let robots = self.fleet.robots().iter().zip(&self.pilots);
        for ((sim, pilot), (known, truth)) in robots.zip(rows) {
            known.copy_from_slice(&pilot.observed(sim));
            truth.copy_from_slice(&pilot.true_values(sim));
        }
    }
}
