//! Pose from the distances of both wheels, by exact arcs. Derivation: docs/theory/odometry.md.

use crate::math::{sin_cos, sinc, wrap_angle};
use crate::types::{Pose, Wheels};

/// The two lengths that odometry needs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Geometry {
    /// Radius of each wheel [m].
    pub radius_m: Wheels<f32>,
    /// Distance between the wheels' contact points [m].
    pub base_m: f32,
}

impl Geometry {
    /// Forward speed [m/s] and yaw rate [rad/s] of the body from wheel speeds [rad/s].
    pub fn body_from_wheels(&self, wheel_rad_s: Wheels<f32>) -> (f32, f32) {
        let left = wheel_rad_s.left * self.radius_m.left;
        let right = wheel_rad_s.right * self.radius_m.right;
        (0.5 * (left + right), (right - left) / self.base_m)
    }

    /// Wheel speeds [rad/s] for a forward speed [m/s] and a yaw rate [rad/s].
    pub fn wheels_from_body(&self, forward_m_s: f32, yaw_rad_s: f32) -> Wheels<f32> {
        let turn_m_s = 0.5 * self.base_m * yaw_rad_s;
        Wheels {
            left: (forward_m_s - turn_m_s) / self.radius_m.left,
            right: (forward_m_s + turn_m_s) / self.radius_m.right,
        }
    }

    /// Moves a pose by what both wheels turned [rad], along the arc on which they did.
    pub fn advance(&self, pose: &mut Pose, wheel_rad: Wheels<f32>) {
        let left_m = wheel_rad.left * self.radius_m.left;
        let right_m = wheel_rad.right * self.radius_m.right;
        let turn_rad = (right_m - left_m) / self.base_m;
        let chord_m = 0.5 * (left_m + right_m) * sinc(0.5 * turn_rad);
        let (sin, cos) = sin_cos(pose.heading_rad + 0.5 * turn_rad);
        pose.x_m += chord_m * cos;
        pose.y_m += chord_m * sin;
        pose.heading_rad = wrap_angle(pose.heading_rad + turn_rad);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f32::consts::{FRAC_PI_2, PI};
    use proptest::prelude::*;

    const ROBOT: Geometry = Geometry {
        radius_m: Wheels::both(0.0325),
        base_m: 0.1,
    };

    #[test]
    fn a_quarter_circle_in_one_step_is_exact() {
        // Centre 0.3 m to the left: the robot ends at (0.3, 0.3), facing y.
        let mut pose = Pose::default();
        let wheel = |radius_m: f32| FRAC_PI_2 * radius_m / 0.0325;
        ROBOT.advance(
            &mut pose,
            Wheels {
                left: wheel(0.25),
                right: wheel(0.35),
            },
        );
        assert!(
            (pose.x_m - 0.3).abs() < 1e-6 && (pose.y_m - 0.3).abs() < 1e-6,
            "{pose:?}"
        );
        assert!((pose.heading_rad - FRAC_PI_2).abs() < 1e-6);
    }

    #[test]
    fn turning_about_the_centre_does_not_move_it() {
        let mut pose = Pose {
            x_m: 1.0,
            y_m: 2.0,
            heading_rad: 3.0,
        };
        ROBOT.advance(
            &mut pose,
            Wheels {
                left: -1.0,
                right: 1.0,
            },
        );
        assert_eq!((pose.x_m, pose.y_m), (1.0, 2.0));
        assert!(
            pose.heading_rad < 0.0 && pose.heading_rad > -PI,
            "wraps: {pose:?}"
        );
    }

    proptest! {
        #[test]
        fn body_and_wheel_speeds_are_two_views_of_one_motion(forward in -1.0f32..1.0, yaw in -5.0f32..5.0) {
            let (back_forward, back_yaw) = ROBOT.body_from_wheels(ROBOT.wheels_from_body(forward, yaw));
            prop_assert!((back_forward - forward).abs() < 1e-5 && (back_yaw - yaw).abs() < 1e-4);
        }

        #[test]
        fn many_small_arcs_make_the_large_one(left in -3.0f32..3.0, right in -3.0f32..3.0) {
            let (mut once, mut often) = (Pose::default(), Pose::default());
            ROBOT.advance(&mut once, Wheels { left, right });
            for _ in 0..64 {
                ROBOT.advance(&mut often, Wheels { left: left / 64.0, right: right / 64.0 });
            }
            prop_assert!((once.x_m - often.x_m).abs() < 1e-5 && (once.y_m - often.y_m).abs() < 1e-5);
        }
    }
}
