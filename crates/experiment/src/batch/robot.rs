//! One robot of a batch: its simulation, and who commands it.

use super::history::{Act, History};
use super::pilot::{DrivenBy, Pilot, TRUE};
use super::probe::Probe;
use crate::files::{FileError, Setup};
use rumbo_control::policy::Observation;
use rumbo_control::{Drive, ServoAngle, TICK_US, Wheels};
use rumbo_plant::world::World;
use rumbo_sim::Sim;
use rumbo_sim::mega::{CONSOLES, ON_PINS};
use rumbo_sim::trace::Trace;
use rumbo_sim::wiring::SONARS;
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
    /// What is at hand of its emulated board, if it is.
    probe: Option<Box<Probe>>,
    history: History,
}

impl Robot {
    /// The robot of a seed at its start.
    ///
    /// # Errors
    /// The setup's values do not fit together, its calibration failed, or its program takes no commands of a caller.
    pub fn new(setup: &Arc<Setup>, driver: DrivenBy, seed: u64) -> Result<Self, FileError> {
        let (sim, pilot) = Pilot::new(setup, driver, seed)?;
        Ok(Self {
            seed,
            sim,
            pilot,
            trace: None,
            probe: None,
            history: History::default(),
        })
    }

    /// Does to it what was done to another one of its setup and seed. What was refused then is refused again.
    pub(super) fn redo(&mut self, act: Act) -> Result<(), FileError> {
        match act {
            Act::Advance(ticks) => self.advance(ticks),
            Act::Command(command) => {
                let _ = self.command(&command);
            }
            Act::Drive(wheels, servo) => self.drive(wheels, servo),
            Act::Duty(duty, servo) => self.drive_duty(duty, servo),
            Act::Instruct(text) => {
                let _ = self.instruct(&text);
            }
            Act::Aim(servo) => self.aim(servo),
            Act::Record => self.record()?,
            Act::Probe => {
                self.probe();
            }
            Act::Type(port, bytes) => self.type_in(port, &bytes),
            Act::Apply(pin, volts) => {
                self.apply(pin, volts);
            }
        }
        Ok(())
    }

    /// What was done to it since its start: see [`Life`](super::Life).
    pub fn history(&self) -> Vec<u8> {
        self.history.to_bytes()
    }

    /// The seed it was drawn for.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// The simulation.
    pub fn sim(&self) -> &Sim {
        &self.sim
    }

    pub(super) fn sim_mut(&mut self) -> &mut Sim {
        &mut self.sim
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
        self.history.push(&Act::Record);
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

    /// Records the pins of its emulated board and what its ports send, from now on. It goes on bit for bit as without. False,
    /// and nothing else, where no board is emulated.
    pub fn probe(&mut self) -> bool {
        let Some(mega) = self.sim.mega_mut() else {
            return false;
        };
        self.probe = Some(Box::new(Probe::at(mega)));
        self.history.push(&Act::Probe);
        true
    }

    /// What was recorded since [`Robot::probe`]; `None` without it.
    pub fn probed(&self) -> Option<&Probe> {
        self.probe.as_deref()
    }

    /// Sends bytes to a USART of its emulated board from a terminal of its rate, or to [`rumbo_sim::mega::PARTS`], over
    /// the link to [`rumbo_sim::mega::ON_PINS`]; other robots do not obey.
    pub fn type_in(&mut self, port: u8, bytes: &[u8]) {
        self.history.push(&Act::Type(port, bytes.to_vec()));
        match self.sim.mega_mut() {
            Some(mega) if port != ON_PINS => mega.type_in(port, bytes),
            Some(_) => self.sim.send(bytes),
            None => {}
        }
    }

    /// Connects a pin of its emulated board, by its number, to a voltage from 0 to 5 \[V\], or takes that away. False: there
    /// is no such pin.
    pub fn apply(&mut self, pin: u8, volts: Option<f64>) -> bool {
        self.history.push(&Act::Apply(pin, volts));
        let mega = self.sim.mega_mut();
        mega.is_some_and(|mega| mega.apply(pin, volts))
    }

    /// How its program ended, if it could not go on: what, where, when.
    pub fn ended(&self) -> Option<String> {
        self.sim.verdict()
    }

    /// The goal of its world as seen from its start: ahead, left [m].
    pub fn goal_m(&self) -> Option<[f32; 2]> {
        self.pilot.goal_m()
    }

    /// Without a goal of its world it has the first one of its scenario's commands.
    pub(super) fn seek_first_goal(&mut self, setup: &Setup) {
        self.pilot.seek_first_goal(setup);
    }

    /// Keeps its world in common with others if it is the same.
    pub(super) fn share_world(&mut self, common: &OnceLock<Arc<World>>) {
        self.sim.share_world(common);
    }

    /// Advances by this many control ticks of 10 ms, or to the end of a program that cannot go on.
    pub fn advance(&mut self, ticks: u32) {
        self.note_ticks(ticks);
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

    /// That it goes on by so many ticks.
    pub(super) fn note_ticks(&mut self, ticks: u32) {
        self.history.push(&Act::Advance(ticks));
    }

    /// An operator or a recorder looks at it at each tick.
    fn needs_every_tick(&self) -> bool {
        !self.pilot.is_caller() || self.trace.is_some() || self.probe.is_some()
    }

    /// Before a tick: what its operator sends.
    pub(super) fn operate(&mut self) {
        let received = self.pilot.operate(&mut self.sim);
        match &mut self.trace {
            Some(trace) => trace.messages.extend(received),
            None => drop(received),
        }
    }

    /// After a tick, if it is recorded or probed.
    pub(super) fn sample(&mut self) {
        let from = self.trace.as_ref().map(|trace| trace.consoles.len());
        if let Some(trace) = &mut self.trace {
            trace.sample(&self.sim);
            trace.listen(&mut self.sim);
            trace.link.append(self.sim.take_tapped());
        }
        let (Some(probe), Some(mega)) = (&mut self.probe, self.sim.mega_mut()) else {
            return;
        };
        probe.look(mega);
        match (&self.trace, from) {
            // What the recorder has taken is heard from there.
            (Some(trace), Some(from)) => {
                let said = trace.consoles.iter().skip(from);
                said.for_each(|said| probe.hear(said.usart, &said.bytes));
            }
            _ => (0..CONSOLES).for_each(|port| probe.hear(port, &mega.take_console(port))),
        }
    }

    /// Applies a command at once; gives the value in force, 0 where there is none.
    ///
    /// # Errors
    /// Why the robot refuses it; `None` if its scenario commands it.
    pub fn command(&mut self, command: &Command) -> Result<f32, Option<Refusal>> {
        self.note(|| Act::Command(*command));
        self.pilot.command(&mut self.sim, command)
    }

    /// Applies a command in the words of a scenario's `[[command]]`, without its time: `arm = true`, `reference_m = 0.3`.
    ///
    /// # Errors
    /// What is wrong with the text, or why the robot refuses it.
    pub fn instruct(&mut self, text: &str) -> Result<(), FileError> {
        self.note(|| Act::Instruct(text.to_owned()));
        self.pilot.instruct(&mut self.sim, text)
    }

    /// Points the servo, whatever the mode requests; `None` leaves it to the mode again. A scenario's robot does not obey.
    pub fn aim(&mut self, servo: Option<ServoAngle>) {
        self.note(|| Act::Aim(servo));
        self.pilot.aim(&mut self.sim, servo);
    }

    /// Gives its wheels speeds [rad/s], which only the mode of wheel speeds takes, and points its servo. A scenario's robot
    /// does not obey.
    pub fn drive(&mut self, wheels: Wheels<f32>, servo: ServoAngle) {
        self.note(|| Act::Drive(wheels, servo));
        let drive = Drive::WheelSpeed(wheels);
        self.pilot.drive(&mut self.sim, &drive, servo);
    }

    /// Drives its wheels open loop, by shares of the full PWM of -1 to 1, in place of its mode, and points its servo: until
    /// [`Robot::drive`], and only while it is armed. A scenario's robot does not obey.
    pub fn drive_duty(&mut self, duty: Wheels<f32>, servo: ServoAngle) {
        self.note(|| Act::Duty(duty, servo));
        self.pilot.drive(&mut self.sim, &Drive::Duty(duty), servo);
    }

    /// What a caller does; a scenario's robot does not obey.
    fn note(&mut self, act: impl FnOnce() -> Act) {
        if self.pilot.is_caller() {
            self.history.push(&act());
        }
    }

    /// What its program knows after its last tick: see [`super::OBSERVED`].
    pub fn observed(&self) -> Observation {
        self.pilot.observed(&self.sim)
    }

    /// The true ranges of the sonars that an emulated robot has besides left, right and front, by name, `range_rear_m`: infinite
    /// where nothing is within reach, not a number without such a sonar in the rig.
    pub fn other_ranges(&self) -> impl Iterator<Item = (String, f64)> {
        let names = self.sim.mega().map(|mega| mega.firmware().other_sonars());
        let ranges_m = self.sim.truth().range_m.into_iter().skip(SONARS.len());
        let named = names.unwrap_or_default().iter().zip(ranges_m);
        named.map(|(name, range_m)| (format!("range_{name}_m"), range_m.unwrap_or(f64::NAN)))
    }

    /// What is true by its name: one of [`TRUE`] or of the other ranges.
    pub fn true_value(&self, name: &str) -> Option<f64> {
        let column = TRUE.iter().position(|own| *own == name);
        let other = || self.other_ranges().find(|(own, _)| own == name);
        column
            .map(|column| self.true_values()[column])
            .or_else(|| other().map(|(_, range_m)| range_m))
    }

    /// Ground truth now: see [`TRUE`].
    pub fn true_values(&self) -> [f64; TRUE.len()] {
        self.pilot.true_values(&self.sim)
    }
}
