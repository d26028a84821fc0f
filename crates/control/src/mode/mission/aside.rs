//! A wall beside the robot proves whether the front sonar hears: the servo turns to it, and the sonar at that side passes the same spot
//! a moment later.
//!
//! The front sonar sits some 0.1 m ahead of those at the sides. Where it looks aside and hears nothing, although a sonar at the side had
//! the wall before and has it at the same distance on that very spot, it lied: the wall runs along the way, and was near.

use super::echoes::{Beam, direction};
use super::place::{Place, fractions};
use crate::math::round;
use crate::types::{Range, Reading, SonarId, Transform};

/// The servo looks aside beyond this [rad].
pub(super) const LOOKS_ASIDE_RAD: f32 = 1.4;
/// Farthest wall that is taken for one [m].
pub(super) const WALL_M: f32 = 0.5;
/// A wall whose distance has changed by less runs along the way [mm].
const STRAIGHT_MM: i32 = 20;
/// The same spot, along the way [mm].
const SPOT_MM: i32 = 40;
/// The same heading, in 256ths of a turn: 0.12 rad.
const SAME_HEADING: u8 = 5;

/// A look aside that heard nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Aside {
    /// The sonar at that side; none where there was no look.
    sonar: Option<SonarId>,
    at: Place,
    heading: i8,
    /// Distance of the wall from the sonar at the side then [mm].
    wall_mm: i32,
}

impl Aside {
    /// The front sonar looked along this beam and heard nothing; `wall_m` is what the sonars at the left and right say.
    pub(super) fn of(robot: &Transform, reading: &Reading, wall_m: [Option<f32>; 2]) -> Self {
        let [left_m, right_m] = wall_m;
        let (sonar, wall_m) = if reading.servo_rad >= LOOKS_ASIDE_RAD {
            (SonarId::Left, left_m)
        } else if reading.servo_rad <= -LOOKS_ASIDE_RAD {
            (SonarId::Right, right_m)
        } else {
            return Self::default();
        };
        let (Beam { apex, .. }, _) = Beam::of(robot, reading);
        Self {
            sonar: wall_m.map(|_| sonar),
            at: apex,
            heading: direction(robot.pose.heading_rad),
            wall_mm: round(1_000.0 * wall_m.unwrap_or(0.0)),
        }
    }

    /// Takes in an answer of a sonar at a side; says whether it proves that the look aside should have heard the wall.
    pub(super) fn contradicted(&mut self, robot: &Transform, reading: &Reading) -> bool {
        if self.sonar != Some(reading.sonar) {
            return false;
        }
        let (Beam { apex, .. }, _) = Beam::of(robot, reading);
        let (along_mm, _) = apex.seen(self.at, &fractions((robot.sin, robot.cos)));
        let turned = direction(robot.pose.heading_rad).wrapping_sub(self.heading);
        if along_mm < -SPOT_MM && turned.unsigned_abs() <= SAME_HEADING {
            // Not there yet.
            return false;
        }
        self.sonar = None;
        let straight = match reading.range {
            Range::Valid(range_m) => {
                range_m < WALL_M && (round(1_000.0 * range_m) - self.wall_mm).abs() < STRAIGHT_MM
            }
            Range::Clear | Range::Faulty => false,
        };
        straight && along_mm < SPOT_MM && turned.unsigned_abs() <= SAME_HEADING
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rig::View;
    use crate::types::Pose;
    use core::f32::consts::FRAC_PI_2;

    fn robot(x_m: f32, heading_rad: f32) -> Transform {
        Transform::of(Pose {
            x_m,
            y_m: 0.0,
            heading_rad,
        })
    }

    fn reading(sonar: SonarId, x_m: f32, range: Range) -> Reading {
        Reading {
            sonar,
            range,
            view: View {
                x_m,
                y_m: 0.0,
                axis_rad: -FRAC_PI_2,
            },
            servo_rad: -1.5,
        }
    }

    /// The front sonar, 0.1 m ahead of the one at the right, heard nothing at a wall 0.2 m away; whether the right one proves that a lie
    /// after so much way, with this heading and this range.
    fn proven(way_m: f32, heading_rad: f32, range_m: f32) -> bool {
        let silent = reading(SonarId::Front, 0.13, Range::Clear);
        let mut aside = Aside::of(&robot(0.0, 0.0), &silent, [None, Some(0.2)]);
        let wall = reading(SonarId::Right, 0.03, Range::Valid(range_m));
        aside.contradicted(&robot(way_m, heading_rad), &wall)
    }

    #[test]
    fn a_wall_on_the_very_spot_proves_that_the_front_sonar_lied() {
        assert!(proven(0.1, 0.0, 0.205));
        assert!(!proven(0.02, 0.0, 0.205), "not there yet");
        assert!(!proven(0.1, 0.0, 0.26), "the wall runs away");
        assert!(!proven(0.1, 0.3, 0.205), "the robot has turned");
        assert!(!proven(0.2, 0.0, 0.205), "past the spot");
    }
}
