//! How straight a straight line is: true drift to the side and of the heading, after 3 m and at the end.

use super::Metrics;
use rumbo_sim::trace::{Trace, TruthSample};

/// Way after which the drift is judged [m].
const JUDGED_M: f64 = 3.0;
/// A robot that has not moved this far [m] stands at its start.
const MOVED_M: f64 = 0.001;

/// Drift from the line on which the robot stood at first, without sign.
pub(super) fn drift(trace: &Trace, metrics: &mut Metrics) {
    let (Some(first), Some(last)) = (trace.samples.first(), trace.samples.last()) else {
        return;
    };
    let (sin, cos) = first.heading_rad.sin_cos();
    let ahead_m =
        |sample: &TruthSample| (sample.x_m - first.x_m) * cos + (sample.y_m - first.y_m) * sin;
    let mut put = |name: &str, sample: &TruthSample| {
        let left_m = (sample.y_m - first.y_m) * cos - (sample.x_m - first.x_m) * sin;
        let turned_rad = sample.heading_rad - first.heading_rad;
        metrics.insert(format!("{name}.sideways_m"), left_m.abs());
        metrics.insert(format!("{name}.heading_rad"), turned_rad.abs());
    };
    if let Some(there) = trace
        .samples
        .iter()
        .find(|sample| ahead_m(sample) >= JUDGED_M)
    {
        put("after_3_m", there);
    }
    put("end", last);
    metrics.insert("forward_m".into(), ahead_m(last));
    // The last third of the drive: start and stop left out.
    let moving: Vec<&TruthSample> = trace
        .samples
        .iter()
        .filter(|sample| ahead_m(sample).abs() > MOVED_M && sample.duty != [0; 2])
        .collect();
    let steady = &moving[moving.len() / 3..moving.len() * 9 / 10];
    for (wheel, name) in [(0, "left_rad_s"), (1, "right_rad_s")] {
        let sum: f64 = steady.iter().map(|sample| sample.wheel_rad_s[wheel]).sum();
        metrics.insert(name.into(), sum / steady.len() as f64);
    }
}
