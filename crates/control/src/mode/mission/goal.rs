//! Reach a point around obstacles: the states on the straight line to the goal; around an obstacle: `detour.rs`.

use super::detour::{slow_corners, towards};
use super::gaze::look;
use super::moving::{BESIDE_M_S, UNKNOWN_M_S, WARY_M_S};
use super::obstacle::Among;
use super::{
    Action, CREEP_M_S, DOUBT_M_S, Drive, Mission, MotionMemory, PROGRESS_M, ParamId, Phase, Place,
    Pose, SWEEP_RAD, Segment, State, Turn, Way, abs, min, sqrt,
};
use crate::estimate::Estimate;
use crate::math::{atan2, max, wrap_angle};
use crate::motion::{LineState, TurnState, TurnStep};
use crate::types::{Fault, Range, TICK_S};
use core::f32::consts::TAU;

/// An obstacle this near on the way is looked at [m].
const LOOK_M: f32 = 0.62;
/// Something within this of the middle of the axis makes the robot careful [m].
pub(super) const CAREFUL_M: f32 = 0.33;
/// Heading error that halves the speed then [rad].
const CAREFUL_RAD: f32 = 0.2;
/// A robot that stands faces its goal within this [rad].
const FACED_RAD: f32 = 0.1;
/// Until this is left [rad].
const TURNED_RAD: f32 = 0.12;
/// Once around the goal without getting nearer to it, and a little more [rad].
const WOUND_RAD: f32 = TAU + 0.3;
/// Way after an obstacle on which one that was not seen beside the robot may still be there [m].
const PAST_M: f32 = 0.6;
/// Half of the width that must be clear ahead to drive [m].
const AHEAD_M: f32 = 0.1;
/// Front of the robot from the wheels' axis [m].
const FRONT_M: f32 = 0.13;
/// Distance kept ahead [m].
const KEEP_M: f32 = 0.05;
/// Speed during a sweep [m/s].
const SWEEP_M_S: f32 = 0.1;
/// Nearer than this the robot turns slowly on the spot: its corners reach 0.15 m [m].
const TIGHT_M: f32 = 0.155;
/// Yaw rate there [rad/s].
const TIGHT_RAD_S: f32 = 0.55;
/// Yaw rate per distance beyond [rad/s/m].
const TIGHT_SLOPE: f32 = 15.0;

impl Mission<'_> {
    pub(super) fn goal(
        &self,
        state: &mut State,
        estimate: &Estimate,
        goal_m: &(f32, f32),
    ) -> Result<Action, Fault> {
        if state.fresh {
            state.fresh = false;
            state.proof = None;
            state.phase = Phase::Initialise;
        }
        if matches!(state.phase, Phase::Wait | Phase::Unreachable) {
            return Ok(Action {
                state: state.phase as u8,
                heading_ref_rad: state.heading_ref_rad,
                reached: state.phase == Phase::Wait,
                unreachable: state.phase == Phase::Unreachable,
                out_of_time: self.is_out_of_time(state),
                ..Action::default()
            });
        }
        // Around an obstacle its faces beside the robot come and go: they count where other things have moved.
        let around = state.detour.is_some() && !state.movement.is_lively();
        let approach = state.watch.approach.as_ref();
        let approach = approach.filter(|approach| {
            !(around && approach.is_aside() && !approach.is_faster(estimate.rolled_m))
        });
        if state.phase.is_around() && state.watch.nears_aside() {
            state.movement.be_careful();
        }
        state
            .movement
            .step(approach, state.watch.moves, estimate.turned_rad);
        if let (Some(approach), Some(reading)) = (approach, &estimate.reading) {
            let robot = estimate.transform();
            state.echoes.forget(&robot, reading, approach.range_m);
        }
        state.watch.approach = None;
        state.watch.moves = false;
        let (way, left_m) = way_to(&estimate.pose, goal_m);
        count(state, estimate, &way);
        let planned = perceive(state, estimate, &way);
        if self.is_out_of_time(state) {
            state.phase = Phase::Unreachable;
        }
        let proving = state.proof.is_some() || state.movement.waits();
        let drive = match self.prove(state, estimate)? {
            Some(drive) => drive,
            // On from where the robot stands now.
            None if proving && !state.phase.is_around() && !state.sweeps() => {
                self.face(state, &estimate.pose, goal_m, FACED_RAD);
                Drive::Release
            }
            None => self.drive(state, estimate, goal_m, (&way, left_m), planned),
        };
        let drive = if state.watch.is_wild() {
            Drive::Release
        } else {
            drive
        };
        let front_m = self.params.get(ParamId::SonarFrontX);
        let look = look(state, estimate, front_m);
        let arrived = state.phase == Phase::Wait;
        Ok(Action {
            drive,
            look,
            state: state.shown(state.phase as u8),
            heading_ref_rad: state.heading_ref_rad,
            reached: arrived,
            new_origin: arrived && self.moves_origin(),
            ..Action::default()
        })
    }

    fn is_out_of_time(&self, state: &State) -> bool {
        state.age_s > self.params.get(ParamId::MissionGiveUp)
    }

    /// Each goal reached becomes the origin.
    fn moves_origin(&self) -> bool {
        self.params.is_on(ParamId::MissionResetOrigin)
    }

    /// What the state asks for.
    fn drive(
        &self,
        state: &mut State,
        estimate: &Estimate,
        goal_m: &(f32, f32),
        (way, left_m): (&Way, f32),
        planned: bool,
    ) -> Drive {
        let pose = &estimate.pose;
        match state.phase {
            Phase::Wait
            | Phase::Unreachable
            | Phase::StraightOn
            | Phase::Prove
            | Phase::GiveWay => Drive::Release,
            Phase::Initialise => {
                state.age_s = 0.0;
                state.laps = 0;
                state.last = None;
                state.detour = None;
                state.movement = MotionMemory::default();
                self.face(state, pose, goal_m, FACED_RAD);
                Drive::Release
            }
            Phase::InitialTurn => self.turn(state, estimate, way.heading_rad, Phase::GoToGoal),
            Phase::GoToGoal => self.go(state, estimate, goal_m, (way, left_m)),
            Phase::SweepRight | Phase::SweepLeft => self.sweep(state, estimate, left_m),
            Phase::Decide => {
                if state.movement.pauses(estimate) {
                    return Drive::Release;
                }
                // What stood in the way may have gone meanwhile.
                if blocked(state, left_m) {
                    self.decide(state, estimate, goal_m);
                } else {
                    state.phase = Phase::GoToGoal;
                }
                Drive::Release
            }
            Phase::AvoidanceTurn | Phase::Seek | Phase::Along | Phase::SafeDistance => {
                self.around(state, estimate, goal_m, left_m, planned)
            }
        }
    }

    /// Turns to the goal, or drives on where that takes no turn.
    pub(super) fn face(&self, state: &mut State, pose: &Pose, goal_m: &(f32, f32), spot_rad: f32) {
        state.segment = Segment::between((pose.x_m, pose.y_m), *goal_m);
        state.line = LineState::default();
        state.turn = TurnState::default();
        state.heading_ref_rad = state.segment.heading_rad();
        let error_rad = wrap_angle(state.segment.heading_rad() - pose.heading_rad);
        state.phase = if abs(error_rad) > spot_rad {
            Phase::InitialTurn
        } else {
            Phase::GoToGoal
        };
    }

    pub(super) fn turn(
        &self,
        state: &mut State,
        estimate: &Estimate,
        heading_rad: f32,
        next: Phase,
    ) -> Drive {
        let step = self.turn_on_the_spot(state, estimate, heading_rad);
        let error_rad = wrap_angle(heading_rad - estimate.pose.heading_rad);
        if step.done || (next != Phase::GoToGoal && abs(error_rad) < TURNED_RAD) {
            state.phase = next;
        }
        step.drive
    }

    /// One tick of a turn, as fast as what is near allows.
    pub(super) fn turn_on_the_spot(
        &self,
        state: &mut State,
        estimate: &Estimate,
        heading_rad: f32,
    ) -> TurnStep {
        state.heading_ref_rad = heading_rad;
        let mut turn = Turn::new(self.params);
        let rate_rad_s = (min(state.near_m, 1.0) - TIGHT_M) * TIGHT_SLOPE;
        turn.rate_rad_s = min(turn.rate_rad_s, max(rate_rad_s, TIGHT_RAD_S));
        if state.doubts() {
            turn.rate_rad_s = min(turn.rate_rad_s, TIGHT_RAD_S);
        }
        turn.step(&mut state.turn, estimate, heading_rad)
    }

    fn go(
        &self,
        state: &mut State,
        estimate: &Estimate,
        goal_m: &(f32, f32),
        (way, left_m): (&Way, f32),
    ) -> Drive {
        if state
            .detour
            .is_some_and(|detour| left_m < detour.least_m - PROGRESS_M)
        {
            state.last = state.detour.map(|detour| (detour.side, 0.0));
            state.detour = None;
        }
        if state.plan.clear_m < LOOK_M && state.plan.obstacle.is_some() {
            if let Some(detour) = &mut state.detour {
                // The obstacle again, before anything was gained.
                detour.vain = detour.vain.saturating_add(1);
                detour.met = Place::new(way.x_m, way.y_m);
                detour.way_m = 0.0;
                detour.away = false;
                state.phase = Phase::Seek;
            } else {
                state.phase = Phase::SweepRight;
            }
            return Drive::Release;
        }
        let error_rad = wrap_angle(state.heading_ref_rad - estimate.pose.heading_rad);
        let limit_m_s = min(self.free_m_s(state), self.careful_m_s(state, error_rad));
        if limit_m_s < CREEP_M_S && abs(error_rad) > FACED_RAD {
            // What stops it is ahead, and the goal is not.
            self.face(state, &estimate.pose, goal_m, FACED_RAD);
            return Drive::Release;
        }
        let step = self
            .line
            .step(&mut state.line, estimate, &state.segment, limit_m_s);
        state.heading_ref_rad = step.heading_ref_rad;
        // To move the origin takes a third of a tick, which one with a reading does not have.
        if step.done && estimate.standing() && estimate.reading.is_none() {
            state.phase = Phase::Wait;
            if self.moves_origin() {
                let (pose, facing) = (&estimate.pose, estimate.facing);
                state.echoes.move_origin(pose, facing);
                state.watch.landmarks.move_origin(pose, facing);
            }
        }
        if state.doubts() {
            slow_corners(step.drive)
        } else {
            step.drive
        }
    }

    /// Fastest speed from which the robot stops before what is ahead.
    pub(super) fn free_m_s(&self, state: &State) -> f32 {
        let room_m = max(state.gap_m - KEEP_M, 0.0);
        let free_m_s = sqrt(2.0 * self.params.get(ParamId::LineBrake) * room_m);
        if state.doubts() {
            min(free_m_s, DOUBT_M_S)
        } else if state.movement.is_careful() {
            min(free_m_s, BESIDE_M_S)
        } else if state.movement.is_known() {
            let around = state.detour.is_some();
            min(free_m_s, if around { BESIDE_M_S } else { WARY_M_S })
        } else if state.movement.wonders() && state.detour.is_none() {
            min(free_m_s, UNKNOWN_M_S)
        } else {
            free_m_s
        }
    }

    /// Fastest speed with something this near.
    pub(super) fn careful_m_s(&self, state: &State, error_rad: f32) -> f32 {
        if state.near_m < CAREFUL_M {
            self.around_m_s / (1.0 + abs(error_rad) * (1.0 / CAREFUL_RAD))
        } else {
            self.params.get(ParamId::MissionCruise)
        }
    }

    fn sweep(&self, state: &mut State, estimate: &Estimate, left_m: f32) -> Drive {
        match state.phase {
            Phase::SweepRight if state.gaze.has_seen(-SWEEP_RAD) => state.phase = Phase::SweepLeft,
            Phase::SweepLeft if state.gaze.has_seen(SWEEP_RAD) => {
                state.watch.has_swept();
                state.phase = if blocked(state, left_m) {
                    state.movement.pause(estimate.pose.x_m);
                    Phase::Decide
                } else {
                    Phase::GoToGoal
                };
            }
            _ => {}
        }
        let error_rad = wrap_angle(state.segment.heading_rad() - estimate.pose.heading_rad);
        let speed_m_s = min(self.free_m_s(state), SWEEP_M_S);
        if speed_m_s < 0.04 {
            return Drive::Release;
        }
        self.line.steer(speed_m_s, error_rad)
    }
}

/// Something stands in the straight way to a goal so far away.
fn blocked(state: &State, left_m: f32) -> bool {
    state.plan.clear_m < min(left_m, 1.0) && state.plan.obstacle.is_some()
}

/// The straight way to the goal, as far as it is judged, and the distance to the goal [m].
fn way_to(pose: &Pose, goal_m: &(f32, f32)) -> (Way, f32) {
    let (dx, dy) = (goal_m.0 - pose.x_m, goal_m.1 - pose.y_m);
    let left_m = sqrt(dx * dx + dy * dy);
    let way = Way {
        x_m: pose.x_m,
        y_m: pose.y_m,
        heading_rad: atan2(dy, dx),
        facing: if left_m > 0.0 {
            let per_m = 1.0 / left_m;
            (dy * per_m, dx * per_m)
        } else {
            (0.0, 1.0)
        },
        length_m: min(left_m, super::plan::HORIZON_M),
    };
    (way, left_m)
}

/// Time and way go on. Once around the goal, and a little more, is enough.
fn count(state: &mut State, estimate: &Estimate, way: &Way) {
    state.age_s += TICK_S;
    let rolled_m = abs(estimate.rolled_m);
    if let Some((_, way_m)) = &mut state.last {
        *way_m += rolled_m;
    }
    let (beside, more_m) = match (&state.detour, state.last) {
        (Some(detour), _) => (Some(detour.side), rolled_m),
        // The obstacle is still beside the robot.
        (None, Some((side, way_m))) if way_m < PAST_M => (Some(side), 0.0),
        (None, _) => (None, 0.0),
    };
    let sees = |side| matches!(estimate.range(towards(side)).range, Range::Valid(_));
    state.unseen_m = match beside {
        Some(side) if !sees(side) => state.unseen_m + more_m,
        _ => 0.0,
    };
    if let Some(detour) = &mut state.detour {
        detour.way_m += rolled_m;
        // Seen from the goal the robot moves along its own bearing, half a turn off.
        detour.wound_rad += wrap_angle(way.heading_rad - detour.bearing_rad);
        detour.bearing_rad = way.heading_rad;
        if abs(detour.wound_rad) > WOUND_RAD {
            state.phase = Phase::Unreachable;
        }
    }
}

/// Asks the memory: plans, and looks for what is ahead and what is nearest. Says whether a round of the plan has ended.
fn perceive(state: &mut State, estimate: &Estimate, way: &Way) -> bool {
    let pose = &estimate.pose;
    let around = state.detour.as_ref().map(|detour| detour.side);
    let following = state.phase.is_around();
    // Every other tick takes a reading into the memory: the plan is for those between.
    let planned = estimate.reading.is_none()
        && state
            .plan
            .step(&state.echoes, pose, way, around.filter(|_| following));
    // Both read the whole memory: each every other tick, and the longer one where there is no reading to take.
    state.looks_ahead = !state.looks_ahead && estimate.reading.is_none();
    if state.looks_ahead {
        let ahead = Way {
            heading_rad: pose.heading_rad,
            facing: estimate.facing,
            length_m: 1.0,
            ..*way
        };
        state.gap_m = state
            .echoes
            .blocking(&ahead, AHEAD_M, Among::All)
            .map_or(1.0, |(_, along_m)| along_m - FRONT_M);
    } else {
        state.gap_m -= estimate.rolled_m;
        state.near_m = state
            .echoes
            .nearest(pose.x_m, pose.y_m, None)
            .map_or(f32::MAX, |(_, distance_m)| distance_m);
    }
    planned
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::with_ranges_m;
    use crate::types::Side;

    #[test]
    fn an_obstacle_never_heard_beside_the_robot_slows_it_until_it_is_behind() {
        // Just passed on the left: the sonar at the right looks there.
        let slow = |way_m: f32, right_m: f32| {
            let mut state = State {
                last: Some((Side::Left, way_m)),
                unseen_m: 0.3,
                ..State::default()
            };
            let (way, _) = way_to(&Pose::default(), &(3.0, 0.0));
            count(&mut state, &with_ranges_m([0.0, right_m, 0.0]), &way);
            state.doubts()
        };
        assert!(slow(0.1, 0.0));
        assert!(!slow(0.1, 0.9), "it hears something");
        assert!(!slow(0.7, 0.0), "far behind");
    }
}
