//! Outlines on the floor: points, faces, convex shapes, and poses.

use libm::{sincos, sqrt};

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

    pub(crate) fn shift(&mut self, by_m: Point) {
        for face in &mut self.faces {
            face.start = add(face.start, by_m);
        }
        self.center = add(self.center, by_m);
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

impl Pose {
    /// Where a point of the body is in the world.
    #[must_use]
    pub fn place(&self, [x_m, y_m]: Point) -> Point {
        let (s, c) = sincos(self.heading_rad);
        [self.x_m + c * x_m - s * y_m, self.y_m + s * x_m + c * y_m]
    }

    pub(crate) fn shift(&mut self, by_m: Point) {
        [self.x_m, self.y_m] = add([self.x_m, self.y_m], by_m);
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

pub(crate) fn finite(values: &[f64]) -> Result<(), ShapeError> {
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
