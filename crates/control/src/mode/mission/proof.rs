//! The proof of a front sonar in doubt: the robot stops and turns it to a face that must answer.
//!
//! A sonar that always reports "nothing in reach" looks like free floor. So it is in doubt where known faces do not
//! answer ([`super::landmarks`]), where something has been near beside the robot for a while without an echo, and after
//! a long way without one ([`super::watch`]). The servo looks there first, and if nothing answers, the robot turns to
//! face it. Any echo ends the doubt.
//!
//! | stage | does | leaves when | to |
//! |---|---|---|---|
//! | look | stands, the servo looks there and to both sides | nothing answers in [`DIRECTIONS`] | turn |
//! | turn | turns on the spot until it faces that | it stands | face |
//! | face | stands, the servo looks ahead and to both sides | nothing answers in [`DIRECTIONS`] | deaf: a fault |

use super::gaze::Swing;
use super::watch::far_wall;
use super::{Drive, Mission, SWEEP_RAD, State};
use crate::estimate::Estimate;
use crate::math::{abs, atan2, clamp, wrap_angle};
use crate::motion::TurnState;
use crate::types::{Fault, Range, SonarId};

/// Directions in which nothing answers, after which a stage is over.
const DIRECTIONS: u8 = 5;
/// The servo looks this far to both sides of what must answer [rad].
const AROUND_RAD: f32 = 0.76;
/// It faces what is so near to ahead [rad].
const FACING_RAD: f32 = 0.2;

/// What is remembered must answer within this [m].
const REMEMBERED_M: f32 = 1.5;

#[derive(Clone, Copy, Debug, PartialEq)]
enum Stage {
    Look,
    Turn,
    Face,
}

/// A proof under way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Proof {
    stage: Stage,
    /// Direction of what must answer [rad].
    towards_rad: f32,
    /// How near a sonar at the side has it [m].
    range_m: f32,
}

impl Proof {
    /// Where the servo looks.
    pub(super) fn swing(&self, estimate: &Estimate, swing: &Swing) -> Swing {
        let middle_rad = wrap_angle(self.towards_rad - estimate.pose.heading_rad);
        Swing {
            right_rad: clamp(middle_rad - AROUND_RAD, -SWEEP_RAD, SWEEP_RAD),
            left_rad: clamp(middle_rad + AROUND_RAD, -SWEEP_RAD, SWEEP_RAD),
            proves: false,
            ..*swing
        }
    }

    /// A nearer echo of a side sonar becomes the face that must answer.
    fn ingest(&mut self, estimate: &Estimate) {
        let Some(reading) = &estimate.reading else {
            return;
        };
        match reading.range {
            Range::Valid(range_m) if reading.sonar != SonarId::Front && range_m < self.range_m => {
                self.range_m = range_m;
                self.towards_rad = wrap_angle(estimate.pose.heading_rad + reading.view.axis_rad);
            }
            _ => {}
        }
    }
}

impl Mission<'_> {
    /// Gives way, continues a proof, or starts one where the sonar is in doubt; none if the robot may drive.
    ///
    /// # Errors
    /// The front sonar is deaf.
    pub(super) fn prove(
        &self,
        state: &mut State,
        estimate: &Estimate,
    ) -> Result<Option<Drive>, Fault> {
        let waited = state.movement.waits();
        if let Some(drive) = self.give_way(state, estimate) {
            return Ok(Some(drive));
        }
        if waited {
            // What it was going around, or what should answer, may have gone.
            (state.detour, state.proof) = (None, None);
        }
        if !state.watch.suspects() {
            let proved = state.proof.take();
            proved.inspect(|_| state.watch.landmarks.trust());
            return Ok(None);
        }
        let Some(mut proof) = state.proof.or_else(|| begin(state, estimate)) else {
            state.watch.postpone();
            return Ok(None);
        };
        if proof.stage == Stage::Turn {
            proof.ingest(estimate);
        }
        let silent = state.watch.unanswered() >= DIRECTIONS;
        let mut drive = Drive::Release;
        match proof.stage {
            Stage::Look if silent => {
                state.turn = TurnState::default();
                proof.stage = Stage::Turn;
                // The robot has rolled on: the side sonars update the direction while it turns.
                proof.range_m = f32::MAX;
            }
            Stage::Turn => {
                let step = self.turn_on_the_spot(state, estimate, proof.towards_rad);
                drive = step.drive;
                if step.done {
                    // The face may meanwhile be located elsewhere.
                    state.turn = TurnState::default();
                    if abs(wrap_angle(proof.towards_rad - estimate.pose.heading_rad)) < FACING_RAD {
                        state.gaze.turn_to(0.0);
                        state.watch.ask();
                        proof.stage = Stage::Face;
                    }
                }
            }
            Stage::Face if silent && state.movement.is_lively() => {
                // What should answer may have gone.
                state.proof = None;
                state.watch.postpone();
                state.watch.landmarks.distrust();
                return Ok(None);
            }
            Stage::Face if silent => return Err(Fault::SonarFaulty),
            Stage::Look | Stage::Face => {}
        }
        state.proof = Some(proof);
        Ok(Some(drive))
    }
}

/// A proof by what is near beside the robot, or else by the face that answered last, what is remembered, or a wall that
/// a sonar at the side sees farther away; none where there is nothing.
fn begin(state: &mut State, estimate: &Estimate) -> Option<Proof> {
    let known = state.watch.towards(estimate);
    let (towards_rad, range_m) = known
        .or_else(|| remembered(state, estimate))
        .or_else(|| far_wall(estimate))?;
    let servo_rad = wrap_angle(towards_rad - estimate.pose.heading_rad);
    state.gaze.turn_to(clamp(servo_rad, -SWEEP_RAD, SWEEP_RAD));
    state.watch.ask();
    Some(Proof {
        stage: Stage::Look,
        towards_rad,
        range_m,
    })
}

/// Direction and distance of the nearest point that is remembered, if it is not far [rad, m].
fn remembered(state: &State, estimate: &Estimate) -> Option<(f32, f32)> {
    let pose = &estimate.pose;
    let (number, range_m) = state.echoes.nearest(pose.x_m, pose.y_m, None)?;
    let (x_m, y_m) = state.echoes.get(number)?.metres();
    (range_m < REMEMBERED_M).then_some((atan2(y_m - pose.y_m, x_m - pose.x_m), range_m))
}
