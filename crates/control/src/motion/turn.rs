//! A turn on the spot to a heading.
//!
//! ```text
//! |rate| = min(cruise, sqrt(2 a (|e| - rate measured * lag))), at least the slowest steady rate       e = heading wanted - heading, shorter way round
//! forward = -k (way that the middle has rolled since the start)               holds the wheels together
//! ```
//!
//! The wheels only coast down, so `a` is a deceleration that friction gives on any floor. The last bit is left to friction alone: the
//! wheels are released when they would coast as far as is missing. What is then still missing beyond the tolerance, a second small turn
//! corrects.
//!
//! | step | does | leaves when | to |
//! |---|---|---|---|
//! | drive | turns | the rest is what it coasts | coast |
//! | coast | wheels released | both stand, error beyond the tolerance, fewer than four tries | drive |
//! | | | both stand, else | done |

use super::RELEASE_DELAY_S;
use crate::estimate::Estimate;
use crate::math::{abs, clamp, max, min, sqrt, wrap_angle};
use crate::params::{ParamId, Params};
use crate::types::Drive;

/// Speed of the wheels' contact points below which they do not turn steadily [m/s].
const CREEP_M_S: f32 = 0.03;
/// Speed per way that the middle has moved [1/s].
const HOLD_PLACE: f32 = 6.0;
/// Most of the wheels' speed that holding the place may take.
const HOLD_SHARE: f32 = 0.4;
/// Turns before the heading is taken as it is.
const MOST_TRIES: u8 = 4;

/// Configuration of a turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    /// Largest yaw rate [rad/s].
    pub rate_rad_s: f32,
    /// Planned deceleration [rad/s^2].
    pub brake_rad_s2: f32,
    /// Time by which the wheels follow late [s].
    pub lag_s: f32,
    /// Deceleration of the released wheels at creeping speed [rad/s^2].
    pub coast_rad_s2: f32,
    /// Error that is good enough [rad].
    pub tolerance_rad: f32,
    /// Slowest steady yaw rate [rad/s].
    pub creep_rad_s: f32,
    /// Half the distance between the wheels [m].
    pub half_base_m: f32,
}

/// Memory of a turn; the default is its start.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TurnState {
    coasting: bool,
    tries: u8,
    /// Way that the middle has rolled since the start [m].
    rolled_m: f32,
}

/// What a turn asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TurnStep {
    /// Of the wheels.
    pub drive: Drive,
    /// The robot stands and faces the heading.
    pub done: bool,
}

impl Turn {
    /// From the parameters.
    pub fn new(params: &Params) -> Self {
        let half_base_m = 0.5 * params.get(ParamId::Base);
        Self {
            rate_rad_s: params.get(ParamId::TurnRate),
            brake_rad_s2: params.get(ParamId::TurnBrake),
            lag_s: params.get(ParamId::SpeedLag),
            coast_rad_s2: params.get(ParamId::TurnCoast),
            tolerance_rad: params.get(ParamId::TurnTolerance),
            creep_rad_s: CREEP_M_S / half_base_m,
            half_base_m,
        }
    }

    /// One tick towards `heading_rad`, which may change on the way.
    pub fn step(&self, state: &mut TurnState, estimate: &Estimate, heading_rad: f32) -> TurnStep {
        let error_rad = wrap_angle(heading_rad - estimate.pose.heading_rad);
        state.rolled_m += estimate.rolled_m;
        if state.coasting && estimate.standing() {
            if abs(error_rad) <= self.tolerance_rad || state.tries >= MOST_TRIES {
                return TurnStep {
                    drive: Drive::Release,
                    done: true,
                };
            }
            state.coasting = false;
        }
        if !state.coasting && self.coasts_there(error_rad, estimate.yaw_rad_s) {
            state.coasting = true;
            state.tries = state.tries.saturating_add(1);
        }
        let drive = if state.coasting {
            Drive::Release
        } else {
            self.drive(state.rolled_m, error_rad, estimate.yaw_rad_s)
        };
        TurnStep { drive, done: false }
    }

    /// Whether the released wheels would roll as far as is missing, or it is near enough, or too far already.
    fn coasts_there(&self, error_rad: f32, yaw_rad_s: f32) -> bool {
        let towards_rad_s = if error_rad < 0.0 {
            -yaw_rad_s
        } else {
            yaw_rad_s
        };
        // Turning away from it: the robot was pushed, or has just overshot.
        if towards_rad_s < -0.5 * self.creep_rad_s {
            return true;
        }
        let coast_rad = towards_rad_s * towards_rad_s / (2.0 * self.coast_rad_s2)
            + max(towards_rad_s, 0.0) * RELEASE_DELAY_S;
        abs(error_rad) <= max(coast_rad, 0.5 * self.tolerance_rad)
    }

    fn drive(&self, rolled_m: f32, error_rad: f32, yaw_rad_s: f32) -> Drive {
        let late_rad = self.lag_s * abs(yaw_rad_s);
        let braking = sqrt(2.0 * self.brake_rad_s2 * (abs(error_rad) - late_rad));
        let rate_rad_s = max(min(self.rate_rad_s, braking), self.creep_rad_s);
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

    /// A robot that faces `heading_rad` and turns at `yaw_rad_s`; it stands when that is 0.
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
    fn the_planned_rate_can_be_braked_before_the_heading() {
        let turn = Turn::new(&Params::default());
        for milliradians in 30..2_000u16 {
            let error_rad = f32::from(milliradians) * 1e-3;
            let drive = turn.drive(0.0, error_rad, turn.creep_rad_s);
            let rate = yaw_rad_s(drive);
            assert!(
                rate <= turn.creep_rad_s || rate * rate / (2.0 * turn.brake_rad_s2) <= error_rad,
                "{rate} rad/s at {error_rad} rad"
            );
        }
    }

    #[test]
    fn the_wheels_are_released_when_they_would_coast_there() {
        let turn = Turn::new(&Params::default());
        let coast_rad = 1.0 / (2.0 * turn.coast_rad_s2);
        let mut state = TurnState::default();
        let before = step(&mut state, &facing(0.0, 1.0), coast_rad + 0.05);
        assert!(yaw_rad_s(before.drive) > 0.0);
        let after = step(&mut state, &facing(0.05, 1.0), coast_rad + 0.05);
        assert_eq!((after.drive, after.done), (Drive::Release, false));
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
        assert_eq!(drives, i32::from(MOST_TRIES));
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
