//! How near a robot with light sensors comes to the lamps of its world, by ground truth.

use super::Metrics;
use crate::files::Setup;
use rumbo_sim::trace::Trace;

/// The distance of the middle of the wheels' axis from the nearest lamp, the least and the last.
pub(super) fn seeking(setup: &Setup, trace: &Trace, metrics: &mut Metrics) {
    let sensors = setup
        .firmware
        .as_ref()
        .map(|firmware| firmware.light_sensors());
    let lamps = &setup.world.light.lamps;
    if sensors.unwrap_or_default().is_empty() || lamps.is_empty() {
        return;
    }
    let samples = trace.between(0.0, f64::INFINITY).iter();
    let away_m: Vec<f64> = samples
        .map(|sample| {
            let away_m = lamps
                .iter()
                .map(|lamp| libm::hypot(lamp.at_m[0] - sample.x_m, lamp.at_m[1] - sample.y_m));
            away_m.fold(f64::INFINITY, f64::min)
        })
        .collect();
    let closest_m = away_m.iter().copied().fold(f64::INFINITY, f64::min);
    metrics.insert("lamp_closest_m".into(), closest_m);
    metrics.insert(
        "lamp_m".into(),
        away_m.last().copied().unwrap_or(f64::INFINITY),
    );
}
