//! Reach a point around obstacles.

use super::obstacle::Obstacle;
use super::{
    Action, Detour, Drive, Look, Mission, Phase, Place, Pose, Segment, ServoAngle, Side, State,
    Way, abs, min, sqrt,
};
use crate::estimate::Estimate;
use crate::math::{atan2, max, wrap_angle};
use crate::motion::{LineState, TurnState};
use crate::types::TICK_S;
use core::f32::consts::{FRAC_PI_2, TAU};

/// An obstacle this near on the way is looked at [m].
const LOOK_M: f32 = 0.62;
/// The servo looks this far to each side on the way, while sweeping, and to the far side of an obstacle that is followed [rad].
const SWING_RAD: f32 = 0.75;
const SWEEP_RAD: f32 = 1.5;
/// To the side where something is near, and to the other [rad].
const WIDE_RAD: f32 = 1.0;
const NARROW_RAD: f32 = 0.35;
/// Near is what a sonar at the side sees within this [m].
const NEAR_M: f32 = 0.3;
/// A heading error beyond this is a turn [rad].
const TURNS_RAD: f32 = 0.2;
/// Something within this of the middle of the axis makes the robot careful [m].
const CAREFUL_M: f32 = 0.33;
/// Heading error that halves the speed then [rad].
const CAREFUL_RAD: f32 = 0.2;
/// Heading errors beyond this are turned on the spot [rad].
const SPOT_RAD: f32 = 0.7;
/// Until this is left [rad].
const TURNED_RAD: f32 = 0.12;
/// Progress that counts [m].
const PROGRESS_M: f32 = 0.05;
/// Back where the obstacle was met: within this, having been farther away than twice as much [mm].
const BACK_MM: i32 = 200;
/// Once around the goal without getting nearer to it, and a little more [rad].
const WOUND_RAD: f32 = TAU + 0.3;
/// After so little way the side of the last obstacle is the next one's too, unless the other way is this much shorter [m].
const SOON_M: f32 = 0.8;
const STAY_M: f32 = 0.5;
/// A side is changed for another whose way is this much shorter [m].
const CHANGE_M: f32 = 0.2;
/// A sonar at the side sees the obstacle within this [m].
const BESIDE_M: f32 = 0.35;
/// Half of the width that must be clear ahead to drive [m].
const AHEAD_M: f32 = 0.1;
/// Front of the robot from the wheels' axis [m].
const FRONT_M: f32 = 0.13;
/// Distance kept ahead [m].
const KEEP_M: f32 = 0.05;
/// Speed while the front sonar may be deaf [m/s].
const DOUBT_M_S: f32 = 0.08;
/// Speed during a sweep [m/s].
const SWEEP_M_S: f32 = 0.1;
/// Nearer than this the robot turns slowly on the spot: its corners reach 0.15 m [m].
const TIGHT_M: f32 = 0.155;
/// Yaw rate there [rad/s].
const TIGHT_RAD_S: f32 = 0.6;
/// Yaw rate per distance beyond [rad/s/m].
const TIGHT_SLOPE: f32 = 15.0;
/// An obstacle that reaches beyond a right angle from the way to the goal costs this much more [m/rad].
const BEHIND_M: f32 = 0.35;

impl Mission {
    pub(super) fn goal(
        &self,
        state: &mut State,
        estimate: &Estimate,
        goal_m: (f32, f32),
    ) -> Action {
        let pose = &estimate.pose;
        if state.fresh {
            state.fresh = false;
            state.phase = Phase::Initialise;
        }
        let (dx, dy) = (goal_m.0 - pose.x_m, goal_m.1 - pose.y_m);
        let left_m = sqrt(dx * dx + dy * dy);
        let way = Way {
            x_m: pose.x_m,
            y_m: pose.y_m,
            heading_rad: atan2(dy, dx),
            length_m: min(left_m, super::plan::HORIZON_M),
        };
        let mut action = Action {
            state: state.phase as u8,
            heading_ref_rad: state.heading_ref_rad,
            ..Action::default()
        };
        if matches!(state.phase, Phase::Wait | Phase::Unreachable) {
            action.reached = state.phase == Phase::Wait;
            action.unreachable = state.phase == Phase::Unreachable;
            return action;
        }
        state.age_s += TICK_S;
        if let Some((_, way_m)) = &mut state.last {
            *way_m += abs(estimate.rolled_m);
        }
        if let Some(detour) = &mut state.detour {
            detour.way_m += abs(estimate.rolled_m);
            // Seen from the goal the robot moves along its own bearing, half a turn off.
            detour.wound_rad += wrap_angle(way.heading_rad - detour.bearing_rad);
            detour.bearing_rad = way.heading_rad;
            if abs(detour.wound_rad) > WOUND_RAD {
                state.phase = Phase::Unreachable;
            }
        }
        let around = state.detour.as_ref().map(|detour| detour.side);
        let following = following(state.phase);
        let planned = state
            .plan
            .step(&state.echoes, pose, &way, around.filter(|_| following));
        let ahead = Way {
            heading_rad: pose.heading_rad,
            length_m: 1.0,
            ..way
        };
        state.gap_m = state
            .echoes
            .blocking(&ahead, AHEAD_M)
            .map_or(1.0, |(_, along_m)| along_m - FRONT_M);
        if state.age_s > self.give_up_s {
            state.phase = Phase::Unreachable;
        }
        action.drive = match state.phase {
            Phase::Wait | Phase::Unreachable => Drive::Release,
            Phase::Initialise => {
                state.age_s = 0.0;
                state.laps = 0;
                state.last = None;
                state.detour = None;
                self.face(state, pose, goal_m, 0.1);
                Drive::Release
            }
            Phase::InitialTurn => self.turn(state, estimate, way.heading_rad, Phase::GoToGoal),
            Phase::GoToGoal => self.go(state, estimate, &way, left_m, &mut action),
            Phase::SweepRight | Phase::SweepLeft => self.sweep(state, estimate, left_m),
            Phase::Decide => {
                self.decide(state, pose, goal_m);
                Drive::Release
            }
            Phase::AvoidanceTurn | Phase::Seek | Phase::Along | Phase::SafeDistance => {
                self.around(state, estimate, goal_m, left_m, planned)
            }
        };
        action.look = look(state, estimate);
        action.state = state.phase as u8;
        action.heading_ref_rad = state.heading_ref_rad;
        action
    }

    /// Turns to the goal, or drives on where that takes no turn.
    fn face(&self, state: &mut State, pose: &Pose, goal_m: (f32, f32), spot_rad: f32) {
        state.segment = Segment::between((pose.x_m, pose.y_m), goal_m);
        state.line = LineState::default();
        state.turn = TurnState::default();
        state.heading_ref_rad = state.segment.heading_rad;
        let error_rad = wrap_angle(state.segment.heading_rad - pose.heading_rad);
        state.phase = if abs(error_rad) > spot_rad {
            Phase::InitialTurn
        } else {
            Phase::GoToGoal
        };
    }

    fn turn(&self, state: &mut State, estimate: &Estimate, heading_rad: f32, next: Phase) -> Drive {
        let pose = &estimate.pose;
        state.heading_ref_rad = heading_rad;
        let mut turn = self.turn;
        let nearest = state.echoes.nearest(pose.x_m, pose.y_m);
        if let Some((_, distance_m)) = nearest {
            let rate_rad_s = (distance_m - TIGHT_M) * TIGHT_SLOPE;
            turn.rate_rad_s = min(turn.rate_rad_s, max(rate_rad_s, TIGHT_RAD_S));
        }
        let step = turn.step(&mut state.turn, estimate, heading_rad);
        let error_rad = wrap_angle(heading_rad - pose.heading_rad);
        if step.done || (next != Phase::GoToGoal && abs(error_rad) < TURNED_RAD) {
            state.phase = next;
        }
        step.drive
    }

    fn go(
        &self,
        state: &mut State,
        estimate: &Estimate,
        way: &Way,
        left_m: f32,
        action: &mut Action,
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
        let limit_m_s = min(
            self.free_m_s(state),
            self.careful_m_s(state, estimate, error_rad),
        );
        let step = self
            .line
            .step(&mut state.line, estimate, &state.segment, limit_m_s);
        state.heading_ref_rad = step.heading_ref_rad;
        if step.done && estimate.standing() {
            state.phase = Phase::Wait;
            action.reached = true;
            action.new_origin = self.reset_origin;
            if self.reset_origin {
                state.echoes.move_origin(&estimate.pose);
            }
        }
        step.drive
    }

    /// Fastest speed from which the robot stops before what is ahead.
    fn free_m_s(&self, state: &State) -> f32 {
        let room_m = max(state.gap_m - KEEP_M, 0.0);
        let free_m_s = sqrt(2.0 * self.brake_m_s2 * room_m);
        if state.watch.doubts() {
            min(free_m_s, DOUBT_M_S)
        } else {
            free_m_s
        }
    }

    /// Fastest speed with what is near.
    fn careful_m_s(&self, state: &State, estimate: &Estimate, error_rad: f32) -> f32 {
        let pose = &estimate.pose;
        match state.echoes.nearest(pose.x_m, pose.y_m) {
            Some((_, distance_m)) if distance_m < CAREFUL_M => {
                self.around_m_s / (1.0 + abs(error_rad) / CAREFUL_RAD)
            }
            _ => self.cruise_m_s,
        }
    }

    fn sweep(&self, state: &mut State, estimate: &Estimate, left_m: f32) -> Drive {
        let servo_rad = estimate.servo_rad;
        match state.phase {
            Phase::SweepRight if servo_rad <= -SWEEP_RAD => state.phase = Phase::SweepLeft,
            Phase::SweepLeft if servo_rad >= SWEEP_RAD => {
                state.phase =
                    if state.plan.clear_m < min(left_m, 1.0) && state.plan.obstacle.is_some() {
                        Phase::Decide
                    } else {
                        Phase::GoToGoal
                    };
            }
            _ => {}
        }
        let error_rad = wrap_angle(state.segment.heading_rad - estimate.pose.heading_rad);
        let speed_m_s = min(self.free_m_s(state), SWEEP_M_S);
        if speed_m_s < 0.04 {
            return Drive::Release;
        }
        self.line.steer(speed_m_s, error_rad)
    }

    fn decide(&self, state: &mut State, pose: &Pose, goal_m: (f32, f32)) {
        let Some(obstacle) = state.plan.obstacle else {
            state.phase = Phase::GoToGoal;
            return;
        };
        let here = (pose.x_m, pose.y_m);
        let (mut left, mut right) = self.costs(&obstacle, here, goal_m);
        match state.last {
            Some((Side::Left, way_m)) if way_m < SOON_M => right += STAY_M,
            Some((Side::Right, way_m)) if way_m < SOON_M => left += STAY_M,
            _ => {}
        }
        let (dx, dy) = (goal_m.0 - pose.x_m, goal_m.1 - pose.y_m);
        state.detour = Some(Detour {
            side: if left < right {
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

    fn around(
        &self,
        state: &mut State,
        estimate: &Estimate,
        goal_m: (f32, f32),
        left_m: f32,
        planned: bool,
    ) -> Drive {
        let pose = &estimate.pose;
        let Some(mut detour) = state.detour else {
            self.face(state, pose, goal_m, SPOT_RAD);
            return Drive::Release;
        };
        let here = Place::new(pose.x_m, pose.y_m);
        let from_met_mm2 = here.square_mm2(detour.met);
        if from_met_mm2 > 4 * BACK_MM * BACK_MM {
            detour.away = true;
        }
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
            if self.may_leave(state, &detour, left_m) {
                state.detour = Some(detour);
                self.face(state, pose, goal_m, SPOT_RAD);
                return Drive::Release;
            }
            if let Some(obstacle) = state.plan.obstacle {
                let here = (pose.x_m, pose.y_m);
                let (left, right) = self.costs(&obstacle, here, goal_m);
                let (own, other, side) = match detour.side {
                    Side::Left => (left, right, Side::Right),
                    Side::Right => (right, left, Side::Left),
                };
                if obstacle.nearest_m > BESIDE_M && detour.changes < 1 && other + CHANGE_M < own {
                    detour.changes += 1;
                    detour.side = side;
                    detour.met = Place::new(pose.x_m, pose.y_m);
                    detour.way_m = 0.0;
                    detour.away = false;
                }
            }
            if state.plan.obstacle.is_some() {
                state.heading_ref_rad = state.plan.past_rad;
            }
        }
        state.detour = Some(detour);
        let error_rad = wrap_angle(state.heading_ref_rad - pose.heading_rad);
        if state.phase == Phase::AvoidanceTurn {
            return self.turn(state, estimate, state.heading_ref_rad, Phase::Seek);
        }
        if abs(error_rad) > SPOT_RAD {
            state.phase = Phase::AvoidanceTurn;
            state.turn = TurnState::default();
            return Drive::Release;
        }
        state.phase = self.beside(state, estimate, detour.side);
        let careful_m_s = self.careful_m_s(state, estimate, error_rad);
        let speed_m_s = min(self.free_m_s(state), min(self.around_m_s, careful_m_s));
        if speed_m_s < 0.03 {
            state.phase = Phase::AvoidanceTurn;
            state.turn = TurnState::default();
            return Drive::Release;
        }
        self.line.steer(speed_m_s, error_rad)
    }

    /// The state of an advance: what the sonar towards the obstacle sees.
    fn beside(&self, state: &mut State, estimate: &Estimate, side: Side) -> Phase {
        use crate::types::{Range, SonarId};
        let towards = match side {
            Side::Left => SonarId::Right,
            Side::Right => SonarId::Left,
        };
        let sees =
            matches!(estimate.range(towards).range, Range::Valid(range_m) if range_m < BESIDE_M);
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

    fn may_leave(&self, state: &State, detour: &Detour, left_m: f32) -> bool {
        let plan = &state.plan;
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
}

impl Mission {
    /// Ways past both ends of an obstacle to the goal [m].
    fn costs(&self, obstacle: &Obstacle, here: (f32, f32), goal_m: (f32, f32)) -> (f32, f32) {
        let goal_rad = atan2(goal_m.1 - here.1, goal_m.0 - here.0);
        let middle_rad = 0.5 * (obstacle.left.pass_rad + obstacle.right.pass_rad);
        // The goal's bearing on the obstacle's own count.
        let goal_rad = middle_rad + wrap_angle(goal_rad - middle_rad);
        let behind = |off_rad: f32| BEHIND_M * max(off_rad - FRAC_PI_2, 0.0);
        (
            around_m(here, obstacle.left.at, goal_m) + behind(obstacle.left.pass_rad - goal_rad),
            around_m(here, obstacle.right.at, goal_m) + behind(goal_rad - obstacle.right.pass_rad),
        )
    }
}

/// Way from here past a point to the goal.
fn around_m(here: (f32, f32), past: Place, goal_m: (f32, f32)) -> f32 {
    let (x_m, y_m) = past.metres();
    let leg = |from: (f32, f32), to: (f32, f32)| {
        let (dx, dy) = (to.0 - from.0, to.1 - from.1);
        sqrt(dx * dx + dy * dy)
    };
    leg(here, (x_m, y_m)) + leg((x_m, y_m), goal_m)
}

/// How far to the right and to the left the servo swings: mostly to where something is near, or where the robot turns to.
fn swing(state: &State, estimate: &Estimate) -> (f32, f32) {
    use crate::types::{Range, SonarId};
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

fn following(phase: Phase) -> bool {
    matches!(
        phase,
        Phase::AvoidanceTurn | Phase::Seek | Phase::Along | Phase::SafeDistance
    )
}

/// Where the servo points: to and fro.
fn look(state: &mut State, estimate: &Estimate) -> Look {
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
