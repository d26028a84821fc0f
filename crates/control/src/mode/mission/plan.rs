//! Plans the way to the goal from the stored points: clear, or an obstacle with two ends.
//!
//! One round takes a few ticks: check the way, find the obstacle that blocks it, publish. While the robot goes around
//! an obstacle, the round starts from the point nearest to the side facing it, so that it follows that one and not the
//! next.

use super::echoes::Echoes;
use super::obstacle::{Among, Obstacle, Search, WAY_M, Way, half_angle};
use super::place::Place;
use crate::math::{atan2, sin_cos, wrap_angle};
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
    /// The obstacle is found; what stands beside its end is looked for next.
    complete: bool,
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
    /// One tick; says whether a round has ended. `way` leads to the goal, `around` is the side on which the obstacle is
    /// passed.
    pub(super) fn step(
        &mut self,
        echoes: &Echoes,
        pose: &Pose,
        way: &Way,
        around: Option<Side>,
    ) -> bool {
        if !self.busy {
            let in_way = echoes.blocking(way, WAY_M, Among::Firm);
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
            // Looking along the way and beside the robot is enough for one tick.
            return false;
        }
        let Some(obstacle) = self.search.step(echoes, pose.x_m, pose.y_m) else {
            return false;
        };
        self.past_rad = wrap_angle(obstacle.left.pass_rad);
        if let Some(side) = around {
            // In a tick of its own: it asks the whole memory once more.
            self.complete = !self.complete;
            if self.complete {
                return false;
            }
            let (past_rad, joined) = self.past(echoes, pose, side, &obstacle);
            if joined {
                return false;
            }
            self.past_rad = past_rad;
        }
        self.obstacle = Some(obstacle);
        self.busy = false;
        self.complete = false;
        true
    }

    /// The direction that passes the obstacle on a side, in the middle of what others leave [rad]; or another leaves
    /// nothing, and is part of the obstacle from now on.
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
            facing: sin_cos(pass_rad),
            length_m: PAST_M,
        };
        let other = echoes.blocking(&way, WAY_M, Among::FirmOthers(&self.search));
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

    /// The point of the last round's obstacle that is nearest to the side on which it is kept, and about where it lies
    /// [rad].
    fn beside(&self, echoes: &Echoes, pose: &Pose, side: Side) -> Option<(usize, f32)> {
        // What is passed on the left is on the right.
        let sign = match side {
            Side::Left => -1.0,
            Side::Right => 1.0,
        };
        let (x_m, y_m) = pose.to_world(0.0, sign * BESIDE_CENTRE_M);
        let (number, distance_m) = echoes.nearest(x_m, y_m, Some(&self.search))?;
        (distance_m < BESIDE_M).then_some((number, pose.heading_rad + sign * FRAC_PI_2))
    }
}

/// Direction and distance of a place [rad, m].
fn seen_from(pose: &Pose, place: Place) -> (f32, f32) {
    let (x_m, y_m) = place.metres();
    let (dx, dy) = (x_m - pose.x_m, y_m - pose.y_m);
    (atan2(dy, dx), crate::math::sqrt(dx * dx + dy * dy))
}

#[cfg(test)]
mod tests {
    use super::super::beam::Beam;
    use super::*;
    use crate::types::{Range, SonarId, SonarReading, SonarView, Transform};

    /// A memory of points, each detected twice by a sonar close to it.
    fn remembered(points_m: &[(f32, f32)]) -> Echoes {
        let mut echoes = Echoes::default();
        for (x_m, y_m) in points_m.iter().chain(points_m) {
            let from = Pose {
                x_m: x_m - 0.1,
                y_m: *y_m,
                heading_rad: 0.0,
            };
            let reading = SonarReading {
                sonar: SonarId::Front,
                range: Range::Valid(0.1),
                view: SonarView::default(),
                servo_rad: 0.0,
            };
            let robot = Transform::of(from);
            let (beam, _) = Beam::of(&robot, &reading);
            echoes.ingest(&robot, &reading, &beam, true);
        }
        echoes
    }

    /// A wall across x = 0.6 m, with a point every 10 cm.
    fn wall(from_cm: i16, to_cm: i16) -> Echoes {
        let mut points_m = [(0.0, 0.0); 16];
        let count = usize::try_from((to_cm - from_cm) / 10 + 1).unwrap();
        for (index, point) in (0..).zip(points_m.iter_mut().take(count)) {
            *point = (0.6, f32::from(from_cm + 10 * index) * 0.01);
        }
        remembered(&points_m[..count])
    }

    /// The plan of a robot at the origin with its goal 2 m ahead.
    fn plan(echoes: &Echoes, around: Option<Side>) -> Plan {
        let mut plan = Plan::default();
        let way = Way {
            x_m: 0.0,
            y_m: 0.0,
            heading_rad: 0.0,
            facing: (0.0, 1.0),
            length_m: HORIZON_M,
        };
        let mut rounds = 0;
        for _ in 0..100 {
            rounds += u32::from(plan.step(echoes, &Pose::default(), &way, around));
        }
        assert!(rounds > 2);
        plan
    }

    #[test]
    fn an_empty_memory_is_a_clear_way() {
        let plan = plan(&Echoes::default(), None);
        assert!(plan.obstacle.is_none() && plan.clear_m > HORIZON_M);
    }

    #[test]
    fn a_wall_across_the_way_has_two_ends_and_room_for_the_robot_beside_them() {
        let plan = plan(&wall(-30, 20), None);
        assert!((plan.clear_m - 0.6).abs() < 0.01);
        let obstacle = plan.obstacle.unwrap();
        let (x_m, left_m) = obstacle.left.at.metres();
        assert!((x_m - 0.6).abs() < 0.01 && (left_m - 0.2).abs() < 0.01);
        // The direction passes the end at half the width that the robot needs.
        for (end, sign) in [(obstacle.left, 1.0), (obstacle.right, -1.0)] {
            let (sin, cos) = crate::math::sin_cos(end.pass_rad);
            let (x_m, y_m) = end.at.metres();
            let beside_m = sign * (x_m * sin - y_m * cos);
            assert!((beside_m - super::super::obstacle::PASS_M).abs() < 5e-3);
        }
    }

    #[test]
    fn points_with_room_between_them_are_two_obstacles() {
        let apart = remembered(&[(0.6, 0.0), (0.6, 0.4)]);
        let one = plan(&apart, None).obstacle.unwrap();
        assert_eq!(one.left.at, one.right.at);
        let together = remembered(&[(0.6, 0.0), (0.6, 0.22)]);
        let both = plan(&together, None).obstacle.unwrap();
        assert_ne!(both.left.at, both.right.at);
    }

    #[test]
    fn an_obstacle_that_reaches_around_the_robot_ends_beyond_half_a_turn() {
        // A pocket that is open to the back right.
        let pocket = remembered(&[
            (0.4, -0.1),
            (0.4, 0.1),
            (0.3, 0.3),
            (0.1, 0.4),
            (-0.1, 0.4),
            (-0.3, 0.3),
            (-0.4, 0.1),
            (-0.4, -0.1),
        ]);
        let obstacle = plan(&pocket, None).obstacle.unwrap();
        assert!(obstacle.left.pass_rad > core::f32::consts::PI);
        assert!(obstacle.right.pass_rad < 0.0);
    }

    #[test]
    fn another_obstacle_beside_the_end_is_passed_in_the_middle_of_the_gap() {
        let gap = remembered(&[(0.5, -0.2), (0.5, 0.0), (0.4, 0.275)]);
        let past_rad = plan(&gap, Some(Side::Left)).past_rad;
        // Past the end alone 0.347 rad, past the other on its right 0.244 rad.
        assert!((past_rad - 0.295).abs() < 0.01, "{past_rad}");
    }
}
