//! The beam of a sonar's reading, in the odometry frame.

use super::place::{Place, fractions};
use crate::math::{round, sin_cos};
use crate::types::{Range, SonarReading, Transform};

/// A beam of a sonar.
pub(super) struct Beam {
    /// Its origin.
    pub apex: Place,
    /// Sine and cosine of its axis, as [`fractions`].
    pub facing: (i16, i16),
    /// Its axis, in 256ths of a turn.
    pub axis: i8,
    /// Its origin [m].
    pub from_m: (f32, f32),
    /// Sine and cosine of its axis.
    pub sin_cos: (f32, f32),
}

impl Beam {
    /// The beam of a reading, with the robot at `robot`; and the position of the echo on its axis, if there was one.
    pub(super) fn of(robot: &Transform, reading: &SonarReading) -> (Self, Option<Place>) {
        let (x_m, y_m) = robot.to_world(reading.view.x_m, reading.view.y_m);
        let axis_rad = robot.pose.heading_rad + reading.view.axis_rad;
        let (sin, cos) = sin_cos(axis_rad);
        let beam = Self {
            apex: Place::new(x_m, y_m),
            facing: fractions((sin, cos)),
            axis: direction(axis_rad),
            from_m: (x_m, y_m),
            sin_cos: (sin, cos),
        };
        let at = match reading.range {
            Range::Valid(range_m) => Some(Place::new(x_m + range_m * cos, y_m + range_m * sin)),
            Range::Clear | Range::Faulty => None,
        };
        (beam, at)
    }

    /// A beam from a position in a direction of the world.
    pub(super) fn along(apex: Place, axis_rad: f32) -> Self {
        let sin_cos = sin_cos(axis_rad);
        Self {
            apex,
            facing: fractions(sin_cos),
            axis: direction(axis_rad),
            from_m: apex.metres(),
            sin_cos,
        }
    }
}

/// A direction in 256ths of a turn.
pub(super) fn direction(angle_rad: f32) -> i8 {
    let wrapped = crate::math::wrap_angle(angle_rad);
    let turns = round(wrapped * (128.0 / core::f32::consts::PI));
    // 128 is half a turn, as -128 is.
    i8::try_from(turns).unwrap_or(i8::MIN)
}
