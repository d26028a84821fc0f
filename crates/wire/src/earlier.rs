//! Converts frames of protocol 2, found in older logs, to the present protocol.
//!
//! Version 3 added the robot's time to statuses and the time of issue to timed commands; both are unknown in an earlier
//! log and read 0.

use crate::codec::Message;
use crate::frame::{Body, Frame, Kind, MAX_PAYLOAD};
use crate::message::ToRobot;

/// The version before.
pub const EARLIER_VERSION: u8 = 2;

/// Bytes of a [`RobotTime`](crate::RobotTime): its start and its milliseconds.
const TIME: usize = 1 + 4;

/// The frame for what is in a frame of protocol 2, given without its 0x00; `None` if it is no such frame.
pub fn renewed(stuffed: &[u8]) -> Option<Frame> {
    let body = Body::parse_of(EARLIER_VERSION, stuffed)?;
    let payload = body.payload();
    let timed = match body.kind {
        Kind::Status => true,
        // A command that lacks its time is too short, and no other is.
        Kind::Command => ToRobot::from_body(&body).is_err(),
        _ => false,
    };
    let len = payload.len() + if timed { TIME } else { 0 };
    let mut longer = [0; MAX_PAYLOAD];
    longer.get_mut(..payload.len())?.copy_from_slice(payload);
    Some(Frame::new(body.kind, body.seq, longer.get(..len)?))
}
