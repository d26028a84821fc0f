//! Whether the robot is where it was sent, judged from the truth: for programs that have no word for it.
//!
//! A goal counts as reached where the robot comes to rest within [`NEAR_M`] of it and stays so; how near it really is, the
//! metrics say.

use rumbo_plant::plant::Truth;

/// What a program may take for its goal [m]: the report's 5 cm, and as much again for its odometry.
const NEAR_M: f64 = 0.10;
/// A robot that was sent off has left after this way [m].
const LEFT_M: f64 = 0.10;
/// Fastest wheel that stands [rad/s].
const REST_RAD_S: f64 = 0.05;
/// How long it must stand [us].
const REST_US: u64 = 500_000;

/// Where the robot is sent.
#[derive(Clone, Copy, Debug)]
struct Goal {
    at_m: [f64; 2],
    sent_from_m: [f64; 2],
    left: bool,
    resting_since_us: Option<u64>,
}

/// Watches the robot on its way.
#[derive(Clone, Debug, Default)]
pub(super) struct GoalWatch {
    goal: Option<Goal>,
}

impl GoalWatch {
    /// The robot, now here, is sent to a point of the world.
    pub(super) fn send(&mut self, at_m: [f64; 2], truth: &Truth) {
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

    /// When it came to rest at its goal [us], said once.
    pub(super) fn reached(&mut self, truth: &Truth) -> Option<u64> {
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
