//! The robot's own calibration, by movements that it makes itself beside a wall. Derivation: docs/theory/calibration.md.
//!
//! ```text
//! slow ramps of the duty          -> dead zone of each wheel and direction
//! legs along the wall, to and fro -> the distance to the wall along a leg is a parabola: ratio of the radii
//!                                    steady duty at three speeds: feedforward of each wheel and direction
//!                                    the front sonar along a leg: mean radius (as good as the speed of sound is known)
//! whole turns between two legs    -> the heading to the wall before and after: distance between the wheels
//! ```
//!
//! It works from the station's end of a link, with ordinary commands and telemetry, and blocks on nothing: a
//! [`Calibrator`] is advanced with the time and the bytes received.

mod calibrator;
mod error;
mod fit;
mod link;
mod moves;
mod procedure;
mod report;
mod rewrite;
mod sample;
pub(crate) mod simulated;
mod station;

pub use calibrator::{Calibrator, Linked, calibrate};
pub use error::CalibrateError;
pub use fit::{FittedFeedforward, Measured};
pub use report::{CalibrationRow, rows};
pub use rewrite::{is_calibrated, rewrite};
pub use simulated::{WORLD, calibrate_simulated};

use rumbo_control::params::ParamId;
use rumbo_control::{Side, Wheels};

/// Result of a calibration.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibration {
    /// Radius of the right wheel over that of the left one.
    pub ratio: Measured,
    /// Distance between the wheels [m].
    pub base_m: Measured,
    /// Mean radius by the front sonar [m]; `None` without a view ahead. Its error includes that of the speed of sound.
    pub radius_m: Option<Measured>,
    /// Mean radius in force, kept unless the sonar measures it better [m].
    pub radius_before_m: Measured,
    /// Duty at which each wheel broke away, forward and backward.
    pub dead_zone: [Wheels<Option<f64>>; 2],
    /// Duty for each speed.
    pub feedforward: FittedFeedforward,
    /// How long it took [s].
    pub duration_s: f64,
    /// Distance driven along the wall [m].
    pub way_m: f64,
    /// The parameters that it set, with their values before.
    pub before: Vec<(ParamId, f32)>,
}

impl Calibration {
    /// Mean radius to use [m]: the sonar's only if its error is the smaller one.
    pub fn mean_radius_m(&self) -> f64 {
        match self.radius_m {
            Some(sonar) if sonar.error < self.radius_before_m.error => sonar.value,
            _ => self.radius_before_m.value,
        }
    }

    /// The radius of a wheel [m].
    pub fn wheel_radius_m(&self, side: Side) -> f64 {
        let left_m = 2.0 * self.mean_radius_m() / (1.0 + self.ratio.value);
        match side {
            Side::Left => left_m,
            Side::Right => left_m * self.ratio.value,
        }
    }

    /// The parameters to set, within their limits.
    pub fn parameters(&self) -> Vec<(ParamId, f32)> {
        let FittedFeedforward {
            forward,
            backward,
            velocity,
        } = &self.feedforward;
        // The base was found with the mean radius in force; another one scales it alike.
        let base_m = self.base_m.value * self.mean_radius_m() / self.radius_before_m.value;
        [
            (ParamId::RadiusLeft, self.wheel_radius_m(Side::Left)),
            (ParamId::RadiusRight, self.wheel_radius_m(Side::Right)),
            (ParamId::Base, base_m),
            (ParamId::StaticLeftForward, forward.left.value),
            (ParamId::StaticLeftBackward, backward.left.value),
            (ParamId::StaticRightForward, forward.right.value),
            (ParamId::StaticRightBackward, backward.right.value),
            (ParamId::Velocity, velocity.value),
            (ParamId::RatioError, self.ratio.error),
            (ParamId::TurnError, self.base_m.error / self.base_m.value),
        ]
        .into_iter()
        .map(|(id, value)| {
            let limits = id.limits();
            (id, (value as f32).clamp(limits.min, limits.max))
        })
        .collect()
    }
}
