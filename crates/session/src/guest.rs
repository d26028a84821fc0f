//! A procedure that drives the robot for a while, such as a calibration, as a guest on the session's link.
//!
//! It sends commands of its own; the session forwards the received bytes to it and its bytes to the robot, and goes on
//! displaying and recording.

use crate::error::CalibrationError;
use rumbo_log::Findings;
use std::fmt::Debug;

/// A calibration in progress. Dropped when the session takes the link back.
pub trait Guest: Debug {
    /// It is this instant \[us\], and these bytes have arrived from the robot. Appends those to send; returns what it
    /// found, or why nothing, when it has ended: the parameters found are then set.
    fn advance(
        &mut self,
        now_us: u64,
        received: &[u8],
        to_robot: &mut Vec<u8>,
    ) -> Option<Result<Findings, CalibrationError>>;
}
