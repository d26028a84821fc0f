//! The world: walls and boxes as convex outlines on the floor.
//!
//! A [`World`] is built from plain shapes, and what stands in it never changes during a run. Each outline keeps its faces
//! with their outward normals, and a bounding circle, so that most of a query ends after a few multiplications. What
//! moves ([`crate::moving`]) has an outline for each instant.
//! [`crate::cone`] asks it what a sonar sees, [`crate::contact`] what the robot touches.

use libm::{sincos, sqrt};

use crate::moving::{Body, MOST_BODIES};

/// A point or a vector on the floor: `[x, y]`, metres.
pub type Point = [f64; 2];

/// A straight wall from one point to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wall {
    /// One end of its centre line.
    pub from_m: Point,
    /// The other end.
    pub to_m: Point,
    /// Thickness, half on each side of the line; 0 is a thin screen.
    pub thickness_m: f64,
}

/// A rectangular box standing on the floor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Block {
    /// Its centre.
    pub center_m: Point,
    /// Lengths of its sides along its own x and y.
    pub size_m: [f64; 2],
    /// Direction of its own x axis, counter-clockwise from the world's.
    pub heading_rad: f64,
}

/// Why a shape cannot be part of a world.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShapeError {
    /// A coordinate, size or angle is not a finite number.
    NotFinite,
    /// A length that must be positive is not (or a thickness is negative).
    NotPositive,
    /// Fewer than three corners, or corners that are not convex and counter-clockwise.
    NotConvex,
    /// Waypoints that are no route.
    NoRoute,
    /// More moving bodies than a world has room for.
    TooMany,
}

impl core::fmt::Display for ShapeError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::NotFinite => "a coordinate, size or angle is not finite; give plain numbers",
            Self::NotPositive => {
                "a wall needs two different ends and a thickness >= 0, a box two sides > 0"
            }
            Self::NotConvex => {
                "an outline needs at least three corners, convex and counter-clockwise"
            }
            Self::NoRoute => {
                "a route needs at least two waypoints, at times that grow from 0; a loop ends where it begins"
            }
            Self::TooMany => "a world has room for 63 bodies that move",
        })
    }
}

impl core::error::Error for ShapeError {}

/// One face of an outline, from `start` along `along` for `length_m`; `normal` points outwards (to the right of
/// `along`).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Face {
    /// First corner, counter-clockwise.
    pub start: Point,
    /// Unit vector to the next corner.
    pub along: Point,
    /// Outward unit normal.
    pub normal: Point,
    /// Distance to the next corner.
    pub length_m: f64,
}

impl Face {
    fn between(start: Point, end: Point) -> Self {
        let d = sub(end, start);
        let length_m = sqrt(dot(d, d));
        let along = [d[0] / length_m, d[1] / length_m];
        Self {
            start,
            along,
            normal: [along[1], -along[0]],
            length_m,
        }
    }

    /// Signed height of a point over the face's line: positive outside.
    #[must_use]
    pub fn height_m(&self, point: Point) -> f64 {
        dot(sub(point, self.start), self.normal)
    }

    /// The second corner.
    #[must_use]
    pub fn end(&self) -> Point {
        add(self.start, scale(self.along, self.length_m))
    }
}

/// A convex obstacle: its faces counter-clockwise, and a circle around it. A thin screen has two faces, back to back.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Obstacle {
    /// Faces in counter-clockwise order.
    pub faces: Vec<Face>,
    /// Centre of the bounding circle.
    pub center: Point,
    /// Radius of the bounding circle.
    pub radius_m: f64,
}

impl Obstacle {
    /// A convex outline, corners counter-clockwise.
    ///
    /// # Errors
    /// If it is not finite, or not convex and counter-clockwise.
    pub fn convex(corners: &[Point]) -> Result<Self, ShapeError> {
        for corner in corners {
            finite(corner)?;
        }
        let n = corners.len();
        let turns_left = |i: usize| {
            let (a, b, c) = (corners[i], corners[(i + 1) % n], corners[(i + 2) % n]);
            cross(sub(b, a), sub(c, b)) > 0.0
        };
        if n < 3 || !(0..n).all(turns_left) {
            return Err(ShapeError::NotConvex);
        }
        Ok(Self::from_corners(corners))
    }

    pub(crate) fn from_corners(corners: &[Point]) -> Self {
        let mut obstacle = Self::default();
        obstacle.take_corners(corners.iter().copied());
        obstacle
    }

    /// Becomes the outline with these corners, counter-clockwise; it keeps its memory.
    pub(crate) fn take_corners(&mut self, corners: impl Iterator<Item = Point>) {
        let faces = &mut self.faces;
        faces.clear();
        faces.extend(corners.map(|start| Face {
            start,
            ..Face::default()
        }));
        let n = faces.len();
        for i in 0..n {
            faces[i] = Face::between(faces[i].start, faces[(i + 1) % n].start);
        }
        let sum = self.corners().fold([0.0, 0.0], add);
        let center = scale(sum, 1.0 / n as f64);
        let away_m = |corner: Point| sqrt(dot(sub(corner, center), sub(corner, center)));
        self.radius_m = self.corners().map(away_m).fold(0.0, f64::max);
        self.center = center;
    }

    /// Corners in counter-clockwise order (two for a thin screen).
    pub fn corners(&self) -> impl Iterator<Item = Point> + Clone + '_ {
        self.faces.iter().map(|face| face.start)
    }

    /// True for a point strictly inside.
    #[must_use]
    pub fn contains(&self, point: Point) -> bool {
        self.faces.iter().all(|face| face.height_m(point) < 0.0)
    }

    /// Distance from a point, 0 inside.
    #[must_use]
    pub fn distance_m(&self, point: Point) -> f64 {
        let mut best = f64::INFINITY;
        for face in &self.faces {
            if face.height_m(point) >= 0.0 {
                let s = dot(sub(point, face.start), face.along).clamp(0.0, face.length_m);
                let v = sub(add(face.start, scale(face.along, s)), point);
                best = best.min(dot(v, v));
            }
        }
        if best.is_finite() { sqrt(best) } else { 0.0 }
    }

    /// True if both have room in common: no line along a face of either keeps them apart.
    #[must_use]
    pub fn overlaps(&self, other: &Self) -> bool {
        let behind_a_face = |of: &Self, other: &Self| {
            let mut faces = of.faces.iter();
            faces.any(|face| other.corners().all(|corner| face.height_m(corner) >= 0.0))
        };
        !behind_a_face(self, other) && !behind_a_face(other, self)
    }

    /// Distance from another outline, 0 if they overlap.
    #[must_use]
    pub fn apart_m(&self, other: &Self) -> f64 {
        let from_corners = |of: &Self, to: &Self| {
            of.corners()
                .map(|corner| to.distance_m(corner))
                .fold(f64::INFINITY, f64::min)
        };
        if self.overlaps(other) {
            0.0
        } else {
            from_corners(self, other).min(from_corners(other, self))
        }
    }
}

/// Everything that stands on the floor or moves over it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct World {
    obstacles: Vec<Obstacle>,
    bodies: Vec<Body>,
    /// No point of a body is faster.
    fastest_m_s: f64,
}

impl World {
    /// An endless empty floor.
    #[must_use]
    pub const fn empty() -> Self {
        Self {
            obstacles: Vec::new(),
            bodies: Vec::new(),
            fastest_m_s: 0.0,
        }
    }

    /// A world of walls and boxes.
    ///
    /// # Errors
    /// The first shape that is not finite or has no size.
    pub fn new(walls: &[Wall], blocks: &[Block]) -> Result<Self, ShapeError> {
        let mut world = Self::empty();
        for wall in walls {
            world.add_wall(wall)?;
        }
        for block in blocks {
            world.add_block(block)?;
        }
        Ok(world)
    }

    /// Adds a wall.
    ///
    /// # Errors
    /// If it is not finite, has no length or a negative thickness.
    pub fn add_wall(&mut self, wall: &Wall) -> Result<(), ShapeError> {
        finite(&[
            wall.from_m[0],
            wall.from_m[1],
            wall.to_m[0],
            wall.to_m[1],
            wall.thickness_m,
        ])?;
        let d = sub(wall.to_m, wall.from_m);
        let length_m = sqrt(dot(d, d));
        if length_m <= 0.0 || wall.thickness_m < 0.0 {
            return Err(ShapeError::NotPositive);
        }
        let half = 0.5 * wall.thickness_m / length_m;
        let side = [-d[1] * half, d[0] * half];
        let obstacle = if wall.thickness_m > 0.0 {
            Obstacle::from_corners(&[
                sub(wall.from_m, side),
                sub(wall.to_m, side),
                add(wall.to_m, side),
                add(wall.from_m, side),
            ])
        } else {
            Obstacle::from_corners(&[wall.from_m, wall.to_m])
        };
        self.obstacles.push(obstacle);
        Ok(())
    }

    /// Adds a box.
    ///
    /// # Errors
    /// If it is not finite or a side is not positive.
    pub fn add_block(&mut self, block: &Block) -> Result<(), ShapeError> {
        let [w, h] = block.size_m;
        finite(&[
            block.center_m[0],
            block.center_m[1],
            w,
            h,
            block.heading_rad,
        ])?;
        if w <= 0.0 || h <= 0.0 {
            return Err(ShapeError::NotPositive);
        }
        let corners = rectangle(
            [0.5 * w, 0.5 * h],
            [0.0, 0.0],
            block.center_m,
            block.heading_rad,
        );
        self.obstacles.push(Obstacle::from_corners(&corners));
        Ok(())
    }

    /// Adds any convex outline, corners counter-clockwise.
    ///
    /// # Errors
    /// If it is not finite, or not convex and counter-clockwise.
    pub fn add_convex(&mut self, corners: &[Point]) -> Result<(), ShapeError> {
        self.obstacles.push(Obstacle::convex(corners)?);
        Ok(())
    }

    /// Adds a body that moves.
    ///
    /// # Errors
    /// There is no room for another one.
    pub fn add_body(&mut self, body: Body) -> Result<(), ShapeError> {
        if self.bodies.len() == MOST_BODIES {
            return Err(ShapeError::TooMany);
        }
        self.fastest_m_s = self.fastest_m_s.max(body.fastest_m_s());
        self.bodies.push(body);
        Ok(())
    }

    /// All obstacles that stand, in the order they were added.
    #[must_use]
    pub fn obstacles(&self) -> &[Obstacle] {
        &self.obstacles
    }

    /// All bodies that move, in the order they were added.
    #[must_use]
    pub fn bodies(&self) -> &[Body] {
        &self.bodies
    }

    /// Puts bodies, each of the same outline, in place of those of these numbers.
    pub(crate) fn replace_bodies<'a>(&mut self, bodies: impl Iterator<Item = (usize, &'a Body)>) {
        for (index, body) in bodies {
            if let Some(own) = self.bodies.get_mut(index) {
                own.go_as(body);
            }
        }
        self.fastest_m_s = self
            .bodies
            .iter()
            .map(Body::fastest_m_s)
            .fold(0.0, f64::max);
    }

    /// No point of a body is faster.
    pub(crate) const fn fastest_m_s(&self) -> f64 {
        self.fastest_m_s
    }

    /// Outlines of the bodies whose circle, by its centre and radius \[m\], matters.
    pub(crate) fn outlines(
        &self,
        now_us: u64,
        matters: impl Fn(Point, f64) -> bool,
    ) -> Vec<Obstacle> {
        let outline = |body: &Body| {
            let pose = body.at(now_us).pose;
            matters([pose.x_m, pose.y_m], body.radius_m()).then(|| body.outline(&pose))
        };
        self.bodies.iter().filter_map(outline).collect()
    }
}

/// Corners, counter-clockwise, of a rectangle with the given half sides; its middle is at `offset` in the frame of
/// `center` and `heading_rad`.
#[must_use]
pub fn rectangle(half_m: [f64; 2], offset: Point, center: Point, heading_rad: f64) -> [Point; 4] {
    let (s, c) = sincos(heading_rad);
    [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]].map(|[i, j]: Point| {
        let (x, y) = (offset[0] + i * half_m[0], offset[1] + j * half_m[1]);
        [center[0] + c * x - s * y, center[1] + s * x + c * y]
    })
}

fn finite(values: &[f64]) -> Result<(), ShapeError> {
    if values.iter().all(|v| v.is_finite()) {
        Ok(())
    } else {
        Err(ShapeError::NotFinite)
    }
}

pub(crate) fn add(a: Point, b: Point) -> Point {
    [a[0] + b[0], a[1] + b[1]]
}

pub(crate) fn sub(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1]]
}

pub(crate) fn scale(a: Point, k: f64) -> Point {
    [a[0] * k, a[1] * k]
}

pub(crate) fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// z of the vector product: positive if `b` is counter-clockwise of `a`.
pub(crate) fn cross(a: Point, b: Point) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thin_screen_and_a_thick_wall_are_where_they_were_put() {
        let ends = |thickness_m| Wall {
            from_m: [2.0, -1.0],
            to_m: [2.0, 1.0],
            thickness_m,
        };
        let world = World::new(&[ends(0.0), ends(0.1)], &[]).unwrap();
        assert_eq!(world.obstacles()[0].distance_m([0.0, 0.0]), 2.0);
        assert!((world.obstacles()[1].distance_m([0.0, 0.0]) - 1.95).abs() < 1e-12);
        assert_eq!(
            world.obstacles()[0].distance_m([2.0, 3.0]),
            2.0,
            "in line with the screen, beyond its end"
        );
        assert!(world.obstacles()[1].contains([2.0, 0.5]));
        assert!(!world.obstacles()[0].contains([2.0, 0.5]));
    }

    #[test]
    fn a_turned_box_reaches_its_half_diagonal() {
        let block = Block {
            center_m: [1.0, 0.0],
            size_m: [0.4, 0.4],
            heading_rad: core::f64::consts::FRAC_PI_4,
        };
        let world = World::new(&[], &[block]).unwrap();
        let half_diagonal_m = 0.2 * 2.0_f64.sqrt();
        assert!(
            (world.obstacles()[0].distance_m([0.0, 0.0]) - (1.0 - half_diagonal_m)).abs() < 1e-12
        );
        assert!((world.obstacles()[0].radius_m - half_diagonal_m).abs() < 1e-12);
    }

    #[test]
    fn shapes_without_size_or_sense_are_refused() {
        let mut world = World::empty();
        let wall = Wall {
            from_m: [0.0, 0.0],
            to_m: [0.0, 0.0],
            thickness_m: 0.1,
        };
        assert_eq!(world.add_wall(&wall), Err(ShapeError::NotPositive));
        let block = Block {
            center_m: [f64::NAN, 0.0],
            size_m: [1.0, 1.0],
            heading_rad: 0.0,
        };
        assert_eq!(world.add_block(&block), Err(ShapeError::NotFinite));
        let clockwise = [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0]];
        assert_eq!(world.add_convex(&clockwise), Err(ShapeError::NotConvex));
        assert!(world.obstacles().is_empty());
    }
}
