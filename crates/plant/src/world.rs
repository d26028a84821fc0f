//! The world: walls and boxes as convex outlines on the floor.
//!
//! A [`World`] is built from plain shapes, and what stands in it never changes during a run. Each outline keeps its faces
//! with their outward normals, and a bounding circle, so that most of a query ends after a few multiplications. What
//! moves ([`crate::moving`]) has an outline for each instant.
//! [`crate::cone`] asks it what a sonar sees, [`crate::contact`] what the robot touches.

use libm::sqrt;

use crate::moving::{Body, MOST_BODIES};
use crate::outline::{add, dot, finite, sub};

pub use crate::outline::{Block, Face, Obstacle, Point, ShapeError, Wall, rectangle};

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

    /// Shifts what has this number, obstacles first, then bodies with their whole course; whether there is such a thing.
    pub(crate) fn shift(&mut self, thing: usize, by_m: Point) -> bool {
        let standing = self.obstacles.len();
        if let Some(obstacle) = self.obstacles.get_mut(thing) {
            obstacle.shift(by_m);
        } else if let Some(body) = self.bodies.get_mut(thing - standing) {
            body.shift(by_m);
        } else {
            return false;
        }
        true
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
