//! Around an obstacle: which side, how near, when to leave it, and when there is no way.

use super::obstacle::Obstacle;
use super::{
    CREEP_M_S, Detour, Drive, Mission, PROGRESS_M, Phase, Place, Plan, Pose, SPOT_RAD, Side, State,
    abs, min, side_m, sqrt,
};
use crate::estimate::Estimate;
use crate::math::{atan2, max, wrap_angle};
use crate::motion::TurnState;
use crate::types::{Range, SonarId};
use core::f32::consts::FRAC_PI_2;

/// Back where the obstacle was met: within this, having been farther away than twice as much [mm].
const BACK_MM: u32 = 200;
/// After so little way the side of the last obstacle is the next one's too, unless the other way is this much shorter
/// [m].
const SOON_M: f32 = 0.8;
const STAY_M: f32 = 0.5;
/// Ways whose lengths differ by less are alike: where an obstacle ends is known no better. The one with more room
/// beside the robot is taken, the left one where that is alike, too [m].
const ALIKE_M: f32 = 0.1;
const ROOM_M: f32 = 0.1;
/// A side is changed for another whose way is this much shorter [m].
const CHANGE_M: f32 = 0.2;
/// A sonar at the side sees the obstacle within this [m].
const BESIDE_M: f32 = 0.35;
/// With something this near to the middle of the axis the robot's corners are slow [m].
const CLOSE_M: f32 = 0.19;
/// Yaw rate then; forward speed goes down with it, so that the way is the same [rad/s].
const CLOSE_RAD_S: f32 = 0.5;
/// An obstacle that reaches beyond a right angle from the way to the goal costs this much more [m/rad].
const BEHIND_M: f32 = 0.35;

impl Mission<'_> {
    pub(super) fn decide(&self, state: &mut State, estimate: &Estimate, goal_m: &(f32, f32)) {
        let pose = &estimate.pose;
        let Some(obstacle) = &state.plan.obstacle else {
            state.phase = Phase::GoToGoal;
            return;
        };
        let mut saved_m = saved_by_left_m(obstacle, pose, goal_m) + stay_m(state.last);
        if abs(saved_m) < ALIKE_M {
            saved_m = side_m(estimate, SonarId::Left) - side_m(estimate, SonarId::Right) + ROOM_M;
        }
        let (dx, dy) = (goal_m.0 - pose.x_m, goal_m.1 - pose.y_m);
        state.detour = Some(Detour {
            side: if saved_m > 0.0 {
                Side::Left
            } else {
                Side::Right
            },
            met: Place::new(pose.x_m, pose.y_m),
            least_m: sqrt(dx * dx + dy * dy),
            way_m: 0.0,
            away: false,
            vain: 0,
            changes: 0,
            wound_rad: 0.0,
            bearing_rad: atan2(dy, dx),
        });
        state.phase = Phase::Seek;
    }

    pub(super) fn around(
        &self,
        state: &mut State,
        estimate: &Estimate,
        goal_m: &(f32, f32),
        left_m: f32,
        planned: bool,
    ) -> Drive {
        let pose = &estimate.pose;
        let last = state.last;
        let Some(detour) = &mut state.detour else {
            self.face(state, pose, goal_m, SPOT_RAD);
            return Drive::Release;
        };
        let here = Place::new(pose.x_m, pose.y_m);
        let from_met_mm2 = here.square_mm2(detour.met);
        detour.away |= from_met_mm2 > 4 * BACK_MM * BACK_MM;
        if detour.away && detour.way_m > 1.2 && from_met_mm2 < BACK_MM * BACK_MM {
            if state.plan.same || state.laps > 0 {
                state.phase = Phase::Unreachable;
            } else {
                // Once around something that is not in the way.
                state.laps += 1;
                state.detour = None;
                self.face(state, pose, goal_m, SPOT_RAD);
            }
            return Drive::Release;
        }
        if planned {
            if may_leave(&state.plan, detour, left_m) {
                self.face(state, pose, goal_m, SPOT_RAD);
                return Drive::Release;
            }
            if let Some(obstacle) = &state.plan.obstacle {
                if obstacle.nearest_m > BESIDE_M
                    && detour.changes < 1
                    && to_left(
                        detour.side,
                        saved_by_left_m(obstacle, pose, goal_m) + stay_m(last),
                    ) < -CHANGE_M
                {
                    detour.changes += 1;
                    detour.side = detour.side.other();
                    detour.met = here;
                    detour.way_m = 0.0;
                    detour.away = false;
                }
                state.heading_ref_rad = state.plan.past_rad;
            }
        }
        let side = detour.side;
        self.advance(state, estimate, side)
    }

    /// Past the obstacle, in the direction that was planned.
    fn advance(&self, state: &mut State, estimate: &Estimate, side: Side) -> Drive {
        if state.phase == Phase::AvoidanceTurn {
            return self.turn(state, estimate, state.heading_ref_rad, Phase::Seek);
        }
        let error_rad = wrap_angle(state.heading_ref_rad - estimate.pose.heading_rad);
        if abs(error_rad) <= SPOT_RAD {
            state.phase = self.beside(state, estimate, side);
            let careful_m_s = self.careful_m_s(state, error_rad);
            let speed_m_s = min(self.free_m_s(state), min(self.around_m_s, careful_m_s));
            if speed_m_s >= CREEP_M_S {
                let drive = self.line.steer(speed_m_s, error_rad);
                return if state.near_m < CLOSE_M || state.doubts() {
                    slow_corners(drive)
                } else {
                    drive
                };
            }
        }
        state.phase = Phase::AvoidanceTurn;
        state.turn = TurnState::default();
        Drive::Release
    }

    /// The state of an advance: what the sonar towards the obstacle sees.
    fn beside(&self, state: &mut State, estimate: &Estimate, side: Side) -> Phase {
        let range = estimate.range(towards(side)).range;
        let sees = matches!(range, Range::Valid(range_m) if range_m < BESIDE_M);
        match state.phase {
            _ if sees => {
                state.lost_m = 0.0;
                Phase::Along
            }
            Phase::Along | Phase::SafeDistance if state.lost_m < 0.125 => {
                state.lost_m += abs(estimate.rolled_m);
                Phase::SafeDistance
            }
            _ => Phase::Seek,
        }
    }
}

/// The sonar towards an obstacle that is passed on a side.
pub(super) fn towards(side: Side) -> SonarId {
    match side {
        Side::Left => SonarId::Right,
        Side::Right => SonarId::Left,
    }
}

/// Whether the way to the goal is clear and leads nearer to it than the robot ever was.
fn may_leave(plan: &Plan, detour: &Detour, left_m: f32) -> bool {
    if plan.obstacle.is_none() {
        return true;
    }
    let free_m = if plan.clear_m > super::plan::HORIZON_M {
        min(left_m, 1.0)
    } else if plan.same || plan.clear_m < 0.7 {
        return false;
    } else {
        plan.clear_m - 0.3
    };
    let gained_m = if detour.vain == 0 { free_m } else { 0.0 };
    left_m - gained_m < detour.least_m - PROGRESS_M
}

/// What the way past an obstacle's left end to the goal is shorter than that past its right end [m].
fn saved_by_left_m(obstacle: &Obstacle, pose: &Pose, goal_m: &(f32, f32)) -> f32 {
    let here = (pose.x_m, pose.y_m);
    let goal_rad = atan2(goal_m.1 - here.1, goal_m.0 - here.0);
    let middle_rad = 0.5 * (obstacle.left.pass_rad + obstacle.right.pass_rad);
    // The goal's bearing on the obstacle's own count.
    let goal_rad = middle_rad + wrap_angle(goal_rad - middle_rad);
    let cost_m = |past: Place, off_rad: f32| {
        around_m(here, past, goal_m) + BEHIND_M * max(off_rad - FRAC_PI_2, 0.0)
    };
    cost_m(obstacle.right.at, goal_rad - obstacle.right.pass_rad)
        - cost_m(obstacle.left.at, obstacle.left.pass_rad - goal_rad)
}

/// What the left way may be longer for the side on which the last obstacle was passed, if that was a short way ago [m].
fn stay_m(last: Option<(Side, f32)>) -> f32 {
    match last {
        Some((side, way_m)) if way_m < SOON_M => to_left(side, STAY_M),
        _ => 0.0,
    }
}

/// A value as it is for the left side, the other way round for the right one.
fn to_left(side: Side, value: f32) -> f32 {
    match side {
        Side::Left => value,
        Side::Right => -value,
    }
}

/// The same way at a yaw rate at which a corner of the robot touches gently.
pub(super) fn slow_corners(drive: Drive) -> Drive {
    match drive {
        Drive::Twist {
            forward_m_s,
            yaw_rad_s,
        } if abs(yaw_rad_s) > CLOSE_RAD_S => {
            let share = CLOSE_RAD_S / abs(yaw_rad_s);
            Drive::Twist {
                forward_m_s: forward_m_s * share,
                yaw_rad_s: yaw_rad_s * share,
            }
        }
        other => other,
    }
}

/// Way from here past a point to the goal.
fn around_m(here: (f32, f32), past: Place, goal_m: &(f32, f32)) -> f32 {
    let (x_m, y_m) = past.metres();
    let leg = |from: (f32, f32), to: (f32, f32)| {
        let (dx, dy) = (to.0 - from.0, to.1 - from.1);
        sqrt(dx * dx + dy * dy)
    };
    leg(here, (x_m, y_m)) + leg((x_m, y_m), *goal_m)
}
