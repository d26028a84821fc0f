//! The session while a guest on its link calibrates the robot: any command of the operator ends it.

use super::{Ask, Now, Session};
use crate::error::CalibrationError;
use crate::orders::Order;
use rumbo_log::{CalibrationState, Findings, Level};
use rumbo_wire::Command;

impl Session {
    /// Whether a calibration drives the robot: it gets the received bytes, and its own are sent by [`Session::lend`].
    #[must_use]
    pub fn calibrating(&self) -> bool {
        self.calibrating.is_some()
    }

    /// Whether a calibration can begin.
    pub(super) fn may_calibrate(&mut self, now: Now) -> Option<Ask> {
        let trouble = if self.calibrating() {
            CalibrationError::Running
        } else if !self.client.connected() {
            CalibrationError::NoAnswer
        } else if self.client.speaks_text() || !self.client.table_matches() {
            CalibrationError::OtherParameters
        } else if self.observer.status().armed {
            CalibrationError::Armed
        } else {
            return Some(Ask::Calibrate);
        };
        self.calibration_begun(Err(trouble), now);
        None
    }

    /// A calibration has started, or why not.
    pub fn calibration_begun(&mut self, begun: Result<(), CalibrationError>, now: Now) {
        if let Err(why) = begun {
            return self.note(Level::Warning, format!("calibration: refused, {why}"), now);
        }
        self.calibrating = Some(now.target_us);
        let since_s = now.target_us as f64 / 1e6;
        self.calibration = Some(CalibrationState::Running { since_s });
        let text = "calibration: the robot drives by itself";
        self.note(Level::Info, text.into(), now);
    }

    /// Sends the guest's bytes to the robot.
    pub fn lend(&mut self, bytes: &[u8], now: Now) {
        self.send(bytes, now);
    }

    /// Ends a calibration that runs: notes its findings, or why there are none, and reads the robot's parameters.
    pub fn calibration_ended(&mut self, found: Result<Findings, CalibrationError>, now: Now) {
        let Some(since_us) = self.calibrating.take() else {
            return;
        };
        let at_s = now.target_us as f64 / 1e6;
        self.calibration = Some(match found {
            Ok(findings) => {
                let passed_s = (now.target_us - since_us) as f64 / 1e6;
                let text = format!("calibration: done in {passed_s:.0} s, the parameters are set");
                self.note(Level::Good, text, now);
                CalibrationState::Done { findings, at_s }
            }
            Err(why) => {
                let why = why.to_string();
                self.note(Level::Warning, format!("calibration: given up, {why}"), now);
                CalibrationState::Failed { why, at_s }
            }
        });
        self.client.read_parameters();
    }

    /// Whether an order is for the robot, and a calibration in its way. One that stops the robot ends the calibration.
    pub(super) fn is_taken(&mut self, order: &Order, now: Now) -> bool {
        if !self.calibrating() {
            return false;
        }
        match order {
            Order::Robot(Command::Stop | Command::Disarm) | Order::Reset(_) => {
                self.calibration_ended(Err(CalibrationError::Stopped), now);
                false
            }
            Order::Robot(_) | Order::Hold(_) | Order::Route(_) => {
                let text = "refused, the robot calibrates itself; STOP ends that";
                self.note(Level::Warning, text.into(), now);
                true
            }
            _ => false,
        }
    }
}
