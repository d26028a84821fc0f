//! Where the servo points: to and fro, and more to where something is near.

use super::detour::following;
use super::{Look, Phase, ServoAngle, Side, State};
use crate::estimate::Estimate;
use crate::math::wrap_angle;
use crate::types::{Range, SonarId};

/// The servo looks this far to each side on the way, and while sweeping [rad].
const SWING_RAD: f32 = 0.75;
pub(super) const SWEEP_RAD: f32 = 1.5;
/// To the side where something is near, and to the other [rad].
const WIDE_RAD: f32 = 1.0;
const NARROW_RAD: f32 = 0.35;
/// Near is what a sonar at the side sees within this [m].
const NEAR_M: f32 = 0.3;
/// A heading error beyond this is a turn [rad].
const TURNS_RAD: f32 = 0.2;

/// How far to the right and to the left the servo swings: mostly to where something is near, or where the robot turns to.
fn swing(state: &State, estimate: &Estimate) -> (f32, f32) {
    let near =
        |sonar| matches!(estimate.range(sonar).range, Range::Valid(range_m) if range_m < NEAR_M);
    let (mut right, mut left) = (near(SonarId::Right), near(SonarId::Left));
    let error_rad = wrap_angle(state.heading_ref_rad - estimate.pose.heading_rad);
    if following(state.phase) {
        match state.detour.map(|detour| detour.side) {
            Some(Side::Left) => right = true,
            Some(Side::Right) => left = true,
            None => {}
        }
    }
    left |= error_rad > TURNS_RAD;
    right |= error_rad < -TURNS_RAD;
    match (right, left) {
        (true, false) => (-WIDE_RAD, NARROW_RAD),
        (false, true) => (-NARROW_RAD, WIDE_RAD),
        _ => (-SWING_RAD, SWING_RAD),
    }
}

/// Where the servo points: to and fro.
pub(super) fn look(state: &mut State, estimate: &Estimate) -> Look {
    let (right_rad, left_rad) = match state.phase {
        Phase::SweepRight => {
            state.servo_left = false;
            (-SWEEP_RAD, 0.0)
        }
        Phase::SweepLeft => {
            state.servo_left = true;
            (0.0, SWEEP_RAD)
        }
        _ => swing(state, estimate),
    };
    if estimate.servo_rad >= left_rad {
        state.servo_left = false;
    } else if estimate.servo_rad <= right_rad {
        state.servo_left = true;
    }
    let servo = if state.servo_left {
        left_rad
    } else {
        right_rad
    };
    Look {
        servo: ServoAngle(servo),
        ..Look::default()
    }
}
