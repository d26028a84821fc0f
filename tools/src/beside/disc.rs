//! The robot of the planners: a disc that knows where it is and how far everything around it is.

use rumbo_experiment::shortest_path::Floor;
use rumbo_plant::world::{Point, World};
use std::f64::consts::{PI, TAU};

/// Rays all around, the first along x.
pub(super) const RAYS: usize = 90;
/// How far they see [m]: a sonar's reach.
pub(super) const REACH_M: f64 = 2.5;
/// Radius of the circle in which the robot turns [m], which nothing may come into.
pub(super) const RADIUS_M: f64 = 0.15;
/// From step to step [s].
const STEP_S: f64 = 0.05;
/// Top speed, turn rate, and the turn rate per heading error [m/s, rad/s, 1/s]: mode 8's.
pub(super) const TOP_M_S: f64 = 0.4;
const TURN_RAD_S: f64 = 3.0;
const STEERING: f64 = 4.0;
/// A robot whose heading is off by this stands [rad].
const STANDS_RAD: f64 = 1.0;
/// At the goal within [m].
const ARRIVED_M: f64 = 0.04;
/// A run has an end [s]: mode 8's.
const MOST_S: f64 = 185.0;

/// What a planner is told.
pub(super) struct Seen {
    pub at: Point,
    pub heading_rad: f64,
    pub goal: Point,
    /// Distances in the directions of [`ray_rad`], at most [`REACH_M`].
    pub ranges_m: [f64; RAYS],
}

/// What it says.
pub(super) enum Step {
    /// Drive there [rad].
    Towards(f64),
    /// There is no way.
    Unreachable,
}

/// A planner, from its start on.
pub(super) trait Planner {
    fn step(&mut self, seen: &Seen) -> Step;
}

/// What became of a run.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Outcome {
    pub reached: bool,
    pub unreachable: bool,
    pub touched: bool,
    pub time_s: f64,
    pub way_m: f64,
}

/// Direction of a ray [rad].
pub(super) fn ray_rad(ray: usize) -> f64 {
    TAU * ray as f64 / RAYS as f64
}

/// An angle from -pi to pi [rad].
pub(super) fn wrapped(angle_rad: f64) -> f64 {
    angle_rad - TAU * (angle_rad / TAU).round()
}

impl Seen {
    /// From here to a point [m].
    pub(super) fn distance_m(&self, [x, y]: Point) -> f64 {
        (x - self.at[0]).hypot(y - self.at[1])
    }

    /// Direction of a point [rad].
    pub(super) fn bearing_rad(&self, [x, y]: Point) -> f64 {
        (y - self.at[1]).atan2(x - self.at[0])
    }

    /// The point that a ray hits, if it hits one.
    pub(super) fn hit(&self, ray: usize) -> Option<Point> {
        (self.ranges_m[ray] < REACH_M).then(|| self.along(ray_rad(ray), self.ranges_m[ray]))
    }

    /// The point so far away in a direction.
    pub(super) fn along(&self, angle_rad: f64, way_m: f64) -> Point {
        let (sin, cos) = angle_rad.sin_cos();
        [self.at[0] + way_m * cos, self.at[1] + way_m * sin]
    }

    /// How far the disc, a little larger, gets straight on in a direction [m].
    pub(super) fn clear_m(&self, angle_rad: f64) -> f64 {
        let half_m = RADIUS_M + 0.01;
        let hits = (0..RAYS).filter(|&ray| self.ranges_m[ray] < REACH_M);
        let along_m = hits.filter_map(|ray| {
            let (sin, cos) = (ray_rad(ray) - angle_rad).sin_cos();
            let (along_m, across_m) = (self.ranges_m[ray] * cos, self.ranges_m[ray] * sin);
            let room_m = half_m * half_m - across_m * across_m;
            (along_m > 0.0 && room_m > 0.0).then(|| (along_m - room_m.sqrt()).max(0.0))
        });
        along_m.fold(REACH_M, f64::min)
    }

    /// The nearest hit: its ray and its distance [m].
    pub(super) fn nearest(&self) -> (usize, f64) {
        let rays = self.ranges_m.iter().copied().enumerate();
        rays.min_by(|one, other| one.1.total_cmp(&other.1))
            .unwrap_or((0, REACH_M))
    }
}

/// Distance from a point in a direction to the first outline [m].
fn range_m(outlines: &[Vec<Point>], [x, y]: Point, angle_rad: f64) -> f64 {
    let (sin, cos) = angle_rad.sin_cos();
    let mut nearest_m = REACH_M;
    for corners in outlines {
        for (index, &[ax, ay]) in corners.iter().enumerate() {
            let [bx, by] = corners[(index + 1) % corners.len()];
            // Along the ray, and to the left of it.
            let (a_left, b_left) = (
                (ay - y) * cos - (ax - x) * sin,
                (by - y) * cos - (bx - x) * sin,
            );
            if (a_left > 0.0) == (b_left > 0.0) {
                continue;
            }
            let part = a_left / (a_left - b_left);
            let along_m = (ax + part * (bx - ax) - x) * cos + (ay + part * (by - ay) - y) * sin;
            if along_m > 0.0 && along_m < nearest_m {
                nearest_m = along_m;
            }
        }
    }
    nearest_m
}

/// Drives a planner from a start, looking along x, to a goal.
pub(super) fn drive(
    planner: &mut dyn Planner,
    world: &World,
    start: Point,
    goal: Point,
) -> Outcome {
    let outlines: Vec<Vec<Point>> = world
        .obstacles()
        .iter()
        .map(|obstacle| obstacle.corners().collect())
        .collect();
    let floor = Floor::grown(world, RADIUS_M);
    let mut outcome = Outcome::default();
    let (mut at, mut heading_rad) = (start, 0.0_f64);
    while outcome.time_s < MOST_S {
        let seen = Seen {
            at,
            heading_rad,
            goal,
            ranges_m: std::array::from_fn(|ray| range_m(&outlines, at, ray_rad(ray))),
        };
        let left_m = seen.distance_m(goal);
        if left_m < ARRIVED_M {
            outcome.reached = true;
            break;
        }
        let towards_rad = match planner.step(&seen) {
            Step::Towards(towards_rad) => towards_rad,
            Step::Unreachable => {
                outcome.unreachable = true;
                break;
            }
        };
        let error_rad = wrapped(towards_rad - heading_rad);
        let turn_rad = (STEERING * error_rad).clamp(-TURN_RAD_S, TURN_RAD_S) * STEP_S;
        let share = (1.0 - error_rad.abs() / STANDS_RAD).max(0.0);
        // It stops before what is ahead of it.
        let most_m = left_m.min(seen.clear_m(heading_rad));
        let way_m = (TOP_M_S * STEP_S * share).min(most_m);
        heading_rad = wrapped(heading_rad + turn_rad);
        let next = seen.along(heading_rad - 0.5 * turn_rad, way_m);
        if floor.admits(next) {
            at = next;
            outcome.way_m += way_m;
        } else {
            // It stands where it would touch, and may turn.
            outcome.touched = true;
        }
        outcome.time_s += STEP_S;
    }
    outcome
}

/// Along what is nearest, with that on the right where `left`, else on the left; farther round where something is ahead
/// [rad].
pub(super) fn along_boundary(seen: &Seen, left: bool) -> f64 {
    /// Distance kept, heading per error of it and the most of that [m, rad/m, rad].
    const KEEP_M: f64 = 0.19;
    const PER_M: f64 = 5.0;
    const MOST_RAD: f64 = 0.9;
    /// What must be clear ahead, and steps by which the way there is looked for [m, rad].
    const CLEAR_M: f64 = 0.06;
    const ROUND_RAD: f64 = TAU / 36.0;
    let (ray, near_m) = seen.nearest();
    let towards_rad = (PER_M * (near_m - KEEP_M)).clamp(-MOST_RAD, MOST_RAD);
    let side = if left { 1.0 } else { -1.0 };
    let first_rad = ray_rad(ray) + side * (0.5 * PI - towards_rad);
    (0..36)
        .map(|step| first_rad + side * ROUND_RAD * f64::from(step))
        .find(|towards_rad| seen.clear_m(*towards_rad) > CLEAR_M)
        .unwrap_or(first_rad)
}
