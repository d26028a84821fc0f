//! The echo in a sonar's beam: the exact nearest echo in a cone, not a fan of sampled rays.
//!
//! For a convex obstacle the nearest point inside the cone is its closest point to the apex if that lies inside the
//! cone, and otherwise the nearer hit of the cone's two edge rays: the distance is convex, so an optimum that the cone
//! cuts off moves to the cone's boundary.
//!
//! Sound comes back from a point if one of the faces there is turned to the apex by no more than the incidence limit.
//! A face turned further mirrors the burst away, but its corners still scatter a little: they return an echo up to a
//! shorter reach. A point counts only if no other obstacle stands between it and the apex, so a slanted face that gives
//! no echo hides what is behind it.

use libm::{acos, cos, sincos, sqrt};

use crate::outline::{Obstacle, Point, add, cross, dot, scale, sub};
use crate::world::World;

/// More than rounding moves a corner.
const ROUNDING_M: f64 = 1e-9;

/// A cone on the floor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// Position of the transducer.
    pub apex: Point,
    /// Its direction, counter-clockwise from the world's x axis.
    pub axis_rad: f64,
    /// Half of the opening, in (0, pi/2).
    pub half_angle_rad: f64,
}

/// What a sonar can detect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hearing {
    /// Longest range of a face.
    pub reach_m: f64,
    /// Largest angle between a face's normal and the direction to the apex that still returns sound.
    pub incidence_limit_rad: f64,
    /// Longest range of a corner whose faces are turned away.
    pub corner_reach_m: f64,
}

impl Hearing {
    /// Detects everything up to a distance, whatever its angle: pure geometry.
    #[must_use]
    pub const fn geometric(reach_m: f64) -> Self {
        Self {
            reach_m,
            incidence_limit_rad: core::f64::consts::PI,
            corner_reach_m: reach_m,
        }
    }
}

/// The point an echo comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Return {
    /// Distance from the apex.
    pub range_m: f64,
    /// Smallest angle between the direction to the apex and the normal of a face at that point.
    pub incidence_rad: f64,
    /// True at a corner, false inside a face.
    pub corner: bool,
}

/// A cone with its edge rays precomputed, and what it can detect.
struct Query {
    apex: Point,
    right: Point,
    left: Point,
    hearing: Hearing,
    /// cos of the incidence limit.
    facing: f64,
}

/// A possible echo of one obstacle.
#[derive(Clone, Copy)]
struct Candidate {
    at: Point,
    range_m: f64,
    /// cos of the incidence.
    facing: f64,
    corner: bool,
}

/// The nearest echo in the cone at an instant, `None` without one.
#[must_use]
pub fn nearest(world: &World, now_us: u64, cone: &Cone, hearing: &Hearing) -> Option<Return> {
    let echo = candidate(world, now_us, cone, hearing)?;
    Some(Return {
        range_m: echo.range_m,
        incidence_rad: acos(echo.facing.clamp(-1.0, 1.0)),
        corner: echo.corner,
    })
}

/// The range of [`nearest`].
pub(crate) fn nearest_m(world: &World, now_us: u64, cone: &Cone, hearing: &Hearing) -> Option<f64> {
    candidate(world, now_us, cone, hearing).map(|echo| echo.range_m)
}

fn candidate(world: &World, now_us: u64, cone: &Cone, hearing: &Hearing) -> Option<Candidate> {
    let edge = |angle_rad: f64| {
        let (s, c) = sincos(angle_rad);
        [c, s]
    };
    let query = Query {
        apex: cone.apex,
        right: edge(cone.axis_rad - cone.half_angle_rad),
        left: edge(cone.axis_rad + cone.half_angle_rad),
        hearing: *hearing,
        facing: cos(hearing.incidence_limit_rad.min(core::f64::consts::PI)),
    };
    let mut best: Option<Candidate> = None;
    let mut limit_m = hearing.reach_m;
    // What is outside the cone gives no echo, and hides none.
    let moving = world.outlines(now_us, |center, radius_m| {
        query.may_meet(center, radius_m + ROUNDING_M, hearing.reach_m)
    });
    let obstacles = world.obstacles().iter().chain(&moving);
    for (index, obstacle) in obstacles.clone().enumerate() {
        if !query.may_detect(obstacle, limit_m) {
            continue;
        }
        if obstacle.contains(cone.apex) {
            return Some(Candidate {
                at: cone.apex,
                range_m: 0.0,
                facing: 1.0,
                corner: false,
            });
        }
        query.candidates(obstacle, |candidate| {
            // Both faces at a corner propose it: the one that faces the apex more counts.
            let better = candidate.range_m < limit_m
                || best.is_none_or(|best| {
                    candidate.range_m == limit_m && candidate.facing > best.facing
                });
            if better
                && candidate.range_m <= limit_m
                && query.hears(&candidate)
                && !hidden(obstacles.clone(), index, cone.apex, &candidate)
            {
                limit_m = candidate.range_m;
                best = Some(candidate);
            }
        });
    }
    best
}

impl Query {
    /// Bounding-circle test against the cone's two edges and the range to beat.
    fn may_detect(&self, obstacle: &Obstacle, limit_m: f64) -> bool {
        self.may_meet(obstacle.center, obstacle.radius_m, limit_m)
    }

    /// The same of any circle.
    fn may_meet(&self, center: Point, r: f64, limit_m: f64) -> bool {
        let d = sub(center, self.apex);
        let far = limit_m + r;
        cross(self.right, d) >= -r && cross(d, self.left) >= -r && dot(d, d) <= far * far
    }

    fn in_cone(&self, v: Point) -> bool {
        cross(self.right, v) >= 0.0 && cross(v, self.left) >= 0.0
    }

    fn hears(&self, candidate: &Candidate) -> bool {
        candidate.facing >= self.facing
            || (candidate.corner && candidate.range_m <= self.hearing.corner_reach_m)
    }

    /// Every point of an obstacle that could be its nearest echo: for each face turned to the apex its closest point
    /// and its two corners, if they are inside the cone, and where the edge rays hit it.
    fn candidates(&self, obstacle: &Obstacle, mut visit: impl FnMut(Candidate)) {
        for face in &obstacle.faces {
            let height_m = face.height_m(self.apex);
            if height_m < 0.0 {
                continue;
            }
            let foot = dot(sub(self.apex, face.start), face.along);
            let mut at_point = |at: Point, corner: bool| {
                let v = sub(at, self.apex);
                let range_m = sqrt(dot(v, v));
                visit(Candidate {
                    at,
                    range_m,
                    // height / range is the cosine between the face's normal and the way back; touching is facing.
                    facing: if range_m > 0.0 {
                        height_m / range_m
                    } else {
                        1.0
                    },
                    corner,
                });
            };
            if foot > 0.0 && foot < face.length_m {
                let at = add(face.start, scale(face.along, foot));
                if self.in_cone(sub(at, self.apex)) {
                    at_point(at, false);
                    continue;
                }
            }
            for at in [face.start, face.end()] {
                if self.in_cone(sub(at, self.apex)) {
                    at_point(at, true);
                }
            }
            for ray in [self.right, self.left] {
                let closing = -dot(ray, face.normal);
                if closing > 0.0 {
                    let along = foot + height_m / closing * dot(ray, face.along);
                    if (0.0..=face.length_m).contains(&along) {
                        at_point(add(face.start, scale(face.along, along)), false);
                    }
                }
            }
        }
    }
}

/// True if nothing that stands crosses the way between two points; what one of them lies on does not.
pub(crate) fn is_clear(world: &World, from: Point, to: Point) -> bool {
    !hidden(world.obstacles().iter(), usize::MAX, from, &end(from, to))
}

/// The same of what moves, too, at an instant.
#[must_use]
pub fn is_in_sight(world: &World, now_us: u64, from: Point, to: Point) -> bool {
    let moving = world.outlines(now_us, |_, _| true);
    let all = world.obstacles().iter().chain(&moving);
    !hidden(all, usize::MAX, from, &end(from, to))
}

/// The end of a way from the apex.
fn end(from: Point, to: Point) -> Candidate {
    let way = sub(to, from);
    Candidate {
        at: to,
        range_m: sqrt(dot(way, way)),
        facing: 1.0,
        corner: false,
    }
}

/// True if another obstacle crosses the way from the apex to the candidate.
fn hidden<'a>(
    obstacles: impl Iterator<Item = &'a Obstacle>,
    own: usize,
    apex: Point,
    candidate: &Candidate,
) -> bool {
    let way = sub(candidate.at, apex);
    let length_m = candidate.range_m;
    obstacles.enumerate().any(|(index, obstacle)| {
        if index == own || length_m <= 0.0 {
            return false;
        }
        let d = sub(obstacle.center, apex);
        let off_line = cross(way, d);
        let reach = length_m + obstacle.radius_m;
        let widest = obstacle.radius_m * length_m;
        if off_line * off_line > widest * widest || dot(d, d) > reach * reach {
            return false;
        }
        obstacle.faces.iter().any(|face| {
            let height_m = face.height_m(apex);
            let closing = -dot(way, face.normal);
            // The point itself may touch the other obstacle: only what is clearly nearer hides it.
            if height_m < 0.0 || closing <= 0.0 || height_m >= closing * (1.0 - 1e-9) {
                return false;
            }
            let along =
                dot(sub(apex, face.start), face.along) + height_m / closing * dot(way, face.along);
            (0.0..=face.length_m).contains(&along)
        })
    })
}
