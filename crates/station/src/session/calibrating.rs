//! The session while the robot calibrates itself: the guest has its turns, and any command of a person's ends it.

use super::Session;
use crate::guest::Guest;
use crate::orders::Order;
use rumbo_log::{CalibrationState, Level};
use rumbo_wire::Command;

impl Session {
    /// Begins a calibration, if one can be.
    pub(super) fn calibrate(&mut self) {
        let trouble = if self.guest.is_some() {
            Some("one is running already")
        } else if !self.client.connected() {
            Some("no robot answers")
        } else if self.client.speaks_text() || !self.client.table_matches() {
            Some("this robot has other parameters")
        } else if self.observer.status().armed {
            Some("the robot is armed: switch OFF first")
        } else {
            None
        };
        let Some(calibration) = self.extras.calibration else {
            return self.note(
                Level::Warning,
                "calibration: refused, this program has none".into(),
            );
        };
        if let Some(why) = trouble {
            return self.note(Level::Warning, format!("calibration: refused, {why}"));
        }
        let now_us = self.target.now_us();
        match Guest::invite(calibration, now_us) {
            Ok(guest) => {
                let since_s = now_us as f64 / 1e6;
                self.calibration = Some(CalibrationState::Running { since_s });
                self.guest = Some(guest);
                self.note(
                    Level::Info,
                    "calibration: the robot drives by itself".into(),
                );
            }
            Err(why) => self.note(Level::Warning, format!("calibration: refused, {why}")),
        }
    }

    /// The guest's turn, with the bytes at hand.
    pub(super) fn take_turns(&mut self, now_us: u64) -> Result<(), String> {
        let Some(guest) = &self.guest else {
            return Ok(());
        };
        match guest.turn(now_us, &self.bytes) {
            Some(said) if said.is_empty() => Ok(()),
            Some(said) => {
                self.bytes = said;
                self.note_bytes(true);
                self.target.send(&self.bytes)
            }
            None => {
                self.see_off();
                Ok(())
            }
        }
    }

    /// The guest has left: what it found, and the parameters that the robot has now.
    fn see_off(&mut self) {
        let Some(guest) = self.guest.take() else {
            return;
        };
        let passed_s = (self.target.now_us() - guest.since_us) as f64 / 1e6;
        let at_s = self.target.now_us() as f64 / 1e6;
        self.calibration = Some(match guest.findings() {
            Ok(findings) => {
                let text = format!("calibration: done in {passed_s:.0} s, the parameters are set");
                self.note(Level::Good, text);
                CalibrationState::Done { findings, at_s }
            }
            Err(why) => {
                self.note(Level::Warning, format!("calibration: given up, {why}"));
                CalibrationState::Failed { why, at_s }
            }
        });
        self.client.read_parameters();
    }

    /// Ends a calibration that runs.
    pub(super) fn give_up_calibration(&mut self, why: &str) {
        if self.guest.take().is_none() {
            return;
        }
        self.note(Level::Warning, format!("calibration: given up, {why}"));
        let at_s = self.target.now_us() as f64 / 1e6;
        let why = why.to_owned();
        self.calibration = Some(CalibrationState::Failed { why, at_s });
        self.client.read_parameters();
    }

    /// Whether an order is for the robot, and a calibration in its way. One that stops the robot ends the calibration.
    pub(super) fn is_taken(&mut self, order: &Order) -> bool {
        if self.guest.is_none() {
            return false;
        }
        match order {
            Order::Robot(Command::Stop | Command::Disarm) | Order::Reset(_) => {
                self.give_up_calibration("it was stopped");
                false
            }
            Order::Robot(_) | Order::Hold(_) | Order::Route(_) => {
                let text = "refused, the robot calibrates itself; STOP ends that";
                self.note(Level::Warning, text.into());
                true
            }
            _ => false,
        }
    }
}
