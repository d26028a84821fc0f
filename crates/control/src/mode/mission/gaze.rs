//! The servo's scan: from direction to direction, two readings in each, and more where something is near.
//!
//! Two readings in the same direction distinguish a faulty sonar from a working one ([`super::watch`]). A sonar that
//! has been silent for a while is turned to a face that must answer ([`super::landmarks`]).

use super::watch::{Watch, Worth};
use super::{Look, Phase, SWEEP_RAD, ServoAngle, Side, State};
use crate::estimate::Estimate;
use crate::math::{abs, clamp, wrap_angle};
use crate::types::{Range, SonarId, SonarReading};

/// The servo looks this far to each side on the way [rad].
const SWING_RAD: f32 = 0.76;
/// On the way where things move [rad].
const LIVELY_RAD: f32 = 1.14;
/// To the side where something is near, and to the other [rad].
const WIDE_RAD: f32 = 1.0;
const NARROW_RAD: f32 = 0.35;
/// From direction to direction [rad]: as far as the servo turns in the 60 ms between two pings, a little more than half
/// a beam.
const STEP_RAD: f32 = 0.38;
/// Looks in each direction, one in a sweep, and the most where they contradict each other.
pub(super) const LOOKS: u8 = 2;
const MOST_LOOKS: u8 = 8;
/// Looks in each direction while the robot gives way: so many show that something approaches.
const LOOKS_AT_MOVING: u8 = 3;
/// Directions between two proofs that the sonar works: the way ahead is scanned in between.
const BETWEEN_PROOFS: u8 = 3;
/// The servo is on target within this [rad].
const THERE_RAD: f32 = 0.03;
/// Near is what a sonar at the side sees within this [m].
const NEAR_M: f32 = 0.3;
/// A heading error beyond this is a turn [rad].
const TURNS_RAD: f32 = 0.2;

/// Between which directions the servo swings.
#[derive(Clone, Copy, Debug)]
pub(super) struct Swing {
    pub right_rad: f32,
    pub left_rad: f32,
    /// Looks in each direction.
    pub looks: u8,
    /// It is turned elsewhere now and then, to what must answer.
    pub proves: bool,
    /// How far ahead the front sonar sits [m].
    pub front_m: f32,
}

/// Where the servo points, and where it goes next.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Gaze {
    target_rad: f32,
    /// Looks at the target so far.
    looks: u8,
    /// The last look contradicted the one before.
    wild: bool,
    to_left: bool,
    /// Directions since the last proof that the sonar works.
    since_proof: u8,
}

impl Gaze {
    /// An answer of the front sonar.
    pub(super) fn count(&mut self, reading: &SonarReading, worth: Worth) {
        if abs(reading.servo_rad - self.target_rad) < THERE_RAD {
            self.looks = self.looks.saturating_add(1);
            self.wild = worth == Worth::Wild;
        }
    }

    /// Enough looks at the target: `looks` of them, and more while they contradict each other or what they see may
    /// approach.
    fn is_done(&self, looks: u8, watch: &Watch) -> bool {
        let most = self.wild || watch.looks_again();
        self.looks >= if most { MOST_LOOKS } else { looks }
    }

    /// It has looked beyond this direction; positive is left.
    pub(super) fn has_seen(&self, angle_rad: f32) -> bool {
        let beyond = if angle_rad < 0.0 {
            self.target_rad <= angle_rad
        } else {
            self.target_rad >= angle_rad
        };
        beyond && self.looks > 0
    }

    /// On to the next direction, if there were so many looks at this one; after two looks the sonar may be put to the
    /// proof.
    pub(super) fn step(&mut self, watch: &Watch, estimate: &Estimate, swing: &Swing) {
        if !self.is_done(swing.looks, watch) {
            return;
        }
        let proof = if !swing.proves || self.since_proof < BETWEEN_PROOFS {
            None
        } else {
            watch.look(estimate, swing.front_m)
        };
        match proof {
            Some(servo_rad) => self.turn_to(servo_rad),
            None => self.advance(swing.right_rad, swing.left_rad),
        }
    }

    /// Where it points [rad].
    pub(super) fn servo(&self) -> ServoAngle {
        ServoAngle(self.target_rad)
    }

    /// To a direction in which the sonar must have an echo.
    pub(super) fn turn_to(&mut self, servo_rad: f32) {
        (self.target_rad, self.looks, self.since_proof) = (servo_rad, 0, 0);
    }

    /// On to the next direction between two ends.
    fn advance(&mut self, right_rad: f32, left_rad: f32) {
        self.looks = 0;
        self.since_proof = self.since_proof.saturating_add(1);
        if self.target_rad >= left_rad {
            self.to_left = false;
        } else if self.target_rad <= right_rad {
            self.to_left = true;
        }
        let step_rad = if self.to_left { STEP_RAD } else { -STEP_RAD };
        self.target_rad = clamp(self.target_rad + step_rad, right_rad, left_rad);
    }
}

/// How far to the right and to the left the servo swings: mostly to where something is near, or where the robot turns
/// to.
fn swing(state: &State, estimate: &Estimate) -> (f32, f32) {
    let near =
        |sonar| matches!(estimate.range(sonar).range, Range::Valid(range_m) if range_m < NEAR_M);
    let (mut right, mut left) = (near(SonarId::Right), near(SonarId::Left));
    let error_rad = wrap_angle(state.heading_ref_rad - estimate.pose.heading_rad);
    if state.phase.is_around() {
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
        _ if state.movement.is_lively() => (-LIVELY_RAD, LIVELY_RAD),
        _ => (-SWING_RAD, SWING_RAD),
    }
}

/// Where the servo points.
pub(super) fn look(state: &mut State, estimate: &Estimate, front_m: f32) -> Look {
    let gives_way = state.movement.gives_way();
    let (right_rad, left_rad) = match state.phase {
        Phase::SweepRight if !gives_way => {
            state.gaze.to_left = false;
            (-SWEEP_RAD, 0.0)
        }
        Phase::SweepLeft if !gives_way => {
            state.gaze.to_left = true;
            (0.0, SWEEP_RAD)
        }
        Phase::Decide if !gives_way => {
            let middle_rad = state.plan.obstacle.as_ref().map_or(0.0, |obstacle| {
                let middle_rad = 0.5 * (obstacle.left.pass_rad + obstacle.right.pass_rad);
                wrap_angle(middle_rad - estimate.pose.heading_rad)
            });
            let off_rad = clamp(middle_rad, -SWEEP_RAD, SWEEP_RAD);
            (off_rad, off_rad)
        }
        _ => state
            .movement
            .swing(state.phase.is_around())
            .unwrap_or_else(|| swing(state, estimate)),
    };
    let sweeps = state.sweeps() && !gives_way;
    let swing = Swing {
        right_rad,
        left_rad,
        looks: match sweeps && state.watch.landmarks.is_alive() {
            true => 1,
            false if gives_way => LOOKS_AT_MOVING,
            false => LOOKS,
        },
        proves: !sweeps && !state.movement.is_passing(),
        front_m,
    };
    let swing = match &state.proof {
        Some(proof) => proof.swing(estimate, &swing),
        None => swing,
    };
    state.gaze.step(&state.watch, estimate, &swing);
    Look {
        servo: state.gaze.servo(),
        ..Look::default()
    }
}
