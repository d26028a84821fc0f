//! The session while a guest on its link calibrates the robot: any command of the operator ends it.

use super::{Ask, Now, Session};
use crate::error::CalibrationError;
use crate::guest::Guest;
use crate::orders::Order;
use rumbo_log::{CalibrationPhase, CalibrationState, Findings, Level};
use rumbo_wire::Command;

impl Session {
    /// Whether a calibration can begin.
    pub(super) fn may_calibrate(&mut self, now: Now) -> Option<Ask> {
        let trouble = if self.calibrating.is_some() {
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

    /// A calibration starts, or why not. It gets the received bytes, and drives the robot by its own.
    pub fn calibration_begun(&mut self, begun: Result<Box<dyn Guest>, CalibrationError>, now: Now) {
        let guest = match begun {
            Ok(guest) => guest,
            Err(why) => {
                self.note(Level::Warning, format!("calibration: refused, {why}"), now);
                if self.calibrating.is_none() {
                    let why = format!("it was refused: {why}");
                    self.calibrations += 1;
                    self.show_calibration(CalibrationPhase::Failed { why });
                }
                return;
            }
        };
        self.calibrating = Some((guest, now.target_us));
        self.calibrations += 1;
        let since_s = now.target_us as f64 / 1e6;
        self.show_calibration(CalibrationPhase::Running { since_s });
        let text = "calibration: the robot drives by itself";
        self.note(Level::Info, text.into(), now);
    }

    /// The guest's turn, with the bytes just received.
    pub(super) fn advance_guest(&mut self, received: &[u8], now: Now) {
        let Some((guest, _)) = &mut self.calibrating else {
            return;
        };
        let mut to_robot = Vec::new();
        let found = guest.advance(now.target_us, received, &mut to_robot);
        self.send(&to_robot, now);
        if let Some(found) = found {
            self.calibration_ended(found, now);
        }
    }

    /// Ends a calibration that runs: notes its findings, or why there are none, and reads the robot's parameters.
    pub(super) fn calibration_ended(
        &mut self,
        found: Result<Findings, CalibrationError>,
        now: Now,
    ) {
        let Some((_, since_us)) = self.calibrating.take() else {
            return;
        };
        let phase = match found {
            Ok(findings) => {
                let passed_s = (now.target_us - since_us) as f64 / 1e6;
                let text = format!("calibration: done in {passed_s:.0} s, the parameters are set");
                self.note(Level::Good, text, now);
                CalibrationPhase::Done { findings }
            }
            Err(why) => {
                let why = why.to_string();
                self.note(Level::Warning, format!("calibration: given up, {why}"), now);
                CalibrationPhase::Failed { why }
            }
        };
        self.show_calibration(phase);
        self.client.read_parameters();
    }

    fn show_calibration(&mut self, phase: CalibrationPhase) {
        let number = self.calibrations;
        self.calibration = Some(CalibrationState { number, phase });
    }

    /// Whether an order is for the robot, and a calibration in its way. One that stops the robot ends the calibration.
    pub(super) fn is_taken(&mut self, order: &Order, now: Now) -> bool {
        if self.calibrating.is_none() {
            return false;
        }
        match order {
            Order::Robot(Command::Stop | Command::Disarm) | Order::Reset(_) => {
                self.calibration_ended(Err(CalibrationError::Stopped), now);
                false
            }
            Order::Robot(_) | Order::Hold(_) | Order::Velocity(_) | Order::Route(_) => {
                let text = "refused, the robot calibrates itself; STOP ends that";
                self.note(Level::Warning, text.into(), now);
                true
            }
            _ => false,
        }
    }
}
