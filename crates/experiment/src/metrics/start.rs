//! The dead zone of each wheel: the duty at which it starts to turn when the duty grows slowly.

use super::Metrics;
use rumbo_sim::trace::{SAMPLE_US, Trace};

/// A wheel turns when it is faster than this [rad/s]: 5 rpm.
const TURNING_RAD_S: f64 = 0.52;
/// Only a wheel that stood against some duty for this long shows its dead zone [s]; a step of the duty skips it.
const STOOD_S: f64 = 0.5;

/// For each wheel that stood against a duty and then started, the duty at which it did.
pub(super) fn dead_zones(trace: &Trace, metrics: &mut Metrics) {
    for (wheel, name) in [(0, "left_dead_zone_duty"), (1, "right_dead_zone_duty")] {
        let mut driven = trace
            .samples
            .iter()
            .filter(|sample| sample.duty[wheel] != 0)
            .enumerate();
        let start = driven.find(|(_, sample)| sample.wheel_rad_s[wheel].abs() > TURNING_RAD_S);
        if let Some((stood, sample)) = start
            && stood as f64 * SAMPLE_US as f64 * 1e-6 >= STOOD_S
        {
            metrics.insert(name.into(), f64::from(sample.duty[wheel].abs()) / 255.0);
        }
    }
}
