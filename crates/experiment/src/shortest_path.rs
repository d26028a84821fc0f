//! The shortest path of a round robot among known walls and boxes.
//!
//! Every obstacle is grown by the robot's radius (the sum of Minkowski with a disc: faces move out, corners become arcs), and the robot
//! shrinks to a point. A shortest path among such shapes is a chain of straight lines from corner to corner, each touching the shapes at
//! its ends without entering them: a visibility graph, searched by A* (Lozano-Perez and Wesley 1979; Hart, Nilsson and Raphael 1968).
//! Overlapping shapes need no union: a line must miss each of them.
//!
//! An arc is replaced by lines that touch it from outside, one for each 22.5 degrees of turn: a path is then never shorter than the true one,
//! and around a right angle longer by 1.3 % of the arc, 1.5 mm for a radius of 0.075 m.

use nalgebra::Vector2;
use rumbo_plant::world::{Obstacle, Point, World};
use std::f64::consts::PI;

type Vector = Vector2<f64>;

/// Largest turn of an arc represented by one corner [rad].
const ARC_RAD: f64 = PI / 8.0;
/// A line that enters a shape by less than this only touches it [m].
const TOUCH_M: f64 = 1e-9;

/// A path from one point to another.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    /// Its length [m].
    pub length_m: f64,
    /// Start, corners and end, in the world's frame.
    pub points_m: Vec<Point>,
}

/// A floor with obstacles grown by the radius of a robot, which is a point here.
#[derive(Clone, Debug)]
pub struct Floor {
    shapes: Vec<Shape>,
    /// The corners of all shapes at which a path may turn.
    corners: Vec<Corner>,
}

impl Floor {
    /// The floor of a world for a disc of this radius, which must be positive.
    #[must_use]
    pub fn grown(world: &World, radius_m: f64) -> Self {
        let shapes: Vec<Shape> = world
            .obstacles()
            .iter()
            .map(|obstacle| Shape::grown(obstacle, radius_m))
            .collect();
        let mut floor = Self {
            shapes,
            corners: Vec::new(),
        };
        let corners = floor.shapes.iter().flat_map(Shape::corners);
        let corners = corners.filter(|corner| floor.is_free(corner.at));
        floor.corners = corners.collect();
        floor
    }

    /// Whether the robot can be at a point.
    #[must_use]
    pub fn admits(&self, point_m: Point) -> bool {
        self.is_free(point_m.into())
    }

    /// Whether the robot can go straight from one point to the other.
    #[must_use]
    pub fn is_straight(&self, from_m: Point, to_m: Point) -> bool {
        self.is_clear(from_m.into(), to_m.into())
    }

    /// The shortest path, `None` where there is no path.
    #[must_use]
    pub fn shortest(&self, from_m: Point, to_m: Point) -> Option<Path> {
        let ends = [from_m, to_m].map(|point| Corner {
            at: point.into(),
            along: [Vector::zeros(); 2],
        });
        let nodes: Vec<&Corner> = ends.iter().chain(&self.corners).collect();
        let goal = ends[1].at;
        let mut best: Vec<Node> = vec![Node::default(); nodes.len()];
        best[0].way_m = 0.0;
        loop {
            let estimate_m = |&index: &usize| best[index].way_m + (goal - nodes[index].at).norm();
            let here = (0..nodes.len())
                .filter(|&index| !best[index].settled && best[index].way_m.is_finite())
                .min_by(|a, b| estimate_m(a).total_cmp(&estimate_m(b)))?;
            best[here].settled = true;
            if here == 1 {
                return Some(traced(&nodes, &best));
            }
            for next in 1..nodes.len() {
                let line = nodes[next].at - nodes[here].at;
                let way_m = best[here].way_m + line.norm();
                if way_m < best[next].way_m
                    && nodes[here].is_touched_by(line)
                    && nodes[next].is_touched_by(line)
                    && self.is_clear(nodes[here].at, nodes[next].at)
                {
                    best[next].way_m = way_m;
                    best[next].from = here;
                }
            }
        }
    }

    fn is_free(&self, point: Vector) -> bool {
        !self.shapes.iter().any(|shape| shape.holds(point))
    }

    fn is_clear(&self, from: Vector, to: Vector) -> bool {
        !self.shapes.iter().any(|shape| shape.stops(from, to))
    }
}

/// Search state of a node.
#[derive(Clone, Copy, Debug)]
struct Node {
    way_m: f64,
    from: usize,
    settled: bool,
}

impl Default for Node {
    fn default() -> Self {
        Self {
            way_m: f64::INFINITY,
            from: 0,
            settled: false,
        }
    }
}

/// The path to node 1, from node 0.
fn traced(nodes: &[&Corner], best: &[Node]) -> Path {
    let mut points_m = vec![nodes[1].at.into()];
    let mut at = 1;
    while at != 0 {
        at = best[at].from;
        points_m.push(nodes[at].at.into());
    }
    points_m.reverse();
    Path {
        length_m: best[1].way_m,
        points_m,
    }
}

/// A corner of a grown shape, or an end of the path.
#[derive(Clone, Copy, Debug)]
struct Corner {
    at: Vector,
    /// To the neighbouring corners; zero for an end of the path.
    along: [Vector; 2],
}

impl Corner {
    /// Whether both neighbours are on one side of a line through the corner: a shortest path turns nowhere else.
    fn is_touched_by(&self, line: Vector) -> bool {
        let [one, other] = self.along.map(|along| line.perp(&along));
        let touch = TOUCH_M * line.norm();
        (one >= -touch && other >= -touch) || (one <= touch && other <= touch)
    }
}

/// A convex outline, counter-clockwise.
#[derive(Clone, Debug)]
struct Shape {
    corners: Vec<Vector>,
    /// Outward, of the face that starts at the corner of the same index.
    normals: Vec<Vector>,
    center: Vector,
    radius_m: f64,
}

impl Shape {
    /// An obstacle and everything nearer to it than a radius, arcs replaced by lines outside them.
    fn grown(obstacle: &Obstacle, radius_m: f64) -> Self {
        let faces = &obstacle.faces;
        let mut corners = Vec::new();
        for (face, before) in faces.iter().zip(faces.iter().cycle().skip(faces.len() - 1)) {
            let (first, last) = (Vector::from(before.normal), Vector::from(face.normal));
            // A thin wall turns by half a turn at its ends, where the sign of the angle is rounding.
            let turn_rad = libm::atan2(first.perp(&last), first.dot(&last)).abs();
            // A right angle has four arcs, whatever the rounding of its sides.
            let arcs = (turn_rad / ARC_RAD - 1e-6).ceil().max(1.0);
            let part_rad = turn_rad / arcs;
            let away_m = radius_m / libm::cos(0.5 * part_rad);
            for arc in 0..arcs as u32 {
                let (sin, cos) = sin_cos((f64::from(arc) + 0.5) * part_rad);
                let out = Vector::new(cos * first.x - sin * first.y, sin * first.x + cos * first.y);
                corners.push(Vector::from(face.start) + away_m * out);
            }
        }
        let next = corners.iter().cycle().skip(1);
        let normals = corners.iter().zip(next).map(|(here, next)| {
            let along = next - here;
            Vector::new(along.y, -along.x) / along.norm()
        });
        let center = Vector::from(obstacle.center);
        let distances = corners.iter().map(|corner| (corner - center).norm());
        Self {
            normals: normals.collect(),
            radius_m: distances.fold(0.0, f64::max),
            corners,
            center,
        }
    }

    fn corners(&self) -> impl Iterator<Item = Corner> + '_ {
        let count = self.corners.len();
        (0..count).map(move |index| {
            let at = self.corners[index];
            let beside = [(index + 1) % count, (index + count - 1) % count];
            Corner {
                at,
                along: beside.map(|other| self.corners[other] - at),
            }
        })
    }

    /// How deep a point is below each face; negative outside.
    fn depths(&self, point: Vector) -> impl Iterator<Item = f64> + '_ {
        let faces = self.corners.iter().zip(&self.normals);
        faces.map(move |(corner, normal)| (corner - point).dot(normal) - TOUCH_M)
    }

    fn holds(&self, point: Vector) -> bool {
        self.depths(point).all(|depth_m| depth_m > 0.0)
    }

    /// Whether a line between two points goes through the inside.
    fn stops(&self, from: Vector, to: Vector) -> bool {
        if distance_m(self.center, from, to) >= self.radius_m {
            return false;
        }
        // The part of the line, from 0 to 1, that is below every face.
        let (mut enters, mut leaves) = (0.0, 1.0);
        for (first, last) in self.depths(from).zip(self.depths(to)) {
            if first <= 0.0 && last <= 0.0 {
                return false;
            }
            let crossing = first / (first - last);
            if first < 0.0 {
                enters = f64::max(enters, crossing);
            } else if last < 0.0 {
                leaves = f64::min(leaves, crossing);
            }
            if enters >= leaves {
                return false;
            }
        }
        true
    }
}

fn sin_cos(angle_rad: f64) -> (f64, f64) {
    (libm::sin(angle_rad), libm::cos(angle_rad))
}

/// Distance of a point from the line between two others.
fn distance_m(point: Vector, from: Vector, to: Vector) -> f64 {
    let line = to - from;
    let length = line.norm_squared();
    let along = if length > 0.0 {
        ((point - from).dot(&line) / length).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (from + along * line - point).norm()
}

#[cfg(test)]
mod tests;
