//! Pure pursuit: a tracker for a straight line and for any polyline (memoria 6.1.6). Derivation: docs/theory/pursuit.md.
//!
//! ```text
//! nearest point of the path -> point a lookahead L further on -> (x, y) in the robot's frame -> curvature k = 2 y / (x^2 + y^2)
//! v = min(cruise, sqrt(a_side / |k|), ramp, sqrt(2 a (distance left - v measured * lag)))       yaw rate = k v
//! L = max(L_min, T v), or up to the next point after the nearest one, when points are spread along the path as in the report
//! ```
//!
//! A point on the left has a positive y: steer left. The last segment of the path is extended for the lookahead, so the
//! braking at the end does not depend on L, and the curvature stays small there. The path is a function from an index
//! to a point: 0 is the next point, `None` is beyond the end; its owner advances it when a step reports a point as
//! passed.
//!
//! The report heads for the point with its orientation controller and regulates the speed by the distance to it: the
//! nearer the point, the slower. It is one of a fixed number of points spread over the path, so it jumps.

use crate::estimate::Estimate;
use crate::math::{abs, atan2, clamp, from_u32, max, min, round, sqrt, wrap_angle};
use crate::motion::{CREEP_M_S, Stop, StopState, Stopping};
use crate::params::{ParamId, Params};
use crate::types::{Drive, Pose, TICK_S, Transform};

/// A place in the world [m].
pub type Point = (f32, f32);

/// Largest share of the wheels' speed for steering: no wheel stops, let alone reverses.
const STEERING_SHARE: f32 = 0.6;
/// Bearing of the lookahead from which a standing robot turns to it first [rad].
const TURN_STANDING_RAD: f32 = 0.35;
/// The same for a moving one: 75 degrees.
const TURN_MOVING_RAD: f32 = 1.3;
/// Segments of the path shorter than this have no direction [m].
const NO_LENGTH_M: f32 = 1e-3;
/// Segments of the path searched ahead.
const MOST_PIECES: u8 = 20;

/// Configuration of a pure pursuit.
#[derive(Clone, Copy, Debug)]
pub struct Pursuit<'a> {
    params: &'a Params,
    /// How it comes to rest [m].
    stop: Stop<'a>,
}

/// State of a pure pursuit; the default is its start.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PursuitState {
    /// Start of the present segment of the path.
    from: Option<Point>,
    stop: StopState,
    /// The ramped speed [m/s].
    speed_m_s: f32,
}

impl From<Point> for PursuitState {
    /// The state for a path that begins at this point; the default begins at the robot.
    fn from(start: Point) -> Self {
        Self {
            from: Some(start),
            ..Self::default()
        }
    }
}

/// Request of a pure pursuit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PursuitStep {
    /// Of the wheels.
    pub drive: Drive,
    /// Direction of the lookahead [rad].
    pub heading_ref_rad: f32,
    /// Distance from the path, positive left of it [m].
    pub cross_m: f32,
    /// The next point is passed: the one after it is number 0 from now on.
    pub passed: bool,
    /// The lookahead is so far aside that the robot should stop and turn to `heading_ref_rad` first.
    pub turn: bool,
    /// The robot stands at the end.
    pub done: bool,
}

/// A segment of the path and a point beside it.
#[derive(Clone, Copy, Debug)]
struct Piece {
    from: Point,
    to: Point,
    /// Its direction; the robot's own where it has no length.
    unit: Point,
    length_m: f32,
    along_m: f32,
    cross_m: f32,
}

impl Piece {
    fn new(from: &Point, to: &Point, pose: &Pose, fallback: &Point) -> Self {
        let (dx, dy) = (to.0 - from.0, to.1 - from.1);
        let length_m = sqrt(dx * dx + dy * dy);
        let unit = if length_m < NO_LENGTH_M {
            *fallback
        } else {
            (dx / length_m, dy / length_m)
        };
        let (px, py) = (pose.x_m - from.0, pose.y_m - from.1);
        Self {
            from: *from,
            to: *to,
            unit,
            length_m,
            along_m: px * unit.0 + py * unit.1,
            cross_m: unit.0 * py - unit.1 * px,
        }
    }

    fn point(&self, along_m: f32) -> Point {
        (
            self.from.0 + along_m * self.unit.0,
            self.from.1 + along_m * self.unit.1,
        )
    }

    /// The next segment, up to another point.
    fn next(&self, to: &Point, pose: &Pose) -> Self {
        Self::new(&self.to, to, pose, &self.unit)
    }

    /// Distance of the point from the segment [m].
    fn distance_m(&self) -> f32 {
        let beyond_m = self.along_m - clamp(self.along_m, 0.0, self.length_m);
        sqrt(beyond_m * beyond_m + self.cross_m * self.cross_m)
    }
}

impl<'a> Pursuit<'a> {
    /// From the parameters.
    pub fn new(params: &'a Params) -> Self {
        Self {
            params,
            stop: Stop::on_the_way(params),
        }
    }

    /// Half the distance between the wheels [m].
    fn half_base_m(&self) -> f32 {
        0.5 * self.params.get(ParamId::Base)
    }

    /// One tick along `path`, at most at `limit_m_s`. Nothing is driven where the path has no point.
    pub fn step(
        &self,
        state: &mut PursuitState,
        estimate: &Estimate,
        limit_m_s: f32,
        path: impl Fn(u8) -> Option<Point>,
    ) -> PursuitStep {
        let robot = Transform::of(estimate.pose);
        let pose = &robot.pose;
        let mut step = PursuitStep {
            drive: Drive::Release,
            heading_ref_rad: pose.heading_rad,
            cross_m: 0.0,
            passed: false,
            turn: false,
            done: false,
        };
        let Some(to) = path(0) else {
            return step;
        };
        let from = *state.from.get_or_insert((pose.x_m, pose.y_m));
        let mut piece = Piece::new(&from, &to, pose, &(robot.cos, robot.sin));
        step.cross_m = piece.cross_m;
        let lookahead_m = self.lookahead_m(piece.along_m, estimate.forward_m_s);
        step.passed = is_passed(&piece, path(1), pose, lookahead_m);
        if step.passed {
            state.from = Some(to);
        }
        let (target, left_m) = look(&mut piece, pose, lookahead_m, self.far_m(), &path);
        let target = robot.to_local(target.0, target.1);
        self.head_for(&mut step, state, estimate, &target, left_m, limit_m_s);
        step
    }

    /// Request towards a point in the robot's frame, with this distance left to the end.
    fn head_for(
        &self,
        step: &mut PursuitStep,
        state: &mut PursuitState,
        estimate: &Estimate,
        &(x_m, y_m): &Point,
        left_m: f32,
        limit_m_s: f32,
    ) {
        let bearing_rad = atan2(y_m, x_m);
        step.heading_ref_rad = wrap_angle(estimate.pose.heading_rad + bearing_rad);
        let v_m_s = estimate.forward_m_s;
        let stopping = self
            .stop
            .step(&mut state.stop, left_m, v_m_s, estimate.standing());
        step.done = stopping == Stopping::Done;
        if stopping != Stopping::Drive || limit_m_s <= 0.0 {
            state.speed_m_s = max(v_m_s, 0.0);
            return;
        }
        let turn_rad = if estimate.standing() {
            TURN_STANDING_RAD
        } else {
            TURN_MOVING_RAD
        };
        if abs(bearing_rad) > turn_rad {
            step.turn = true;
            state.speed_m_s = 0.0;
            return;
        }
        let most = STEERING_SHARE / self.half_base_m();
        let least_m = self.params.get(ParamId::PursuitLeast);
        let square = max(x_m * x_m + y_m * y_m, least_m * least_m);
        let curvature = clamp(2.0 * y_m / square, -most, most);
        let forward_m_s = self.speed_m_s(state, estimate, left_m, curvature, limit_m_s);
        step.drive = Drive::Twist {
            forward_m_s,
            yaw_rad_s: curvature * forward_m_s,
        };
    }

    /// Distance left beyond which the end does not matter yet [m]: twice the stopping distance.
    fn far_m(&self) -> f32 {
        let cruise_m_s = self.params.get(ParamId::LineCruise);
        let stop_s = 0.5 * cruise_m_s / self.stop.brake() + self.stop.lag_s();
        2.0 * cruise_m_s * stop_s
    }

    fn lookahead_m(&self, along_m: f32, forward_m_s: f32) -> f32 {
        // Between the points of the report's lookahead; 0: the lookahead goes by the speed.
        let spacing_m = self.params.get(ParamId::PursuitSpacing);
        if spacing_m <= 0.0 {
            let by_speed_m = self.params.get(ParamId::PursuitTime) * forward_m_s;
            return max(self.params.get(ParamId::PursuitLeast), by_speed_m);
        }
        let along_m = max(along_m, 0.0);
        let nearest = round(along_m / spacing_m).unsigned_abs();
        from_u32(nearest.saturating_add(1)) * spacing_m - along_m
    }

    fn speed_m_s(
        &self,
        state: &mut PursuitState,
        estimate: &Estimate,
        left_m: f32,
        curvature: f32,
        limit_m_s: f32,
    ) -> f32 {
        let bend = abs(curvature);
        // The outer wheel turns faster than the middle.
        let cruise_m_s =
            self.params.get(ParamId::LineCruise) / (1.0 + 0.5 * bend * self.half_base_m());
        let side_m_s = sqrt(self.params.get(ParamId::PursuitSide) / max(bend, 1e-3));
        let braking_m_s = self.stop.speed(left_m, estimate.forward_m_s);
        let wanted = min(min(cruise_m_s, side_m_s), min(limit_m_s, braking_m_s));
        state.speed_m_s = max(
            min(
                wanted,
                state.speed_m_s + self.params.get(ParamId::LineAccel) * TICK_S,
            ),
            min(CREEP_M_S, limit_m_s),
        );
        state.speed_m_s
    }
}

/// Whether the robot is nearer to the next segment than to this one, or beyond its end. The last one is never passed.
fn is_passed(piece: &Piece, next: Option<Point>, pose: &Pose, lookahead_m: f32) -> bool {
    let Some(next) = next else {
        return false;
    };
    let left_m = piece.length_m - piece.along_m;
    left_m <= 0.0
        || (left_m < lookahead_m && piece.next(&next, pose).distance_m() < piece.distance_m())
}

/// The point this far along the path from the robot's projection on its first segment, and the distance left to the
/// end; for an end beyond `far_m` only that it is beyond.
fn look(
    piece: &mut Piece,
    pose: &Pose,
    lookahead_m: f32,
    far_m: f32,
    path: &impl Fn(u8) -> Option<Point>,
) -> (Point, f32) {
    let start_m = piece.along_m;
    let ahead_m = max(start_m, 0.0) + lookahead_m;
    let (mut before_m, mut found) = (0.0, None);
    for number in 1..=MOST_PIECES {
        let next = path(number);
        let wanted_m = ahead_m - before_m;
        if found.is_none() && (wanted_m <= piece.length_m || next.is_none()) {
            found = Some(piece.point(wanted_m));
        }
        let left_m = before_m + piece.length_m - start_m;
        let Some(next) = next.filter(|_| found.is_none() || left_m < far_m) else {
            return (found.unwrap_or(piece.to), left_m);
        };
        before_m += piece.length_m;
        *piece = piece.next(&next, pose);
    }
    (found.unwrap_or(piece.to), far_m)
}

#[cfg(test)]
mod tests;
