//! What one telemetry frame says.

use rumbo_control::{SonarId, Wheels};

/// The content of one telemetry frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sample {
    /// Robot time, unwrapped [s].
    pub(super) t_s: f64,
    /// Position by odometry [m].
    pub(super) x_m: f64,
    /// Position by odometry [m].
    pub(super) y_m: f64,
    /// Heading by odometry, not wrapped [rad].
    pub(super) heading_rad: f64,
    /// Wheel speeds [rad/s].
    pub(super) wheel_rad_s: Wheels<f64>,
    /// Their references [rad/s]; 0 open loop.
    pub(super) reference_rad_s: Wheels<f64>,
    /// Duty of the wheels, -1..=1.
    pub(super) duty: Wheels<f64>,
    /// Ranges of the sonars by number [m].
    pub(super) range_m: [Option<f64>; 3],
    /// Sonars that no longer answer, by number.
    pub(super) faulty: [bool; 3],
}

impl Sample {
    /// The range of a sonar [m].
    pub(super) fn range_m(&self, sonar: SonarId) -> Option<f64> {
        self.range_m[sonar as usize]
    }
}
