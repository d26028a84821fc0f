//! Detects from ground truth whether the robot has reached its goal: for programs that do not report it.
//!
//! A goal counts as reached when the robot comes to rest within [`NEAR_M`] of it and stays there; the metrics give the
//! actual distance.

use rumbo_plant::plant::GroundTruth;

/// Distance within which a goal counts as reached [m]: the report's 5 cm, and as much again for its odometry.
const NEAR_M: f64 = 0.10;
/// A robot has left its start after this distance [m].
const LEFT_M: f64 = 0.10;
/// Fastest wheel that stands [rad/s].
const REST_RAD_S: f64 = 0.05;
/// How long it must stand [us].
const REST_US: u64 = 500_000;

/// The robot's goal.
#[derive(Clone, Copy, Debug)]
struct Goal {
    at_m: [f64; 2],
    sent_from_m: [f64; 2],
    left: bool,
    resting_since_us: Option<u64>,
}

/// Tracks the robot on its way.
#[derive(Clone, Debug, Default)]
pub(super) struct GoalWatch {
    goal: Option<Goal>,
}

impl GoalWatch {
    /// The robot, now here, is sent to a point of the world.
    pub(super) fn send(&mut self, at_m: [f64; 2], truth: &GroundTruth) {
        self.goal = Some(Goal {
            at_m,
            sent_from_m: [truth.pose.x_m, truth.pose.y_m],
            left: false,
            resting_since_us: None,
        });
    }

    /// It is on its way to a goal.
    pub(super) fn is_set(&self) -> bool {
        self.goal.is_some()
    }

    /// When it came to rest at its goal [us]; returned once.
    pub(super) fn reached(&mut self, truth: &GroundTruth) -> Option<u64> {
        let goal = self.goal.as_mut()?;
        let from_m = |[x_m, y_m]: [f64; 2]| (truth.pose.x_m - x_m).hypot(truth.pose.y_m - y_m);
        goal.left |= from_m(goal.sent_from_m) > LEFT_M;
        let rests = truth
            .wheel_rad_s
            .iter()
            .all(|speed| speed.abs() < REST_RAD_S);
        if !(goal.left && rests && from_m(goal.at_m) <= NEAR_M) {
            goal.resting_since_us = None;
            return None;
        }
        let since_us = *goal.resting_since_us.get_or_insert(truth.now_us);
        if truth.now_us < since_us + REST_US {
            return None;
        }
        self.goal = None;
        Some(since_us)
    }
}

/// How near a program passes a corner, by its own odometry [m]: the report's 10 cm, and the rounding of a row.
const PASSED_M: f32 = 0.12;

/// A route driven by a program that reports only its pose.
#[derive(Clone, Debug, Default)]
pub(super) struct RouteWatch {
    points_m: Vec<[f32; 2]>,
    next: usize,
}

impl RouteWatch {
    /// One more point at the end of the route.
    pub(super) fn add(&mut self, x_m: f32, y_m: f32) {
        self.points_m.push([x_m, y_m]);
    }

    /// Updates with the estimated position; returns true once, at the last point after all others.
    pub(super) fn passes(&mut self, here_x_m: f32, here_y_m: f32) -> bool {
        let Some([x_m, y_m]) = self.points_m.get(self.next).copied() else {
            return false;
        };
        let (dx_m, dy_m) = (here_x_m - x_m, here_y_m - y_m);
        if dx_m * dx_m + dy_m * dy_m > PASSED_M * PASSED_M {
            return false;
        }
        self.next += 1;
        self.next == self.points_m.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_route_is_driven_when_its_points_were_passed_in_order() {
        let mut route = RouteWatch::default();
        assert!(!route.passes(0.0, 0.0));
        for [x_m, y_m] in [[1.0, 0.0], [1.0, 1.0], [0.0, 0.0]] {
            route.add(x_m, y_m);
        }
        // At the end of the route, but not yet round.
        let way = [[0.05, 0.0], [0.91, 0.0], [1.02, 0.93], [0.5, 0.5]];
        assert!(way.iter().all(|[x_m, y_m]| !route.passes(*x_m, *y_m)));
        assert!(route.passes(0.07, 0.05));
        assert!(!route.passes(0.07, 0.05));
    }
}
