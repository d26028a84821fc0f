//! The dead zone of each wheel: the duty at which it starts to turn.

use super::Metrics;
use crate::trace::Trace;

/// A wheel turns when it is faster than this [rad/s]: 5 rpm.
const TURNING_RAD_S: f64 = 0.52;

/// For each wheel that starts from rest, the duty at which it did.
pub(super) fn dead_zones(trace: &Trace, metrics: &mut Metrics) {
    for (wheel, name) in [(0, "left_dead_zone_duty"), (1, "right_dead_zone_duty")] {
        let start = trace.samples.iter().find(|sample| {
            sample.duty[wheel] != 0 && sample.wheel_rad_s[wheel].abs() > TURNING_RAD_S
        });
        if let Some(sample) = start {
            metrics.insert(name.into(), f64::from(sample.duty[wheel].abs()) / 255.0);
        }
    }
}
