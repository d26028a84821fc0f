//! The origin of the robot's odometry in the world, as well as it can be known.
//!
//! The origin moves on command, and in mode 8 to each goal reached. Telemetry does not report this; it shows as a pose
//! that drops to zero faster than any robot drives. With a simulated robot the ground truth then gives the origin; with
//! a real one it is the pose estimated just before. Between two moves, odometry error shows as the distance between the
//! pose drawn from this origin and the robot.
//!
//! The pose's uncertainty since then is also computed here, from the reported poses: the robot has no use for it.
//! Derivation: docs/theory/odometry.md.

use rumbo_control::Pose;
use rumbo_control::odometry::{OdometryErrors, PathStep, Uncertainty};
use rumbo_log::{MapPose, Spread, compose};

/// Faster than a robot drives [m/s].
const TOO_FAST_M_S: f64 = 1.5;
/// Faster than it turns [rad/s].
const TOO_FAST_RAD_S: f64 = 15.0;
/// Largest quantisation of telemetry in a difference [m] or [rad].
const STEP: f64 = 0.003;

/// The origin, followed from pose to pose.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Origin {
    at: MapPose,
    /// The pose last reported and its time [ms].
    last: Option<(i64, Pose)>,
    uncertainty: Uncertainty,
}

impl Origin {
    /// An odometry that begins here.
    pub(crate) fn new(at: MapPose) -> Self {
        Self {
            at,
            ..Self::default()
        }
    }

    /// A pose from the origin, in the world.
    pub(crate) fn place(&self, estimated: MapPose) -> MapPose {
        compose(self.at, estimated)
    }

    /// Takes the pose reported for `t_ms`, the true pose where it is known, and the errors of the robot's dimensions;
    /// returns the origin in the world.
    pub(crate) fn follow(
        &mut self,
        t_ms: i64,
        reported: Pose,
        truth: Option<MapPose>,
        errors: &OdometryErrors,
    ) -> MapPose {
        if !(reported.x_m + reported.y_m + reported.heading_rad).is_finite() {
            return self.at;
        }
        if let Some((before_ms, before)) = self.last {
            if has_moved(
                (t_ms - before_ms) as f64 / 1e3,
                before.into(),
                reported.into(),
            ) {
                self.at = match truth {
                    Some(truth) => compose(truth, inverse(reported.into())),
                    None => compose(self.at, before.into()),
                };
                self.settle();
            } else {
                let step = PathStep::between(&before, &reported, errors.base_m);
                self.uncertainty.advance(errors, &step);
            }
        }
        self.last = Some((t_ms, reported));
        self.at
    }

    /// Makes the present pose the origin, for moves too small to be detected.
    pub(crate) fn settle(&mut self) {
        self.uncertainty = Uncertainty::default();
    }

    /// Uncertainty of the pose last reported.
    pub(crate) fn spread(&self, errors: &OdometryErrors) -> Spread {
        let [[xx, xy, _], [_, yy, _], [_, _, hh]] = self.uncertainty.covariance(errors);
        let [x_m, y_m, heading_rad] = [xx, yy, hh].map(|variance| variance.max(0.0).sqrt());
        let both = x_m * y_m;
        Spread {
            x_m,
            y_m,
            correlation: if both > 0.0 { xy / both } else { 0.0 },
            heading_rad,
        }
    }
}

/// Whether the origin has moved: the pose went to zero within `dt_s`, faster than the robot.
fn has_moved(dt_s: f64, before: MapPose, now: MapPose) -> bool {
    let (reach_m, reach_rad) = (
        TOO_FAST_M_S * dt_s.max(0.0) + STEP,
        TOO_FAST_RAD_S * dt_s.max(0.0) + STEP,
    );
    let step_m = (now.x_m - before.x_m).hypot(now.y_m - before.y_m);
    let jumped = step_m > reach_m || turn_rad(before.heading_rad, now.heading_rad) > reach_rad;
    jumped && now.x_m.hypot(now.y_m) <= reach_m && turn_rad(0.0, now.heading_rad) <= reach_rad
}

/// Angle between two headings, 0..=pi.
fn turn_rad(from_rad: f64, to_rad: f64) -> f64 {
    let difference = to_rad - from_rad;
    difference.sin().atan2(difference.cos()).abs()
}

/// The inverse transform of `at`.
fn inverse(at: MapPose) -> MapPose {
    let (sin, cos) = at.heading_rad.sin_cos();
    MapPose {
        x_m: -cos * at.x_m - sin * at.y_m,
        y_m: sin * at.x_m - cos * at.y_m,
        heading_rad: -at.heading_rad,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rumbo_control::params::Params;
    use std::f32::consts::FRAC_PI_2;

    fn pose(x_m: f32, y_m: f32, heading_rad: f32) -> Pose {
        Pose {
            x_m,
            y_m,
            heading_rad,
        }
    }

    fn place(x_m: f64, y_m: f64, heading_rad: f64) -> MapPose {
        MapPose {
            x_m,
            y_m,
            heading_rad,
        }
    }

    fn errors() -> OdometryErrors {
        Params::default().odometry_errors()
    }

    fn near(a: MapPose, b: MapPose) -> bool {
        (a.x_m - b.x_m).hypot(a.y_m - b.y_m) < 1e-6 && turn_rad(a.heading_rad, b.heading_rad) < 1e-6
    }

    #[test]
    fn driving_turning_and_lost_frames_do_not_move_the_origin() {
        let start = place(0.5, 0.2, 0.1);
        let mut origin = Origin::new(start);
        let mut x_m = 0.0;
        for frame in 0..200 {
            // Every tenth frame is missing, and the heading wraps.
            if frame % 10 != 0 {
                let heading_rad = (frame as f32 * 0.3).sin() * 3.1;
                origin.follow(frame * 40, pose(x_m, 0.0, heading_rad), None, &errors());
            }
            x_m += 0.03;
        }
        assert_eq!(
            origin.follow(
                8_040,
                pose(x_m, 0.0, 3.0),
                Some(place(9.0, 9.0, 0.0)),
                &errors()
            ),
            start
        );
    }

    #[test]
    fn at_a_goal_the_origin_moves_to_where_a_simulated_robot_really_is() {
        let mut origin = Origin::new(MapPose::default());
        origin.follow(
            0,
            pose(1.0, 1.0, FRAC_PI_2),
            Some(place(1.02, 0.97, 1.55)),
            &errors(),
        );
        // 20 ms later it is at rest there, and has called the place its origin.
        let truth = place(1.02, 0.97, 1.55);
        let moved = origin.follow(40, pose(0.0, 0.0, 0.0), Some(truth), &errors());
        assert!(near(moved, truth), "{moved:?}");
        // On it drives, with an error of its own.
        let on = origin.follow(
            80,
            pose(0.02, 0.0, 0.0),
            Some(place(1.02, 0.98, 1.5)),
            &errors(),
        );
        assert_eq!(on, moved);
    }

    #[test]
    fn a_real_robot_s_origin_moves_to_where_it_believed_to_be() {
        let mut origin = Origin::new(place(0.0, 1.0, 0.0));
        origin.follow(0, pose(1.0, 0.0, FRAC_PI_2), None, &errors());
        let moved = origin.follow(40, pose(0.0, 0.0, 0.0), None, &errors());
        assert!(near(moved, place(1.0, 1.0, FRAC_PI_2.into())), "{moved:?}");
    }

    #[test]
    fn a_turn_on_the_spot_is_called_zero_too() {
        let mut origin = Origin::new(MapPose::default());
        origin.follow(0, pose(0.0, 0.0, 2.0), None, &errors());
        let moved = origin.follow(40, pose(0.0, 0.0, 0.0), None, &errors());
        assert!(near(moved, place(0.0, 0.0, 2.0)), "{moved:?}");
    }

    #[test]
    fn the_spread_grows_on_the_way_and_ends_where_the_origin_moves() {
        let mut origin = Origin::new(MapPose::default());
        let at_rest = origin.spread(&errors());
        for frame in 0..=100u16 {
            let x_m = 0.01 * f32::from(frame);
            origin.follow(i64::from(frame) * 40, pose(x_m, 0.0, 0.0), None, &errors());
        }
        let there = origin.spread(&errors());
        assert!(there.x_m < 0.004 && there.y_m > 0.015, "{there:?}");
        origin.follow(4_040, pose(0.0, 0.0, 0.0), None, &errors());
        assert_eq!(origin.spread(&errors()), at_rest);
    }

    #[test]
    fn on_the_way_to_the_left_x_and_y_change_their_roles() {
        let mut origin = Origin::new(MapPose::default());
        for frame in 0..=100u16 {
            let way_m = 0.01 * f32::from(frame);
            let slanted = pose(0.6 * way_m, 0.8 * way_m, 0.8f32.atan2(0.6));
            origin.follow(i64::from(frame) * 40, slanted, None, &errors());
        }
        // Aside of its way it may be off far more than along: to the right and ahead of x, or to the left and behind.
        let there = origin.spread(&errors());
        assert!(
            there.x_m > 1.2 * there.y_m && there.correlation < -0.9,
            "{there:?}"
        );
    }
}
