//! What the remembered points mean for the way to the goal: clear, or an obstacle with two ends.
//!
//! One round takes a few ticks: look along the way, find the obstacle that blocks it, publish. While the robot goes around an obstacle
//! the round starts from the point nearest to the side that it keeps to it, so that it follows that one and not the next.

use super::echoes::{Echoes, Place};
use super::obstacle::{Obstacle, Search, WAY_M, Way, blocking, half_angle};
use crate::math::{atan2, wrap_angle};
use crate::types::{Pose, Side};
use core::f32::consts::FRAC_PI_2;

/// How far ahead the way to the goal is judged [m].
pub(super) const HORIZON_M: f32 = 1.3;
/// The obstacle that the robot goes around is no farther than this [m].
const BESIDE_M: f32 = 0.45;
/// Where the obstacle that is gone around is looked for, beside the middle of the axis [m].
const BESIDE_CENTRE_M: f32 = 0.15;
/// Within this length a way past an obstacle must be clear of others [m].
const PAST_M: f32 = 0.5;
/// Another obstacle that leaves less than this much too little is passed in the middle [rad].
const TIGHT_RAD: f32 = 0.35;

/// The planner's memory.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Plan {
    search: Search,
    busy: bool,
    /// The obstacle of the last round.
    pub obstacle: Option<Obstacle>,
    /// The direction that passes it on the side that was asked for [rad].
    pub past_rad: f32,
    /// How far the way to the goal is clear, as far as known; beyond [`HORIZON_M`] where nothing blocks it [m].
    pub clear_m: f32,
    /// What blocks it is the obstacle of the last round.
    pub same: bool,
}

impl Plan {
    /// One tick; says whether a round has ended. `way` leads to the goal, `around` is the side on which the obstacle is passed.
    pub(super) fn step(
        &mut self,
        echoes: &Echoes,
        pose: &Pose,
        way: &Way,
        around: Option<Side>,
    ) -> bool {
        if !self.busy {
            let in_way = echoes.surely_blocking(way, WAY_M);
            self.clear_m = in_way.map_or(f32::MAX, |(_, along_m)| along_m);
            self.same = in_way.is_some_and(|(number, _)| self.search.has(number));
            let beside = around.and_then(|side| self.beside(echoes, pose, side));
            let seed = beside.or(in_way.map(|(number, _)| (number, way.heading_rad)));
            let Some((number, about_rad)) = seed else {
                self.obstacle = None;
                return true;
            };
            self.search
                .begin(echoes, number, pose.x_m, pose.y_m, about_rad);
            self.busy = true;
        }
        let Some(obstacle) = self.search.step(echoes, pose.x_m, pose.y_m) else {
            return false;
        };
        self.past_rad = wrap_angle(obstacle.left.pass_rad);
        if let Some(side) = around {
            let (past_rad, joined) = self.past(echoes, pose, side, &obstacle);
            if joined {
                return false;
            }
            self.past_rad = past_rad;
        }
        self.obstacle = Some(obstacle);
        self.busy = false;
        true
    }

    /// The direction that passes the obstacle on a side, in the middle of what others leave [rad]; or another leaves nothing,
    /// and is part of the obstacle from now on.
    fn past(
        &mut self,
        echoes: &Echoes,
        pose: &Pose,
        side: Side,
        obstacle: &Obstacle,
    ) -> (f32, bool) {
        let (pass_rad, sign) = match side {
            Side::Left => (obstacle.left.pass_rad, 1.0),
            Side::Right => (obstacle.right.pass_rad, -1.0),
        };
        let way = Way {
            x_m: pose.x_m,
            y_m: pose.y_m,
            heading_rad: wrap_angle(pass_rad),
            length_m: PAST_M,
        };
        let here = Place::new(pose.x_m, pose.y_m);
        let others = echoes
            .firm(here)
            .filter(|(number, _)| !self.search.has(*number));
        let other = blocking(others, &way, WAY_M);
        let Some((number, point)) =
            other.and_then(|(number, _)| Some((number, echoes.get(number)?)))
        else {
            return (way.heading_rad, false);
        };
        let (bearing_rad, distance_m) = seen_from(pose, point);
        let limit_rad = bearing_rad - sign * half_angle(distance_m);
        let over_rad = sign * wrap_angle(limit_rad - way.heading_rad);
        if over_rad < -TIGHT_RAD {
            self.search
                .join(echoes, number, pose.x_m, pose.y_m, pass_rad);
            return (way.heading_rad, true);
        }
        let aside_rad = 0.5 * sign * crate::math::min(over_rad, 0.0);
        (wrap_angle(way.heading_rad + aside_rad), false)
    }

    /// The point of the last round's obstacle that is nearest to the side on which it is kept, and about where it lies [rad].
    fn beside(&self, echoes: &Echoes, pose: &Pose, side: Side) -> Option<(usize, f32)> {
        // What is passed on the left is on the right.
        let sign = match side {
            Side::Left => -1.0,
            Side::Right => 1.0,
        };
        let (x_m, y_m) = pose.to_world(0.0, sign * BESIDE_CENTRE_M);
        let (number, distance_m) = echoes.nearest_of(x_m, y_m, |number| self.search.has(number))?;
        (distance_m < BESIDE_M).then_some((number, pose.heading_rad + sign * FRAC_PI_2))
    }
}

/// Direction and distance of a place [rad, m].
fn seen_from(pose: &Pose, place: Place) -> (f32, f32) {
    let (x_m, y_m) = place.metres();
    let (dx, dy) = (x_m - pose.x_m, y_m - pose.y_m);
    (atan2(dy, dx), crate::math::sqrt(dx * dx + dy * dy))
}
