//! The session while a scenario commands the robot: it listens, and any order that stops the robot gives it the link again.

use super::{Going, Now, Session};
use crate::error::TargetError;
use crate::orders::Order;
use crate::target::About;
use rumbo_log::{ExperimentPhase, Level};
use rumbo_wire::Command;

impl Session {
    /// The target was started again, commanded by its scenario, or why not. `id` is to be random.
    pub fn play_begun(&mut self, done: Result<About, TargetError>, id: u8, now: Now) {
        let about = match done {
            Ok(about) => about,
            Err(why) => {
                return self.note(Level::Warning, format!("experiment: refused, {why}"), now);
            }
        };
        let parameters = about.parameters;
        self.begin_run(about, id);
        (self.playing, self.briefed) = (true, true);
        if let Some(parameters) = parameters {
            self.observer.know_parameters(&parameters);
        }
        let text = "experiment: the scenario commands the robot; STOP ends it";
        self.note(Level::Info, text.into(), now);
    }

    /// The scenario commands the robot.
    pub(crate) fn is_playing(&self) -> bool {
        self.playing
    }

    /// Whether an order is for the robot, and a scenario in its way. One that stops the robot ends the experiment.
    pub(super) fn is_played(&mut self, order: &Order, now: Now) -> bool {
        if !self.playing {
            return false;
        }
        match order {
            Order::Robot(Command::Stop | Command::Disarm) => {
                self.playing = false;
                let text = "experiment: stopped, without a verdict";
                self.note(Level::Warning, text.into(), now);
                false
            }
            Order::Robot(_)
            | Order::Hold(_)
            | Order::Velocity(_)
            | Order::Route(_)
            | Order::Type(..)
            | Order::Calibrate => {
                let text = "refused, the experiment runs; STOP ends it";
                self.note(Level::Warning, text.into(), now);
                true
            }
            _ => false,
        }
    }

    /// Says how an experiment ended, and switches the robot off.
    pub(super) fn watch_play(&mut self, going: &Going, now: Now) {
        let phase = going.experiment.as_ref().map(|experiment| experiment.phase);
        let (level, text) = match phase {
            Some(ExperimentPhase::Passed) if self.playing => {
                (Level::Good, "experiment: over, within its limits")
            }
            Some(ExperimentPhase::Failed) if self.playing => {
                (Level::Warning, "experiment: over, not within its limits")
            }
            _ => return,
        };
        self.playing = false;
        self.note(level, text.into(), now);
        self.command(Command::Disarm, now);
    }
}
