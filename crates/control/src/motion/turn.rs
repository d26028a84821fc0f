//! A turn on the spot to a heading.
//!
//! ```text
//! |rate| = min(cruise, sqrt(2 a (|e| - rate measured * lag))), at least the slowest steady rate    e = setpoint - heading, wrapped
//! forward = -k (distance that the midpoint has rolled since the start)          keeps the turn on the spot
//! ```
//!
//! The rate falls as [`stop`](super::stop) plans; a remainder beyond the tolerance is corrected by a second small turn.

use super::{CREEP_M_S, Stop, StopState, Stopping};
use crate::estimate::Estimate;
use crate::math::{abs, clamp, max, min, wrap_angle};
use crate::params::{ParamId, Params};
use crate::types::Drive;

/// Speed per distance that the midpoint has moved [1/s].
const HOLD_PLACE: f32 = 6.0;
/// Largest share of the wheels' speed for holding the position.
const HOLD_SHARE: f32 = 0.4;

/// Configuration of a turn.
#[derive(Clone, Copy, Debug)]
pub struct Turn<'a> {
    /// Largest yaw rate [rad/s].
    pub rate_rad_s: f32,
    /// How it comes to rest [rad].
    stop: Stop<'a>,
    /// Half the distance between the wheels [m].
    pub half_base_m: f32,
}

/// State of a turn; the default is its start.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TurnState {
    stop: StopState,
    /// Distance that the midpoint has rolled since the start [m].
    rolled_m: f32,
}

/// Request of a turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TurnStep {
    /// Of the wheels.
    pub drive: Drive,
    /// The robot stands and faces the heading.
    pub done: bool,
}

impl<'a> Turn<'a> {
    /// From the parameters.
    pub fn new(params: &'a Params) -> Self {
        Self {
            rate_rad_s: params.get(ParamId::TurnRate),
            stop: Stop::of_a_turn(params),
            half_base_m: 0.5 * params.get(ParamId::Base),
        }
    }

    /// Slowest steady yaw rate [rad/s].
    fn creep_rad_s(&self) -> f32 {
        CREEP_M_S / self.half_base_m
    }

    /// One tick towards `heading_rad`, which may change on the way.
    pub fn step(&self, state: &mut TurnState, estimate: &Estimate, heading_rad: f32) -> TurnStep {
        let error_rad = wrap_angle(heading_rad - estimate.pose.heading_rad);
        state.rolled_m += estimate.rolled_m;
        let towards_rad_s = if error_rad < 0.0 {
            -estimate.yaw_rad_s
        } else {
            estimate.yaw_rad_s
        };
        // Turning away: the robot has overshot or was pushed, and is released until it stands.
        let creep_rad_s = self.creep_rad_s();
        let left_rad = if towards_rad_s < -0.5 * creep_rad_s {
            0.0
        } else {
            abs(error_rad)
        };
        let standing = estimate.standing();
        let stopping = self
            .stop
            .step(&mut state.stop, left_rad, towards_rad_s, standing);
        let drive = match stopping {
            Stopping::Drive => self.drive(state.rolled_m, error_rad, towards_rad_s),
            Stopping::Coast | Stopping::Done => Drive::Release,
        };
        TurnStep {
            drive,
            done: stopping == Stopping::Done,
        }
    }

    fn drive(&self, rolled_m: f32, error_rad: f32, towards_rad_s: f32) -> Drive {
        let braking_rad_s = self.stop.speed(abs(error_rad), towards_rad_s);
        let rate_rad_s = max(min(self.rate_rad_s, braking_rad_s), self.creep_rad_s());
        let most_m_s = HOLD_SHARE * rate_rad_s * self.half_base_m;
        Drive::Twist {
            forward_m_s: clamp(-HOLD_PLACE * rolled_m, -most_m_s, most_m_s),
            yaw_rad_s: if error_rad < 0.0 {
                -rate_rad_s
            } else {
                rate_rad_s
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::types::Pose;

    /// A robot that faces `heading_rad` and turns at `yaw_rad_s`, or stands when that is 0.
    fn facing(heading_rad: f32, yaw_rad_s: f32) -> Estimate {
        let mut estimate = Estimate {
            pose: Pose {
                heading_rad,
                ..Pose::default()
            },
            yaw_rad_s,
            ..Estimate::default()
        };
        estimate.motion.left.standing = yaw_rad_s == 0.0;
        estimate.motion.right.standing = yaw_rad_s == 0.0;
        estimate
    }

    fn step(state: &mut TurnState, estimate: &Estimate, heading_rad: f32) -> TurnStep {
        Turn::new(&Params::default()).step(state, estimate, heading_rad)
    }

    fn yaw_rad_s(drive: Drive) -> f32 {
        match drive {
            Drive::Twist { yaw_rad_s, .. } => yaw_rad_s,
            _ => 0.0,
        }
    }

    #[test]
    fn it_turns_the_shorter_way_also_across_half_a_turn() {
        let from = |heading_rad, to_rad| {
            let step = step(&mut TurnState::default(), &facing(heading_rad, 0.0), to_rad);
            yaw_rad_s(step.drive)
        };
        assert!(from(0.0, 1.5) > 2.0 && from(0.0, -1.5) < -2.0);
        assert!(from(3.0, -3.0) > 0.5 && from(-3.0, 3.0) < -0.5);
    }

    #[test]
    fn what_is_missing_is_turned_once_more_but_not_for_ever() {
        let mut state = TurnState::default();
        let mut drives = 0;
        for _ in 0..20 {
            // Each try ends as far off as it began.
            if step(&mut state, &facing(0.0, 0.0), 0.1).done {
                break;
            }
            drives += 1;
            step(&mut state, &facing(0.1, 0.6), 0.1);
        }
        assert_eq!(drives, 4);
        let mut state = TurnState::default();
        step(&mut state, &facing(0.1, 0.6), 0.1);
        assert!(step(&mut state, &facing(0.095, 0.0), 0.1).done);
    }

    #[test]
    fn a_middle_that_has_rolled_forward_is_brought_back() {
        let mut state = TurnState::default();
        let mut estimate = facing(0.0, 1.0);
        estimate.rolled_m = 0.004;
        match step(&mut state, &estimate, 1.5).drive {
            Drive::Twist { forward_m_s, .. } => assert!(forward_m_s < -0.01),
            other => panic!("{other:?}"),
        }
    }
}
