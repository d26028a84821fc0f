//! Where a straight wall is, from any of the robot's sonars and the encoders.
//!
//! The wall is the line of points p with p . u(bearing) = distance, in the robot's frame. Two states, distance and
//! bearing of its normal, in an extended Kalman filter: the encoders move them, each reading corrects them.
//!
//! ```text
//! rolled s, turned t:   distance -= s cos(bearing - t/2)      bearing -= t
//! a sonar at m, axis a: h = distance - m . u(bearing)         off = |a - bearing|
//!                       range = h                     within the beam's half angle: the nearest point is in sight
//!                       range = h / cos(off - beam)   beyond: the edge of the beam meets the wall first
//! ```
//!
//! Two sonars side by side thus give the bearing, as the report's trigonometry does, exact also for equal readings; one
//! sonar and odometry do so over some distance, and a sonar on the servo by looking to both sides. Derivation:
//! docs/theory/wall.md.

use crate::math::{abs, atan2, clamp, is_finite, max, min, rotate, sin_cos, sqrt, wrap_angle};
use crate::types::SonarView;

/// Largest angle between a beam's edge and the wall's normal [rad]; beyond, there is no echo.
const LARGEST_INCIDENCE_RAD: f32 = 0.7;
/// Noise of a reading at close range [m].
const NOISE_M: f32 = 0.002;
/// Noise that is added at a range of 1 m, and with its third power below [m]: a weak echo is timed whole cycles wrong.
const NOISE_FAR_M: f32 = 0.008;
/// Innovations count as at most this many standard deviations.
const BELIEF_SD: f32 = 2.0;
/// Innovations beyond this many standard deviations are rejected.
const GATE_SD: f32 = 4.0;
/// From this far within the beam's edge on, ranges are not linear in the bearing [rad].
const EDGE_RAD: f32 = 0.15;
/// Rejected readings in a row after which the wall is assumed to be another one.
const GIVE_IN: u8 = 6;
/// Standard deviation of the distance gained per distance rolled [m/sqrt(m)].
const WAY_NOISE: f32 = 0.01;
/// Standard deviation of the bearing gained per distance rolled [rad/sqrt(m)].
const DRIFT_NOISE: f32 = 0.03;
/// Standard deviation of the bearing gained per angle turned [rad/sqrt(rad)].
const TURN_NOISE: f32 = 0.03;

/// Where the wall is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallEstimate {
    /// From the middle of the wheels' axis, along the wall's normal [m].
    pub distance_m: f32,
    /// Direction to the nearest point of the wall, counter-clockwise from ahead [rad].
    pub bearing_rad: f32,
    /// Its sine and cosine.
    pub facing: (f32, f32),
    /// Variance of the bearing [rad^2].
    pub bearing_variance: f32,
}

impl WallEstimate {
    /// Standard deviation of the bearing [rad].
    pub fn bearing_sd_rad(&self) -> f32 {
        sqrt(max(self.bearing_variance, 0.0))
    }
}

/// State of the wall filter.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WallFilter {
    distance_m: f32,
    bearing_rad: f32,
    /// Sine and cosine of the bearing.
    facing: (f32, f32),
    /// Covariance: distance, both, bearing.
    p: (f32, f32, f32),
    known: bool,
    refused: u8,
}

impl WallFilter {
    /// The wall, once there has been a reading.
    pub fn wall(&self) -> Option<WallEstimate> {
        let (_, _, bearing_variance) = self.p;
        self.known.then_some(WallEstimate {
            distance_m: self.distance_m,
            bearing_rad: self.bearing_rad,
            facing: self.facing,
            bearing_variance,
        })
    }

    /// Whether there has been a reading.
    pub fn is_known(&self) -> bool {
        self.known
    }

    /// Starts from a first reading of a wall expected at `bearing_rad`, give or take `bearing_sd_rad`.
    pub fn start(&mut self, view: &SonarView, range_m: f32, bearing_rad: f32, bearing_sd_rad: f32) {
        let (sin, cos) = sin_cos(bearing_rad);
        // The distance depends on the bearing by the sonar's lever, and on its square where the beam misses the normal.
        let slope_m = view.y_m * cos - view.x_m * sin;
        let pbb = square(bearing_sd_rad);
        *self = Self {
            distance_m: range_m + view.x_m * cos + view.y_m * sin,
            bearing_rad,
            facing: (sin, cos),
            p: (
                square(noise_m(range_m)) + square(slope_m) * pbb + square(0.5 * pbb * range_m),
                slope_m * pbb,
                pbb,
            ),
            known: true,
            refused: 0,
        };
    }

    /// Starts from the readings of two sonars that look ahead, `ahead_m` ahead of the wheels' axis and `gap_m` apart.
    pub fn start_pair(&mut self, ahead_m: f32, gap_m: f32, beam_rad: f32, ranges_m: [f32; 2]) {
        let [left_m, right_m] = ranges_m;
        let (normal_m, bearing_rad) = wall_of_pair(left_m, right_m, gap_m, beam_rad);
        let (sin, cos) = sin_cos(bearing_rad);
        let noise = square(noise_m(normal_m));
        *self = Self {
            distance_m: normal_m + ahead_m * cos,
            bearing_rad,
            facing: (sin, cos),
            p: (noise, 0.0, 2.0 * noise / square(gap_m * cos) + 1e-4),
            known: true,
            refused: 0,
        };
    }

    /// Predicts the wall after the robot rolled `forward_m` and turned `turn_rad` since the last tick.
    pub fn predict(&mut self, forward_m: f32, turn_rad: f32) {
        if !self.known {
            return;
        }
        let before = self.facing;
        if turn_rad != 0.0 {
            self.bearing_rad = wrap_angle(self.bearing_rad - turn_rad);
            self.facing = rotate(before, -turn_rad, self.bearing_rad);
        }
        // In between it moved as in the mean of before and after.
        let half_m = 0.5 * forward_m;
        self.distance_m -= half_m * (before.1 + self.facing.1);
        // d(distance)/d(bearing)
        let slope = half_m * (before.0 + self.facing.0);
        let (pdd, pdb, pbb) = self.p;
        let (way, turn) = (abs(forward_m), abs(turn_rad));
        self.p = (
            pdd + 2.0 * slope * pdb + slope * slope * pbb + square(WAY_NOISE) * way,
            pdb + slope * pbb,
            pbb + square(DRIFT_NOISE) * way + square(TURN_NOISE) * turn,
        );
    }

    /// The range that a sonar with this view and a beam of half angle `beam_rad` should read, and its slopes over
    /// distance and bearing; `None` where the wall gives no echo.
    fn expect(&self, view: &SonarView, beam_rad: f32) -> Option<(f32, f32, f32)> {
        let (sin, cos) = self.facing;
        let normal_m = self.distance_m - (view.x_m * cos + view.y_m * sin);
        let slope_m = view.x_m * sin - view.y_m * cos;
        let off_rad = wrap_angle(view.axis_rad - self.bearing_rad);
        let beyond_rad = abs(off_rad) - beam_rad;
        if normal_m <= 0.0 || beyond_rad > LARGEST_INCIDENCE_RAD {
            return None;
        }
        if beyond_rad <= 0.0 {
            return Some((normal_m, 1.0, slope_m));
        }
        let (sin_beyond, cos_beyond) = sin_cos(beyond_rad);
        let towards = if off_rad > 0.0 { -1.0 } else { 1.0 };
        Some((
            normal_m / cos_beyond,
            1.0 / cos_beyond,
            slope_m / cos_beyond + towards * normal_m * sin_beyond / (cos_beyond * cos_beyond),
        ))
    }

    /// Updates with a reading; returns whether it was accepted.
    pub fn update(&mut self, view: &SonarView, beam_rad: f32, range_m: f32) -> bool {
        if !self.known || !is_finite(range_m) {
            return false;
        }
        let Some((expected_m, hd, hb)) = self.expect(view, beam_rad) else {
            return false;
        };
        // At the beam's edge the range bends with the bearing: what the slope misses is noise.
        let off_rad = wrap_angle(view.axis_rad - self.bearing_rad);
        let (pdd, pdb, pbb) = self.p;
        let bend = if abs(off_rad) > beam_rad - EDGE_RAD {
            square(0.5 * range_m * pbb)
        } else {
            0.0
        };
        let (gd, gb) = (pdd * hd + pdb * hb, pdb * hd + pbb * hb);
        let variance = hd * gd + hb * gb + square(noise_m(range_m)) + bend;
        let innovation_m = range_m - expected_m;
        if square(innovation_m) > square(GATE_SD) * variance {
            self.refused = self.refused.saturating_add(1);
            if self.refused >= GIVE_IN {
                self.known = false;
            }
            return false;
        }
        self.refused = 0;
        let most_m = BELIEF_SD * sqrt(variance);
        // An innovation beyond that is clipped, and reduces the covariance only in part.
        let share = most_m / max(abs(innovation_m), most_m) / variance;
        let (kd, kb) = (share * gd, share * gb);
        self.distance_m = max(self.distance_m + kd * innovation_m, 0.0);
        self.bearing_rad = wrap_angle(self.bearing_rad + kb * innovation_m);
        self.facing = sin_cos(self.bearing_rad);
        self.p = (
            max(pdd - kd * gd, 1e-9),
            pdb - kd * gb,
            max(pbb - kb * gb, 1e-9),
        );
        true
    }
}

/// Distance along the normal from the middle between two sonars that look ahead, and bearing of the normal.
///
/// Within the beams `(right - left) / gap` is the sine of the bearing and the mean the distance, exact also for equal readings. Beyond,
/// both readings are long by 1 / cos(bearing - beam).
pub fn wall_of_pair(left_m: f32, right_m: f32, gap_m: f32, beam_rad: f32) -> (f32, f32) {
    let mut cos_beyond = 1.0;
    let mut bearing_rad = 0.0;
    for _ in 0..3 {
        let sine = clamp((right_m - left_m) / gap_m * cos_beyond, -0.9, 0.9);
        bearing_rad = atan2(sine, sqrt(1.0 - sine * sine));
        (_, cos_beyond) = sin_cos(max(abs(bearing_rad) - beam_rad, 0.0));
    }
    (0.5 * (left_m + right_m) * cos_beyond, bearing_rad)
}

/// Standard deviation of a reading [m].
fn noise_m(range_m: f32) -> f32 {
    let near_m = min(range_m, 1.0);
    NOISE_M + NOISE_FAR_M * near_m * near_m * near_m
}

fn square(x: f32) -> f32 {
    x * x
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f32::consts::FRAC_PI_2;

    const BEAM: f32 = 0.31;

    /// The exact range to a wall at `distance_m` and `bearing_rad`.
    fn range(view: &SonarView, distance_m: f32, bearing_rad: f32) -> f32 {
        let filter = WallFilter {
            distance_m,
            bearing_rad,
            facing: sin_cos(bearing_rad),
            known: true,
            ..WallFilter::default()
        };
        filter.expect(view, BEAM).unwrap().0
    }

    fn side(x_m: f32) -> SonarView {
        SonarView {
            x_m,
            y_m: 0.075,
            axis_rad: FRAC_PI_2,
        }
    }

    #[test]
    fn two_sonars_side_by_side_measure_distance_and_bearing_at_rest() {
        for askew in [-0.2, 0.0, 0.15] {
            let (distance_m, bearing_rad) = (0.5, FRAC_PI_2 + askew);
            let mut filter = WallFilter::default();
            let first = side(0.1);
            filter.start(
                &first,
                range(&first, distance_m, bearing_rad),
                FRAC_PI_2,
                0.4,
            );
            for _ in 0..10 {
                for x_m in [0.1, -0.04] {
                    let view = side(x_m);
                    assert!(filter.update(&view, BEAM, range(&view, distance_m, bearing_rad)));
                }
            }
            let wall = filter.wall().unwrap();
            assert!((wall.distance_m - distance_m).abs() < 2e-3, "{wall:?}");
            assert!((wall.bearing_rad - bearing_rad).abs() < 0.02, "{wall:?}");
        }
    }

    #[test]
    fn a_pair_in_front_starts_it_exactly_also_with_equal_readings_and_beyond_the_beam() {
        let [left, right] = [0.06, -0.06].map(|y_m| SonarView {
            x_m: 0.13,
            y_m,
            axis_rad: 0.0,
        });
        for bearing_rad in [0.0, 0.1, -0.3, 0.45, -0.52] {
            for distance_m in [0.3, 1.3] {
                let ranges_m = [&left, &right].map(|view| range(view, distance_m, bearing_rad));
                let mut filter = WallFilter::default();
                filter.start_pair(0.13, 0.12, BEAM, ranges_m);
                let wall = filter.wall().unwrap();
                assert!(
                    (wall.bearing_rad - bearing_rad).abs() < 5e-3,
                    "{bearing_rad}: {wall:?}"
                );
                assert!(
                    (wall.distance_m - distance_m).abs() < 2e-3,
                    "{distance_m}: {wall:?}"
                );
            }
        }
        assert_eq!(wall_of_pair(0.3, 0.3, 0.12, BEAM), (0.3, 0.0));
    }

    #[test]
    fn one_sonar_and_the_encoders_measure_them_over_some_distance() {
        let (mut distance_m, bearing_rad) = (0.5, FRAC_PI_2 + 0.1);
        let (mut filter, view) = (WallFilter::default(), side(0.03));
        filter.start(&view, range(&view, distance_m, bearing_rad), FRAC_PI_2, 0.3);
        for tick in 0..200 {
            distance_m -= 0.002 * sin_cos(bearing_rad).1;
            filter.predict(0.002, 0.0);
            if tick % 6 == 0 {
                assert!(filter.update(&view, BEAM, range(&view, distance_m, bearing_rad)));
            }
        }
        let wall = filter.wall().unwrap();
        assert!((wall.bearing_rad - bearing_rad).abs() < 0.02, "{wall:?}");
        assert!((wall.distance_m - distance_m).abs() < 3e-3, "{wall:?}");
    }

    #[test]
    fn a_sonar_that_looks_to_both_sides_measures_them_too() {
        let (distance_m, bearing_rad) = (0.5, 0.2);
        let mut filter = WallFilter::default();
        let look = |axis_rad| SonarView {
            x_m: 0.13,
            y_m: 0.0,
            axis_rad,
        };
        let ahead = look(0.0);
        filter.start(&ahead, range(&ahead, distance_m, bearing_rad), 0.0, 0.4);
        for _ in 0..20 {
            for axis_rad in [-0.6, 0.0, 0.6] {
                let view = look(axis_rad);
                filter.update(&view, BEAM, range(&view, distance_m, bearing_rad));
            }
        }
        let wall = filter.wall().unwrap();
        assert!((wall.bearing_rad - bearing_rad).abs() < 0.02, "{wall:?}");
    }

    #[test]
    fn turning_on_the_spot_moves_the_bearing_and_not_the_distance() {
        let mut filter = WallFilter::default();
        let ahead = SonarView::default();
        filter.start(&ahead, 0.5, 0.0, 0.1);
        for _ in 0..50 {
            filter.predict(0.0, 0.01);
        }
        let wall = filter.wall().unwrap();
        assert!((wall.distance_m - 0.5).abs() < 1e-5 && (wall.bearing_rad + 0.5).abs() < 1e-4);
        assert!(wall.bearing_sd_rad() > 0.1);
    }

    #[test]
    fn a_spike_is_refused_and_a_lasting_change_makes_the_wall_unknown() {
        let (mut filter, view) = (WallFilter::default(), side(0.03));
        filter.start(&view, 0.5, FRAC_PI_2, 0.05);
        for _ in 0..20 {
            filter.update(&view, BEAM, 0.5);
        }
        let before = filter.wall();
        assert!(!filter.update(&view, BEAM, 1.3) && filter.wall() == before);
        assert!(filter.update(&view, BEAM, 0.5));
        for _ in 0..GIVE_IN {
            filter.update(&view, BEAM, 1.3);
        }
        assert_eq!(filter.wall(), None);
    }
}
