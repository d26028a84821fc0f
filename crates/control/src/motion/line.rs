//! A straight line to a point.
//!
//! ```text
//! cross-track error c [m] -> heading reference = heading of the line - limit(k_c c) -> yaw rate = k_h (reference - heading)
//! |v| = min(cruise, limit, ramp, sqrt(2 a (distance left - v measured * lag))), at least the slowest steady speed
//! ```
//!
//! Left of the line is a positive cross-track error: steer right, towards a smaller heading. Steering has priority over
//! speed: a robot that does not face along the line slows down. The end is a planned [`stop`](super::stop); a shortfall
//! is driven once more, an overshoot is not driven back.

use super::{CREEP_M_S, Stop, StopState, Stopping};
use crate::estimate::Estimate;
use crate::math::{abs, atan2, clamp, max, min, sqrt, wrap_angle};
use crate::params::{ParamId, Params};
use crate::types::{Drive, Pose, TICK_S, Transform};

/// Largest angle at which the robot approaches the line [rad]: 30 degrees.
const MOST_APPROACH_RAD: f32 = 0.52;
/// Largest share of the wheels' speed for steering: no wheel stops, let alone reverses.
const STEERING_SHARE: f32 = 0.6;
/// Heading error at which the speed is halved [rad].
const SLOW_RAD: f32 = 0.35;

/// A straight segment.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Segment {
    /// Its start and its direction.
    start: Transform,
    /// Its length [m].
    pub length_m: f32,
}

impl Segment {
    /// From one point to another. Its direction is 0 when they coincide.
    pub fn between(from: (f32, f32), to: (f32, f32)) -> Self {
        let (dx, dy) = (to.0 - from.0, to.1 - from.1);
        let start = Pose {
            x_m: from.0,
            y_m: from.1,
            heading_rad: atan2(dy, dx),
        };
        Self::ahead(&start, sqrt(dx * dx + dy * dy))
    }

    /// From the robot's pose, in its heading.
    pub fn ahead(pose: &Pose, length_m: f32) -> Self {
        Self {
            start: Transform::of(*pose),
            length_m,
        }
    }

    /// Its direction [rad].
    #[inline]
    pub fn heading_rad(&self) -> f32 {
        self.start.pose.heading_rad
    }

    /// Distance of a point along it, and to the left of it [m].
    #[inline]
    pub fn place(&self, x_m: f32, y_m: f32) -> (f32, f32) {
        self.start.to_local(x_m, y_m)
    }
}

/// Configuration of a line.
#[derive(Clone, Copy, Debug)]
pub struct Line<'a> {
    params: &'a Params,
    /// How it comes to rest [m].
    pub stop: Stop<'a>,
}

/// State of a line; the default is its start.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LineState {
    stop: StopState,
    /// The ramped speed [m/s].
    speed_m_s: f32,
}

/// Request of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineStep {
    /// Of the wheels.
    pub drive: Drive,
    /// The heading setpoint [rad].
    pub heading_ref_rad: f32,
    /// The robot stands at the end.
    pub done: bool,
}

impl<'a> Line<'a> {
    /// From the parameters.
    pub fn new(params: &'a Params) -> Self {
        Self {
            params,
            stop: Stop::on_the_way(params),
        }
    }

    /// One over half the distance between the wheels [1/m].
    fn per_half_base(&self) -> f32 {
        2.0 * self.params.geometry().per_base()
    }

    /// One tick along `segment`, at most at `limit_m_s` ([`f32::MAX`]: no limit; 0: the wheels are released).
    pub fn step(
        &self,
        state: &mut LineState,
        estimate: &Estimate,
        segment: &Segment,
        limit_m_s: f32,
    ) -> LineStep {
        let pose = &estimate.pose;
        let (along_m, cross_m) = segment.place(pose.x_m, pose.y_m);
        let left_m = segment.length_m - along_m;
        let approach_rad = clamp(
            self.params.get(ParamId::LineCross) * cross_m,
            -MOST_APPROACH_RAD,
            MOST_APPROACH_RAD,
        );
        let heading_ref_rad = wrap_angle(segment.heading_rad() - approach_rad);
        let mut step = LineStep {
            drive: Drive::Release,
            heading_ref_rad,
            done: false,
        };
        let v_m_s = estimate.forward_m_s;
        let stopping = self
            .stop
            .step(&mut state.stop, left_m, v_m_s, estimate.standing());
        step.done = stopping == Stopping::Done;
        if stopping != Stopping::Drive || limit_m_s <= 0.0 {
            state.speed_m_s = max(v_m_s, 0.0);
            return step;
        }
        let error_rad = wrap_angle(heading_ref_rad - pose.heading_rad);
        let forward_m_s = self.speed_m_s(state, estimate, left_m, error_rad, limit_m_s);
        step.drive = self.steer(forward_m_s, error_rad);
        step
    }

    /// Steers to a heading at a speed [m/s], as a line does.
    pub fn steer(&self, forward_m_s: f32, error_rad: f32) -> Drive {
        let most = STEERING_SHARE * abs(forward_m_s) * self.per_half_base();
        Drive::Twist {
            forward_m_s,
            yaw_rad_s: clamp(
                self.params.get(ParamId::LineHeading) * error_rad,
                -most,
                most,
            ),
        }
    }

    fn speed_m_s(
        &self,
        state: &mut LineState,
        estimate: &Estimate,
        left_m: f32,
        error_rad: f32,
        limit_m_s: f32,
    ) -> f32 {
        let braking = self.stop.speed(left_m, estimate.forward_m_s);
        let slow = 1.0 / (1.0 + abs(error_rad) * (1.0 / SLOW_RAD));
        let cruise_m_s = self.params.get(ParamId::LineCruise);
        let wanted = min(min(cruise_m_s * slow, limit_m_s), braking);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::{at, twist};
    use core::f32::consts::FRAC_PI_2;

    const NORTH: ((f32, f32), (f32, f32)) = ((1.0, 0.0), (1.0, 1.0));

    fn step(state: &mut LineState, estimate: &Estimate) -> LineStep {
        let segment = Segment::between(NORTH.0, NORTH.1);
        Line::new(&Params::default()).step(state, estimate, &segment, f32::MAX)
    }

    #[test]
    fn left_of_the_line_it_steers_right() {
        let place = Segment::between(NORTH.0, NORTH.1).place(0.95, 0.4);
        assert!((place.0 - 0.4).abs() < 1e-6 && (place.1 - 0.05).abs() < 1e-6);
        let mut state = LineState::default();
        let (forward, yaw) = twist(step(&mut state, &at(0.95, 0.4, FRAC_PI_2, 0.4)).drive);
        assert!(forward > 0.0 && yaw < 0.0, "{forward} {yaw}");
        let (_, yaw) = twist(step(&mut state, &at(1.05, 0.4, FRAC_PI_2, 0.4)).drive);
        assert!(yaw > 0.0, "{yaw}");
    }

    #[test]
    fn it_starts_gently_and_no_wheel_is_ever_asked_to_turn_backward() {
        let params = Params::default();
        let line = Line::new(&params);
        let mut state = LineState::default();
        let mut last_m_s = 0.0;
        for _ in 0..100 {
            let (forward, yaw) = twist(step(&mut state, &at(0.8, 0.1, 0.5, last_m_s)).drive);
            assert!(forward - last_m_s <= CREEP_M_S + 1e-6);
            assert!(abs(yaw) < forward * line.per_half_base());
            last_m_s = forward;
        }
        assert!(last_m_s > 0.1, "{last_m_s}");
    }

    #[test]
    fn it_stops_at_the_end_and_drives_on_what_fell_short() {
        let mut state = LineState::default();
        let coasting = step(&mut state, &at(1.0, 0.9985, FRAC_PI_2, 0.03));
        assert_eq!((coasting.drive, coasting.done), (Drive::Release, false));
        assert!(step(&mut state.clone(), &at(1.0, 0.999, FRAC_PI_2, 0.0)).done);
        assert!(step(&mut state.clone(), &at(1.0, 1.02, FRAC_PI_2, 0.0)).done);
        let (forward, _) = twist(step(&mut state, &at(1.0, 0.98, FRAC_PI_2, 0.0)).drive);
        assert!(forward > 0.0);
    }

    #[test]
    fn a_limit_of_the_speed_holds_and_zero_releases_the_wheels() {
        let params = Params::default();
        let line = Line::new(&params);
        let segment = Segment::between(NORTH.0, NORTH.1);
        let mut state = LineState::default();
        let estimate = at(1.0, 0.2, FRAC_PI_2, 0.1);
        for _ in 0..100 {
            let slow = line.step(&mut state, &estimate, &segment, 0.1);
            assert!(twist(slow.drive).0 <= 0.1);
        }
        let stopped = line.step(&mut state, &estimate, &segment, 0.0);
        assert_eq!(stopped.drive, Drive::Release);
        assert!(!stopped.done);
    }
}
