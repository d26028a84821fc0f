//! The body against the world: it stops and slips, it never passes through.
//!
//! The footprint is a rectangle. After each step the deepest overlap is undone along the face it entered: the body
//! shifts and turns as a free body pushed at that point would, so that it swings round to lie along a wall it meets at
//! an angle. What cannot be undone that way (a wedge) undoes the step. Touching wheels feel the drag of their own
//! slipping tyres.
//!
//! A body that moves is not stopped: it pushes the robot away, as an obstacle does that the robot enters. Between it and
//! a wall the robot stays where it is, and the body goes over it. Closing speeds are relative to the body's surface.
//!
//! A clearance, the distance to the nearest obstacle less the way gone since it was measured, spares all of this while
//! nothing is near. Where bodies move, so does the way that the fastest of them can have come.

use libm::sqrt;

use crate::outline::{Obstacle, Point, cross, dot, rectangle, sub};
use crate::params;
use crate::world::World;

pub use crate::outline::Pose;

/// Tyre on floor: sliding friction over load.
const TRACTION: f64 = 0.6;
/// m/s^2.
const GRAVITY: f64 = 9.81;
/// Only a body that has been this far away counts as touching again.
const LEAVE_M: f64 = 0.003;
/// Corners within this of the deepest share the push, so that a face that lands flat does not turn.
const FLAT_M: f64 = 2e-4;
/// A moving body pushes no farther at once: what it jams against a wall is not thrown through it.
const PUSH_M: f64 = 0.005;
/// Iterations that resolve overlaps, the deepest in each.
const ROUNDS: usize = 8;

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
    /// A bit for what stands (the lowest) and for each moving body, from a touch until the body has left it by a few
    /// millimetres.
    touched: u64,
    /// Touches so far.
    pub contacts: u32,
    /// Share of each wheel's motion (left, right) that the last step undid: 0 free, 1 blocked.
    pub blocked: [f64; 2],
    /// Dry friction of what holds each wheel (left, right), N m.
    pub held_n_m: [f64; 2],
}

/// The beginning of a touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impact {
    /// Index of the obstacle in the world; those of moving bodies follow those of obstacles that stand.
    pub obstacle: usize,
    /// Closing speed of the body's point that met it, relative to its surface.
    pub speed_m_s: f64,
}

impl State {
    /// True if nothing that moves can have come to a body at rest, in a step of this length: where it can, the step is to
    /// be settled.
    pub(crate) fn stays_clear(&mut self, world: &World, dt_s: f64) -> bool {
        let way_m = world.fastest_m_s() * dt_s;
        if world.bodies().is_empty() {
            return true;
        }
        if self.clearance_m > way_m {
            self.clearance_m -= way_m;
            return true;
        }
        false
    }

    /// True from a touch until the body has left by a few millimetres.
    #[must_use]
    pub const fn touching(&self) -> bool {
        self.touched != 0
    }
}

/// A step to settle.
#[derive(Clone, Copy, Debug)]
pub struct ContactStep<'a> {
    /// Where.
    pub world: &'a World,
    /// Its end.
    pub until_us: u64,
    /// How long it took.
    pub dt_s: f64,
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

/// What is nearest to the body.
struct Near {
    /// Index in the world, as in [`Impact`].
    obstacle: usize,
    gap: Gap,
    /// Velocity of the obstacle there.
    surface_m_s: Point,
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

    /// Dry friction that blocked and held wheels feel (left, right), N m.
    #[must_use]
    pub fn resistance_n_m(&self, state: &State) -> [f64; 2] {
        [
            state.blocked[0] * self.drag_n_m[0] + state.held_n_m[0],
            state.blocked[1] * self.drag_n_m[1] + state.held_n_m[1],
        ]
    }

    /// Distance from a body at `pose` to the nearest obstacle at an instant, at least; negative if it overlaps one.
    #[must_use]
    pub fn clearance_m(&self, world: &World, now_us: u64, pose: &Pose) -> f64 {
        self.nearest(world, now_us, pose)
            .map_or(f64::INFINITY, |near| near.gap.distance_m)
    }

    /// Settles a step from `before` to `pose`; returns the impact if a touch begins.
    pub fn settle(
        &self,
        step: &ContactStep<'_>,
        state: &mut State,
        before: &Pose,
        pose: &mut Pose,
    ) -> Option<Impact> {
        let way = [pose.x_m - before.x_m, pose.y_m - before.y_m];
        let turn_rad = pose.heading_rad - before.heading_rad;
        state.clearance_m -= way[0].abs() + way[1].abs() + self.reach_m * turn_rad.abs();
        state.clearance_m -= step.world.fastest_m_s() * step.dt_s;
        if state.clearance_m > 0.0 {
            return None;
        }
        self.settle_near(step, state, before, pose)
    }

    #[cold]
    pub(crate) fn settle_near(
        &self,
        step: &ContactStep<'_>,
        state: &mut State,
        before: &Pose,
        pose: &mut Pose,
    ) -> Option<Impact> {
        let &ContactStep {
            world, until_us, ..
        } = step;
        let wanted = *pose;
        let mut impact = None;
        let mut met = 0;
        for _ in 0..ROUNDS {
            match self.nearest(world, until_us, pose) {
                Some(near) if near.gap.distance_m < 0.0 => {
                    let bit = bit(world, near.obstacle);
                    let begins = state.touched & bit == 0;
                    if met == 0 || (begins && impact.is_none()) {
                        let closing_m = self.closing_m(before, &wanted, &near, step.dt_s);
                        impact = begins.then_some(Impact {
                            obstacle: near.obstacle,
                            speed_m_s: closing_m / step.dt_s,
                        });
                    }
                    met |= bit;
                    let depth_m = match bit {
                        1 => -near.gap.distance_m,
                        _ => PUSH_M.min(-near.gap.distance_m),
                    };
                    self.push(pose, &near.gap, depth_m + 1e-9);
                }
                _ => break,
            }
        }
        let mut clearance_m = self.clearance_m(world, until_us, pose);
        if clearance_m < 0.0 {
            *pose = *before;
            clearance_m = 0.0;
        }
        state.clearance_m = clearance_m;
        state.blocked = self.blocked(before, &wanted, pose);
        // Another touch that begins in the same step is reported in the next one.
        let known = impact.map_or(0, |impact| bit(world, impact.obstacle));
        state.touched |= known;
        if met == 0 && clearance_m > LEAVE_M {
            state.touched = 0;
        } else if !world.bodies().is_empty() {
            state.touched &= met | self.still_touched(world, until_us, pose, state.touched);
        }
        state.contacts += u32::from(impact.is_some());
        impact
    }

    /// Which of these touches the body has not left.
    fn still_touched(&self, world: &World, now_us: u64, pose: &Pose, touched: u64) -> u64 {
        let corners = self.corners(pose);
        let near = |obstacle: &Obstacle| gap(&corners, obstacle).distance_m <= LEAVE_M;
        let standing = touched & 1 != 0 && world.obstacles().iter().any(near);
        let bodies = world.bodies().iter().enumerate();
        bodies.fold(u64::from(standing), |still, (index, body)| {
            let bit = 2 << index;
            let touches = touched & bit != 0 && near(&body.outline(&body.at(now_us).pose));
            if touches { still | bit } else { still }
        })
    }

    fn nearest(&self, world: &World, now_us: u64, pose: &Pose) -> Option<Near> {
        let corners = self.corners(pose);
        let at = [pose.x_m, pose.y_m];
        // Farther than this without a look at faces.
        let bound_m = |center: Point, radius_m: f64| {
            let d = sub(center, at);
            sqrt(dot(d, d)) - radius_m - self.reach_m
        };
        let mut best: Option<Near> = None;
        let limit_m = |best: &Option<Near>| {
            best.as_ref()
                .map_or(f64::INFINITY, |near| near.gap.distance_m)
        };
        for (index, obstacle) in world.obstacles().iter().enumerate() {
            if bound_m(obstacle.center, obstacle.radius_m) < limit_m(&best) {
                let gap = gap(&corners, obstacle);
                if gap.distance_m < limit_m(&best) {
                    best = Some(Near {
                        obstacle: index,
                        gap,
                        surface_m_s: [0.0; 2],
                    });
                }
            }
        }
        for (index, body) in world.bodies().iter().enumerate() {
            let motion = body.at(now_us);
            let center = [motion.pose.x_m, motion.pose.y_m];
            if bound_m(center, body.radius_m()) < limit_m(&best) {
                let gap = gap(&corners, &body.outline(&motion.pose));
                if gap.distance_m < limit_m(&best) {
                    best = Some(Near {
                        obstacle: world.obstacles().len() + index,
                        surface_m_s: motion.surface_m_s(gap.at),
                        gap,
                    });
                }
            }
        }
        best
    }

    /// How far the body's point at the gap and the obstacle moved towards each other.
    fn closing_m(&self, before: &Pose, after: &Pose, near: &Near, dt_s: f64) -> f64 {
        let Near {
            gap, surface_m_s, ..
        } = near;
        let arm = sub(gap.at, [after.x_m, after.y_m]);
        let turn_rad = after.heading_rad - before.heading_rad;
        let moved = [
            after.x_m - before.x_m - turn_rad * arm[1] - surface_m_s[0] * dt_s,
            after.y_m - before.y_m + turn_rad * arm[0] - surface_m_s[1] * dt_s,
        ];
        let closing_m = -dot(moved, gap.normal);
        if closing_m > 0.0 { closing_m } else { 0.0 }
    }

    /// Undoes so much of an overlap as an impulse at its point would.
    fn push(&self, pose: &mut Pose, gap: &Gap, depth_m: f64) {
        let arm = cross(sub(gap.at, [pose.x_m, pose.y_m]), gap.normal);
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

/// The bit of an obstacle in [`State`].
fn bit(world: &World, obstacle: usize) -> u64 {
    match obstacle.checked_sub(world.obstacles().len()) {
        None => 1,
        Some(body) => 2 << body,
    }
}

/// The axis, among all face normals of both, along which body and obstacle are farthest apart.
fn gap(body: &[Point], obstacle: &Obstacle) -> Gap {
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
        let along = sub(body[(i + 1) % body.len()], start);
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
