//! Pose from the distances of both wheels, by exact arcs, and how far it may be off. Derivation: docs/theory/odometry.md.
//!
//! Two kinds of error are kept apart. Slip is random at every millimetre: a covariance that grows with the distance.
//! Radii and base have constant errors: the pose's derivatives by each of them, which shrink again where the way back
//! undoes the error. No mode needs it; receivers of the robot's poses compute it from them.

use crate::math::{abs, rotate, sin_cos, sinc, wrap_angle};
use crate::types::{Pose, Transform, Wheels};

/// Half of a turn [rad] up to which tan(x) / x is 1 + x^2 / 3 + 2 x^4 / 15 to the last bit but one.
const SMALL_RAD: f32 = 0.12;

/// The lengths that odometry needs; their inverses too, since a division takes the AVR as long as four products.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Geometry {
    radius_m: Wheels<f32>,
    base_m: f32,
    per_radius: Wheels<f32>,
    per_base: f32,
}

impl Geometry {
    /// Of the wheels' radii and the distance between their contact points [m], none of them 0.
    pub fn new(radius_m: Wheels<f32>, base_m: f32) -> Geometry {
        Geometry {
            radius_m,
            base_m,
            per_radius: radius_m.map(|radius_m| 1.0 / radius_m),
            per_base: 1.0 / base_m,
        }
    }

    /// Radius of each wheel [m].
    pub fn radius_m(&self) -> Wheels<f32> {
        self.radius_m
    }

    /// Mean of the radii [m].
    pub fn mean_radius_m(&self) -> f32 {
        0.5 * (self.radius_m.left + self.radius_m.right)
    }

    /// Distance between the wheels' contact points [m].
    pub fn base_m(&self) -> f32 {
        self.base_m
    }

    /// One over the distance between the wheels' contact points [1/m].
    pub fn per_base(&self) -> f32 {
        self.per_base
    }

    /// Distances of the wheels [m] from the angles that they turned [rad]; speeds likewise.
    pub fn ways_of_wheels(&self, wheel_rad: Wheels<f32>) -> Wheels<f32> {
        Wheels {
            left: wheel_rad.left * self.radius_m.left,
            right: wheel_rad.right * self.radius_m.right,
        }
    }

    /// Forward distance [m] and turn [rad] of the body from the distances of the wheels [m]; speeds likewise.
    pub fn body_from_ways(&self, way_m: Wheels<f32>) -> (f32, f32) {
        (
            0.5 * (way_m.left + way_m.right),
            (way_m.right - way_m.left) * self.per_base,
        )
    }

    /// Forward speed [m/s] and yaw rate [rad/s] of the body from wheel speeds [rad/s].
    pub fn body_from_wheels(&self, wheel_rad_s: Wheels<f32>) -> (f32, f32) {
        self.body_from_ways(self.ways_of_wheels(wheel_rad_s))
    }

    /// Wheel speeds [rad/s] for a forward speed [m/s] and a yaw rate [rad/s].
    pub fn wheels_from_body(&self, forward_m_s: f32, yaw_rad_s: f32) -> Wheels<f32> {
        let turn_m_s = 0.5 * self.base_m * yaw_rad_s;
        Wheels {
            left: (forward_m_s - turn_m_s) * self.per_radius.left,
            right: (forward_m_s + turn_m_s) * self.per_radius.right,
        }
    }
}

/// Moves a pose along an arc of this length [m] and turn [rad].
pub fn advance(place: &mut Transform, forward_m: f32, turned_rad: f32) {
    let Transform { pose, sin, cos } = *place;
    if turned_rad == 0.0 {
        place.pose.x_m += forward_m * cos;
        place.pose.y_m += forward_m * sin;
        return;
    }
    let half_rad = 0.5 * turned_rad;
    place.pose.heading_rad = wrap_angle(pose.heading_rad + turned_rad);
    (place.sin, place.cos) = rotate((sin, cos), turned_rad, place.pose.heading_rad);
    let (x, y, way_m) = if abs(half_rad) < SMALL_RAD {
        // The chord points along the middle heading: along the sum of the directions before and after.
        let square = half_rad * half_rad;
        let lengthened = 1.0 + square * (1.0 / 3.0 + 2.0 / 15.0 * square);
        (
            cos + place.cos,
            sin + place.sin,
            0.5 * forward_m * lengthened,
        )
    } else {
        let (sin, cos) = sin_cos(pose.heading_rad + half_rad);
        (cos, sin, forward_m * sinc(half_rad))
    };
    place.pose.x_m += way_m * x;
    place.pose.y_m += way_m * y;
}

/// Uncertainty of the robot's lengths: standard deviations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OdometryErrors {
    /// Slip of one wheel: error of its distance after 1 m; it grows with the root of the distance [m].
    pub slip_m: f32,
    /// Ratio of the wheels' radii, relative.
    pub ratio: f32,
    /// Angle turned per difference of the wheels' angles (radius over base), relative.
    pub turn: f32,
    /// Distance per angle (mean radius), relative.
    pub scale: f32,
    /// Distance between the wheels [m].
    pub base_m: f32,
    /// Distance of one encoder edge [m]: a wheel's position between two edges is unknown, at the origin and now.
    pub edge_m: f32,
}

/// A step along the path, short enough to be straight within a few degrees.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PathStep {
    /// Sine and cosine of the heading in its middle.
    pub facing: (f32, f32),
    /// Forward distance, signed [m].
    pub forward_m: f32,
    /// Angle turned [rad].
    pub turned_rad: f32,
    /// Distance of each wheel, without sign [m].
    pub rolled_m: Wheels<f32>,
}

impl PathStep {
    /// The step between two successive poses of a robot with wheels `base_m` [m] apart that did not reverse in between.
    pub fn between(before: &Pose, now: &Pose, base_m: f32) -> PathStep {
        let turned_rad = wrap_angle(now.heading_rad - before.heading_rad);
        let facing = sin_cos(before.heading_rad + 0.5 * turned_rad);
        let (sin, cos) = facing;
        let forward_m = (now.x_m - before.x_m) * cos + (now.y_m - before.y_m) * sin;
        let turn_m = 0.5 * turned_rad * base_m;
        PathStep {
            facing,
            forward_m,
            turned_rad,
            rolled_m: Wheels {
                left: abs(forward_m - turn_m),
                right: abs(forward_m + turn_m),
            },
        }
    }
}

/// x, y and heading of something: a derivative, or a row of a covariance.
type Triple = [f32; 3];

/// Uncertainty of the pose; the default is that of the origin, none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Uncertainty {
    /// Covariance by slip: xx, xy, yy, xh, yh, hh.
    slip: [f32; 6],
    /// Derivatives of the pose by the ratio of the radii, the scale of turns and the scale of distances, all relative.
    by: [Triple; 3],
}

impl Uncertainty {
    /// Updates with a step.
    pub fn advance(&mut self, errors: &OdometryErrors, step: &PathStep) {
        let (sin, cos) = step.facing;
        let (dx, dy) = (step.forward_m * cos, step.forward_m * sin);
        // What a relative error of each kind adds to the step: to its turn, to its distance.
        let adds = [
            (
                step.forward_m / errors.base_m,
                0.25 * step.turned_rad * errors.base_m,
            ),
            (step.turned_rad, 0.0),
            (0.0, step.forward_m),
        ];
        for ([x, y, h], (turn, way)) in self.by.iter_mut().zip(&adds) {
            let middle = *h + 0.5 * turn;
            *x += way * cos - dy * middle;
            *y += way * sin + dx * middle;
            *h += turn;
        }
        self.slip_on(errors, (sin, cos), (dx, dy), &step.rolled_m);
    }

    fn slip_on(
        &mut self,
        errors: &OdometryErrors,
        (sin, cos): (f32, f32),
        (dx, dy): (f32, f32),
        rolled_m: &Wheels<f32>,
    ) {
        let per_m = errors.slip_m * errors.slip_m;
        let (left, right) = (per_m * abs(rolled_m.left), per_m * abs(rolled_m.right));
        let way = 0.25 * (left + right);
        let turn = 4.0 * way / (errors.base_m * errors.base_m);
        let both = 0.5 * (right - left) / errors.base_m;
        let [xx, xy, yy, xh, yh, hh] = self.slip;
        // The heading's error so far rotates the step: x - dy h, y + dx h; the step's own error rotates half of it.
        let (ax, ay) = (-0.5 * dy, 0.5 * dx);
        // Effect of the step's distance (along) and turn (aside) on x, y and heading.
        let (along_x, along_y) = (way * cos + both * ax, way * sin + both * ay);
        let (aside_x, aside_y) = (both * cos + turn * ax, both * sin + turn * ay);
        let (swung_x, swung_y) = (xh - dy * hh, yh + dx * hh);
        self.slip = [
            xx - dy * (xh + swung_x) + along_x * cos + aside_x * ax,
            xy + dx * swung_x - dy * yh + along_x * sin + aside_x * ay,
            yy + dx * (yh + swung_y) + along_y * sin + aside_y * ay,
            swung_x + aside_x,
            swung_y + aside_y,
            hh + turn,
        ];
    }

    /// Covariance of x, y and heading.
    pub fn covariance(&self, errors: &OdometryErrors) -> [Triple; 3] {
        let [xx, xy, yy, xh, yh, hh] = self.slip;
        // Two positions of each wheel, each uniform within an edge: variances of a twelfth each.
        let way = errors.edge_m * errors.edge_m / 12.0;
        let turn = 4.0 * way / (errors.base_m * errors.base_m);
        let mut covariance = [[xx + way, xy, xh], [xy, yy + way, yh], [xh, yh, hh + turn]];
        for (by, error) in self
            .by
            .iter()
            .zip([errors.ratio, errors.turn, errors.scale])
        {
            for (row, first) in covariance.iter_mut().zip(by) {
                for (entry, second) in row.iter_mut().zip(by) {
                    *entry += error * error * first * second;
                }
            }
        }
        covariance
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::sqrt;
    use core::f32::consts::{FRAC_PI_2, PI};
    use proptest::prelude::*;

    fn robot() -> Geometry {
        Geometry::new(Wheels::both(0.0325), 0.1)
    }

    /// Moves a pose by what both wheels turned [rad].
    fn roll(robot: &Geometry, pose: &mut Pose, wheel_rad: Wheels<f32>) {
        let mut place = Transform::of(*pose);
        let (forward_m, turned_rad) = robot.body_from_wheels(wheel_rad);
        advance(&mut place, forward_m, turned_rad);
        *pose = place.pose;
    }

    #[test]
    fn a_quarter_circle_in_one_step_is_exact() {
        // Centre 0.3 m to the left: the robot ends at (0.3, 0.3), facing y.
        let mut pose = Pose::default();
        let wheel = |radius_m: f32| FRAC_PI_2 * radius_m / 0.0325;
        roll(
            &robot(),
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
        roll(
            &robot(),
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
            let (back_forward, back_yaw) = robot().body_from_wheels(robot().wheels_from_body(forward, yaw));
            prop_assert!((back_forward - forward).abs() < 1e-5 && (back_yaw - yaw).abs() < 1e-4);
        }

        #[test]
        fn many_small_arcs_make_the_large_one(left in -3.0f32..3.0, right in -3.0f32..3.0) {
            let (mut once, mut often) = (Pose::default(), Pose::default());
            roll(&robot(), &mut once, Wheels { left, right });
            for _ in 0..64 {
                roll(&robot(), &mut often, Wheels { left: left / 64.0, right: right / 64.0 });
            }
            prop_assert!((once.x_m - often.x_m).abs() < 1e-5 && (once.y_m - often.y_m).abs() < 1e-5);
        }
    }

    const ERRORS: OdometryErrors = OdometryErrors {
        slip_m: 0.000_38,
        ratio: 0.004,
        turn: 0.0115,
        scale: 0.002,
        base_m: 0.1,
        edge_m: 0.0,
    };

    fn drive(uncertainty: &mut Uncertainty, pose: &mut Pose, wheel_rad: Wheels<f32>, times: u32) {
        for _ in 0..times {
            let before = *pose;
            roll(&robot(), pose, wheel_rad);
            uncertainty.advance(&ERRORS, &PathStep::between(&before, pose, ERRORS.base_m));
        }
    }

    /// Standard deviations of x, y [m] and heading [rad].
    fn deviations(uncertainty: &Uncertainty) -> [f32; 3] {
        let [[xx, _, _], [_, yy, _], [_, _, hh]] = uncertainty.covariance(&ERRORS);
        [xx, yy, hh].map(sqrt)
    }

    #[test]
    fn the_uncertainty_grows_with_the_way_and_a_way_back_undoes_what_is_systematic() {
        let (mut uncertainty, mut pose) = (Uncertainty::default(), Pose::default());
        assert_eq!(deviations(&uncertainty), [0.0; 3]);
        let forward = Wheels::both(0.2);
        drive(&mut uncertainty, &mut pose, forward, 462);
        let [x_m, y_m, heading_rad] = deviations(&uncertainty);
        // 3 m: 0.4 % of ratio are 0.04 rad/m, and slip 0.31 degrees per root metre.
        assert!((heading_rad - 0.12).abs() < 0.002, "{heading_rad}");
        assert!((y_m - 0.181).abs() < 0.005, "{y_m}");
        assert!((x_m - 0.006).abs() < 0.001, "{x_m}");
        drive(&mut uncertainty, &mut pose, Wheels::both(-0.2), 462);
        let [_, _, heading_rad] = deviations(&uncertainty);
        let slip_rad = 0.0054 * sqrt(6.0);
        assert!((heading_rad - slip_rad).abs() < 0.001, "{heading_rad}");
    }

    #[test]
    fn derivatives_are_those_of_the_pose() {
        // A path with curves, driven by robots that differ a little from what the odometry assumes.
        let path = |robot: &Geometry| {
            let mut pose = Pose::default();
            for step in 0..400u16 {
                let left = if step % 100 < 50 { 0.1 } else { 0.16 };
                roll(robot, &mut pose, Wheels { left, right: 0.13 });
            }
            pose
        };
        let mut uncertainty = Uncertainty::default();
        let mut pose = Pose::default();
        for step in 0..400u16 {
            let left = if step % 100 < 50 { 0.1 } else { 0.16 };
            drive(&mut uncertainty, &mut pose, Wheels { left, right: 0.13 }, 1);
        }
        let nominal = path(&robot());
        let share = 0.0005;
        let other = |left: f32, right: f32, base: f32| {
            let radius_m = Wheels {
                left: 0.0325 * (1.0 + left * share),
                right: 0.0325 * (1.0 + right * share),
            };
            Geometry::new(radius_m, 0.1 / (1.0 + base * share))
        };
        // The scale of distances alone keeps the angles: base and radii grow alike.
        let robots = [
            other(-0.5, 0.5, 0.0),
            other(0.0, 0.0, 1.0),
            other(1.0, 1.0, -1.0),
        ];
        for (robot, [x, y, h]) in robots.iter().zip(uncertainty.by) {
            let moved = path(robot);
            assert!(
                (moved.x_m - nominal.x_m - x * share).abs() < 2e-4,
                "{robot:?}"
            );
            assert!(
                (moved.y_m - nominal.y_m - y * share).abs() < 2e-4,
                "{robot:?}"
            );
            assert!((wrap_angle(moved.heading_rad - nominal.heading_rad) - h * share).abs() < 1e-4);
        }
    }
}
