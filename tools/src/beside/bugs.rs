//! Three planners of the Bug family with ranges: Bug2 (Lumelsky and Stepanov 1987), DistBug (Kamon and Rivlin 1997) and
//! TangentBug (Kamon, Rimon and Rivlin 1998). Each drives at the goal until something is in the way, follows its boundary,
//! and leaves it by a rule of its own; once around without that, there is no way.

use super::disc::{Planner, RADIUS_M, RAYS, REACH_M, Seen, Step, along_boundary, ray_rad, wrapped};
use rumbo_plant::world::Point;

/// Something is in the way within this [m].
const AHEAD_M: f64 = 0.08;
/// Progress that counts [m].
const GAIN_M: f64 = 0.05;
/// A boundary is followed for so long at least before a nearer end is taken [m].
const FOLLOWED_M: f64 = 0.2;
/// A way by an end that has grown no shorter for so long is at its shortest [m].
const STALLED_M: f64 = 0.5;
/// The lap is counted from where the boundary was first so near [m].
const NEAR_M: f64 = 0.23;
/// Back where a boundary was met: within, having been farther away than twice that, after such a way [m].
const BACK_M: f64 = 0.15;
const LAP_M: f64 = 0.8;

/// A boundary that is followed.
#[derive(Clone, Copy)]
struct Boundary {
    /// With the obstacle on the right.
    left: bool,
    met: Point,
    /// Distance to the goal where it was met, and the least since [m].
    met_m: f64,
    least_m: f64,
    /// The least distance from the goal to what was seen of the obstacle [m].
    seen_m: f64,
    way_m: f64,
    last: Point,
    /// It has been near the boundary, and away from where that was.
    near: bool,
    away: bool,
    /// Left of the line from the start to the goal, there and now [m].
    off_m: f64,
}

impl Boundary {
    fn new(seen: &Seen, left: bool, off_m: f64) -> Self {
        let met_m = seen.distance_m(seen.goal);
        Self {
            left,
            met: seen.at,
            met_m,
            least_m: met_m,
            seen_m: f64::INFINITY,
            way_m: 0.0,
            last: seen.at,
            near: false,
            away: false,
            off_m,
        }
    }

    /// One step; whether it has led once around.
    fn is_round(&mut self, seen: &Seen) -> bool {
        self.way_m += seen.distance_m(self.last);
        self.last = seen.at;
        self.least_m = self.least_m.min(seen.distance_m(seen.goal));
        if !self.near && seen.nearest().1 < NEAR_M {
            self.near = true;
            (self.met, self.way_m) = (seen.at, 0.0);
        }
        let from_m = seen.distance_m(self.met);
        self.away |= from_m > 2.0 * BACK_M;
        self.near && self.away && self.way_m > LAP_M && from_m < BACK_M
    }
}

/// The straight way is blocked.
fn is_blocked(seen: &Seen) -> bool {
    let goal_m = seen.distance_m(seen.goal);
    seen.clear_m(seen.bearing_rad(seen.goal)) < AHEAD_M.min(goal_m)
}

/// Whether the way with the obstacle on the right turns away from the goal by less.
fn turns_less_left(seen: &Seen) -> bool {
    let (ray, _) = seen.nearest();
    wrapped(seen.bearing_rad(seen.goal) - ray_rad(ray)) >= 0.0
}

/// Leaves on the line from the start to the goal, nearer to the goal than where it came upon the boundary.
#[derive(Default)]
pub(super) struct Bug2 {
    start: Option<Point>,
    boundary: Option<Boundary>,
}

impl Planner for Bug2 {
    fn step(&mut self, seen: &Seen) -> Step {
        let [sx, sy] = *self.start.get_or_insert(seen.at);
        let (dx, dy) = (seen.goal[0] - sx, seen.goal[1] - sy);
        let off_m = (dx * (seen.at[1] - sy) - dy * (seen.at[0] - sx)) / dx.hypot(dy);
        let goal_rad = seen.bearing_rad(seen.goal);
        let Some(boundary) = &mut self.boundary else {
            if is_blocked(seen) {
                self.boundary = Some(Boundary::new(seen, true, off_m));
            }
            return Step::Towards(goal_rad);
        };
        let crosses = (off_m > 0.0) != (boundary.off_m > 0.0) || off_m.abs() < 0.01;
        boundary.off_m = off_m;
        let nearer = seen.distance_m(seen.goal) < boundary.met_m - GAIN_M;
        if crosses && nearer && seen.clear_m(goal_rad) > 2.0 * AHEAD_M {
            self.boundary = None;
            return Step::Towards(goal_rad);
        }
        if boundary.is_round(seen) {
            return Step::Unreachable;
        }
        Step::Towards(along_boundary(seen, boundary.left))
    }
}

/// Leaves where what is seen to be free leads nearer to the goal than the boundary ever did.
#[derive(Default)]
pub(super) struct DistBug {
    boundary: Option<Boundary>,
}

impl Planner for DistBug {
    fn step(&mut self, seen: &Seen) -> Step {
        let goal_rad = seen.bearing_rad(seen.goal);
        let Some(boundary) = &mut self.boundary else {
            if is_blocked(seen) {
                self.boundary = Some(Boundary::new(seen, turns_less_left(seen), 0.0));
            }
            return Step::Towards(goal_rad);
        };
        let round = boundary.is_round(seen);
        let goal_m = seen.distance_m(seen.goal);
        let free_m = seen.clear_m(goal_rad);
        if free_m >= goal_m || goal_m - free_m < boundary.least_m - 4.0 * GAIN_M {
            self.boundary = None;
            return Step::Towards(goal_rad);
        }
        if round {
            return Step::Unreachable;
        }
        Step::Towards(along_boundary(seen, boundary.left))
    }
}

/// Drives at the end of the obstacle by which the way is shortest, follows the boundary once that way grows, and leaves
/// where something that it sees is nearer to the goal than all of the boundary.
#[derive(Default)]
pub(super) struct TangentBug {
    boundary: Option<Boundary>,
    /// The shortest way by an end since the last boundary, and what was driven since that grew shorter [m].
    least_m: Option<f64>,
    driven_m: f64,
    last: Option<Point>,
    /// The least distance from the goal to what was seen of all boundaries [m].
    seen_m: Option<f64>,
}

/// An end of what is seen.
struct End {
    /// The direction that just passes it [rad].
    past_rad: f64,
    at: Point,
    /// It is passed on its left.
    left: bool,
}

/// Where ranges jump, by as much as lets the disc pass.
fn ends(seen: &Seen) -> Vec<End> {
    let mut ends = Vec::new();
    for ray in 0..RAYS {
        let next = (ray + 1) % RAYS;
        let (here_m, there_m) = (seen.ranges_m[ray], seen.ranges_m[next]);
        if (here_m - there_m).abs() < 2.0 * RADIUS_M {
            continue;
        }
        let (near, left) = if here_m < there_m {
            (ray, true)
        } else {
            (next, false)
        };
        let near_m = seen.ranges_m[near];
        let off_rad = ((RADIUS_M + 0.04) / near_m).min(1.0).asin();
        ends.push(End {
            past_rad: ray_rad(near) + if left { off_rad } else { -off_rad },
            at: seen.along(ray_rad(near), near_m),
            left,
        });
    }
    ends
}

/// Least distance from the goal to what is seen of the obstacle that is nearest [m].
fn obstacle_m(seen: &Seen) -> f64 {
    let (nearest, _) = seen.nearest();
    let to_goal_m = |at: Point| (at[0] - seen.goal[0]).hypot(at[1] - seen.goal[1]);
    let mut least_m = seen.hit(nearest).map_or(f64::INFINITY, to_goal_m);
    for step in [1, RAYS - 1] {
        let (mut ray, mut last_m) = (nearest, seen.ranges_m[nearest]);
        for _ in 1..RAYS {
            ray = (ray + step) % RAYS;
            if seen.ranges_m[ray] >= REACH_M || (seen.ranges_m[ray] - last_m).abs() > 2.0 * RADIUS_M
            {
                break;
            }
            last_m = seen.ranges_m[ray];
            least_m = seen
                .hit(ray)
                .map_or(least_m, |at| least_m.min(to_goal_m(at)));
        }
    }
    least_m
}

impl Planner for TangentBug {
    fn step(&mut self, seen: &Seen) -> Step {
        let (goal_m, goal_rad) = (seen.distance_m(seen.goal), seen.bearing_rad(seen.goal));
        let free_m = seen.clear_m(goal_rad);
        let open = free_m >= goal_m.min(REACH_M - RADIUS_M);
        let to_goal_m = |at: Point| (at[0] - seen.goal[0]).hypot(at[1] - seen.goal[1]);
        let ends = ends(seen);
        self.driven_m += self.last.map_or(0.0, |last| seen.distance_m(last));
        self.last = Some(seen.at);
        if let Some(boundary) = &mut self.boundary {
            let round = boundary.is_round(seen);
            boundary.seen_m = boundary.seen_m.min(obstacle_m(seen));
            let passable = ends
                .iter()
                .filter(|end| seen.clear_m(end.past_rad) > seen.distance_m(end.at));
            let reach_m = passable
                .map(|end| to_goal_m(end.at))
                .fold(goal_m - free_m, f64::min);
            let nearer = reach_m < boundary.seen_m - GAIN_M && boundary.way_m > FOLLOWED_M;
            if free_m >= goal_m || nearer {
                // The next boundary is left for something nearer only.
                self.seen_m = Some(boundary.seen_m.min(reach_m));
                self.boundary = None;
                self.least_m = None;
                self.driven_m = 0.0;
                return Step::Towards(goal_rad);
            }
            if round {
                return Step::Unreachable;
            }
            return Step::Towards(along_boundary(seen, boundary.left));
        }
        if open {
            self.least_m = None;
            self.driven_m = 0.0;
            return Step::Towards(goal_rad);
        }
        let way_m = |end: &End| seen.distance_m(end.at) + to_goal_m(end.at);
        let best = ends
            .iter()
            .min_by(|one, other| way_m(one).total_cmp(&way_m(other)));
        let least_m = self.least_m.unwrap_or(f64::INFINITY);
        match best {
            Some(end) if self.driven_m < STALLED_M && seen.clear_m(end.past_rad) > AHEAD_M => {
                if way_m(end) < least_m - 0.5 * GAIN_M {
                    self.least_m = Some(way_m(end));
                    self.driven_m = 0.0;
                }
                Step::Towards(end.past_rad)
            }
            _ => {
                let left = best.map_or_else(|| turns_less_left(seen), |end| end.left);
                let mut boundary = Boundary::new(seen, left, 0.0);
                boundary.seen_m = self.seen_m.unwrap_or(f64::INFINITY);
                self.boundary = Some(boundary);
                Step::Towards(along_boundary(seen, left))
            }
        }
    }
}
