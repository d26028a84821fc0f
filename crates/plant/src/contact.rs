//! The body against the world: it stops and slips, it never passes through.
//!
//! The footprint is a rectangle. After each step the deepest overlap is undone along the face it entered: the body
//! shifts and turns as a free body pushed at that point would, so that it swings round to lie along a wall it meets at
//! an angle. What cannot be undone that way (a wedge) undoes the step. Touching wheels feel the drag of their own
//! slipping tyres.
//!
//! A clearance, the distance to the nearest obstacle less the way gone since it was measured, spares all of this while
//! nothing is near.

use libm::sqrt;

use crate::params;
use crate::world::{Obstacle, Point, World, cross, dot, rectangle, sub};

/// Tyre on floor: sliding friction over load.
const TRACTION: f64 = 0.6;
/// m/s^2.
const GRAVITY: f64 = 9.81;
/// Only a body that has been this far away counts as touching again.
const LEAVE_M: f64 = 0.003;
/// Corners within this of the deepest share the push, so that a face that lands flat does not turn.
const FLAT_M: f64 = 2e-4;
/// Iterations that resolve overlaps, the deepest in each.
const ROUNDS: usize = 8;

/// Position and heading of the middle of the wheels' axis in the world.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pose {
    /// World x.
    pub x_m: f64,
    /// World y.
    pub y_m: f64,
    /// Counter-clockwise from the world's x axis.
    pub heading_rad: f64,
}

/// The body as contact sees it: footprint, mass, wheels.
#[derive(Clone, Copy, Debug)]
pub struct Footprint {
    half_m: [f64; 2],
    ahead_m: f64,
    /// Farthest corner from the middle of the axis.
    pub(crate) reach_m: f64,
    inverse_mass: f64,
    inverse_inertia: f64,
    half_base_m: f64,
    /// Torque at each wheel with its tyre sliding.
    drag_n_m: [f64; 2],
}

/// State of the contact, kept from step to step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    /// At least this far from any obstacle.
    pub clearance_m: f64,
    /// True from a touch until the body has left by a few millimetres.
    pub touching: bool,
    /// Touches so far.
    pub contacts: u32,
    /// Share of each wheel's motion (left, right) that the last step undid: 0 free, 1 blocked.
    pub blocked: [f64; 2],
}

/// The beginning of a touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impact {
    /// Index of the obstacle in the world.
    pub obstacle: usize,
    /// Closing speed of the body's point that met it.
    pub speed_m_s: f64,
}

/// Two convex outlines along the axis that separates them most.
struct Gap {
    /// Separation; negative is the depth of the overlap.
    distance_m: f64,
    /// From the obstacle to the body.
    normal: Point,
    /// Where they are nearest (or deepest).
    at: Point,
}

impl Footprint {
    /// The footprint of a robot.
    #[must_use]
    pub fn new(body: &params::Body, wheels: &params::Wheels) -> Self {
        let half_m = [0.5 * body.length_m, 0.5 * body.width_m];
        let ahead_m = body.centre_ahead_m;
        let far = half_m[0] + ahead_m.abs();
        let load_n = 0.5 * body.mass_kg * GRAVITY;
        Self {
            half_m,
            ahead_m,
            reach_m: sqrt(far * far + half_m[1] * half_m[1]),
            inverse_mass: 1.0 / body.mass_kg,
            inverse_inertia: 1.0 / body.yaw_inertia_kg_m2,
            half_base_m: 0.5 * body.base_m,
            drag_n_m: [&wheels.left, &wheels.right].map(|wheel| TRACTION * load_n * wheel.radius_m),
        }
    }

    /// Corners in the world, counter-clockwise from front left.
    #[must_use]
    pub fn corners(&self, pose: &Pose) -> [Point; 4] {
        rectangle(
            self.half_m,
            [self.ahead_m, 0.0],
            [pose.x_m, pose.y_m],
            pose.heading_rad,
        )
    }

    /// Dry friction that blocked wheels feel (left, right), N m.
    #[must_use]
    pub fn resistance_n_m(&self, state: &State) -> [f64; 2] {
        [
            state.blocked[0] * self.drag_n_m[0],
            state.blocked[1] * self.drag_n_m[1],
        ]
    }

    /// Distance from a body at `pose` to the nearest obstacle, at least; negative if it overlaps one.
    #[must_use]
    pub fn clearance_m(&self, world: &World, pose: &Pose) -> f64 {
        self.nearest(world, pose)
            .map_or(f64::INFINITY, |(_, gap)| gap.distance_m)
    }

    /// Settles a step from `before` to `pose` that took `dt_s`; returns the impact if a touch begins.
    pub fn settle(
        &self,
        world: &World,
        state: &mut State,
        before: &Pose,
        pose: &mut Pose,
        dt_s: f64,
    ) -> Option<Impact> {
        let way = [pose.x_m - before.x_m, pose.y_m - before.y_m];
        let turn_rad = pose.heading_rad - before.heading_rad;
        state.clearance_m -= way[0].abs() + way[1].abs() + self.reach_m * turn_rad.abs();
        if state.clearance_m > 0.0 {
            return None;
        }
        self.settle_near(world, state, before, pose, dt_s)
    }

    #[cold]
    pub(crate) fn settle_near(
        &self,
        world: &World,
        state: &mut State,
        before: &Pose,
        pose: &mut Pose,
        dt_s: f64,
    ) -> Option<Impact> {
        let wanted = *pose;
        let mut impact = None;
        for _ in 0..ROUNDS {
            match self.nearest(world, pose) {
                Some((obstacle, gap)) if gap.distance_m < 0.0 => {
                    if impact.is_none() {
                        let speed_m_s = self.closing_m(before, &wanted, &gap) / dt_s;
                        impact = Some(Impact {
                            obstacle,
                            speed_m_s,
                        });
                    }
                    self.push(pose, &gap);
                }
                _ => break,
            }
        }
        let mut clearance_m = self.clearance_m(world, pose);
        if clearance_m < 0.0 {
            *pose = *before;
            clearance_m = 0.0;
        }
        state.clearance_m = clearance_m;
        state.blocked = self.blocked(before, &wanted, pose);
        let begins = impact.is_some() && !state.touching;
        if impact.is_some() {
            state.touching = true;
        } else if clearance_m > LEAVE_M {
            state.touching = false;
        }
        state.contacts += u32::from(begins);
        impact.filter(|_| begins)
    }

    fn nearest(&self, world: &World, pose: &Pose) -> Option<(usize, Gap)> {
        let corners = self.corners(pose);
        let mut best: Option<(usize, Gap)> = None;
        for (index, obstacle) in world.obstacles().iter().enumerate() {
            let limit_m = best
                .as_ref()
                .map_or(f64::INFINITY, |(_, gap)| gap.distance_m);
            let d = sub(obstacle.center, [pose.x_m, pose.y_m]);
            if sqrt(dot(d, d)) - obstacle.radius_m - self.reach_m < limit_m {
                let gap = gap(&corners, obstacle);
                if gap.distance_m < limit_m {
                    best = Some((index, gap));
                }
            }
        }
        best
    }

    /// How far the body's point at the gap moved towards the obstacle.
    fn closing_m(&self, before: &Pose, after: &Pose, gap: &Gap) -> f64 {
        let arm = sub(gap.at, [after.x_m, after.y_m]);
        let turn_rad = after.heading_rad - before.heading_rad;
        let moved = [
            after.x_m - before.x_m - turn_rad * arm[1],
            after.y_m - before.y_m + turn_rad * arm[0],
        ];
        let closing_m = -dot(moved, gap.normal);
        if closing_m > 0.0 { closing_m } else { 0.0 }
    }

    /// Undoes an overlap as an impulse at its point would.
    fn push(&self, pose: &mut Pose, gap: &Gap) {
        let arm = cross(sub(gap.at, [pose.x_m, pose.y_m]), gap.normal);
        let depth_m = -gap.distance_m + 1e-9;
        let impulse = depth_m / (self.inverse_mass + arm * arm * self.inverse_inertia);
        pose.x_m += impulse * self.inverse_mass * gap.normal[0];
        pose.y_m += impulse * self.inverse_mass * gap.normal[1];
        pose.heading_rad += impulse * self.inverse_inertia * arm;
    }

    /// Share of each wheel's motion that was undone.
    fn blocked(&self, before: &Pose, wanted: &Pose, got: &Pose) -> [f64; 2] {
        let ahead = [libm::cos(before.heading_rad), libm::sin(before.heading_rad)];
        let wheel_m = |from: &Pose, to: &Pose, side: f64| {
            dot([to.x_m - from.x_m, to.y_m - from.y_m], ahead)
                + side * self.half_base_m * (to.heading_rad - from.heading_rad)
        };
        [-1.0, 1.0].map(|side| {
            let (asked_m, got_m) = (wheel_m(before, wanted, side), wheel_m(before, got, side));
            if asked_m == 0.0 {
                0.0
            } else {
                (1.0 - got_m / asked_m).clamp(0.0, 1.0)
            }
        })
    }
}

/// The axis, among all face normals of both, along which body and obstacle are farthest apart.
fn gap(body: &[Point; 4], obstacle: &Obstacle) -> Gap {
    let mut best = Gap {
        distance_m: f64::NEG_INFINITY,
        normal: [1.0, 0.0],
        at: body[0],
    };
    for face in &obstacle.faces {
        let (distance_m, at) = lowest(body.iter().copied(), face.start, face.normal);
        if distance_m > best.distance_m {
            best = Gap {
                distance_m,
                normal: face.normal,
                at,
            };
        }
    }
    for (i, &start) in body.iter().enumerate() {
        let along = sub(body[(i + 1) % 4], start);
        let length_m = sqrt(dot(along, along));
        let normal = [along[1] / length_m, -along[0] / length_m];
        let (distance_m, at) = lowest(obstacle.corners(), start, normal);
        if distance_m > best.distance_m {
            best = Gap {
                distance_m,
                normal: [-normal[0], -normal[1]],
                at,
            };
        }
    }
    best
}

/// Height of the lowest point over the line through `start`, and the middle of all that are about as low.
fn lowest(
    points: impl Iterator<Item = Point> + Clone,
    start: Point,
    normal: Point,
) -> (f64, Point) {
    let height_m = |point: Point| dot(sub(point, start), normal);
    let lowest_m = points
        .clone()
        .map(height_m)
        .fold(f64::INFINITY, |a, b| if b < a { b } else { a });
    let (mut sum, mut n) = ([0.0, 0.0], 0.0);
    for point in points {
        if height_m(point) <= lowest_m + FLAT_M {
            sum = [sum[0] + point[0], sum[1] + point[1]];
            n += 1.0;
        }
    }
    (lowest_m, [sum[0] / n, sum[1] / n])
}
