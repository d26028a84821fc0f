//! The static curve: wheel speed over duty, when the duty goes slowly up and down again.

use super::Metrics;
use crate::files::Setup;
use rumbo_control::mode::MovementLevel;
use rumbo_sim::trace::{Trace, TruthSample};
use rumbo_wire::Command;

/// Duties at which the curve is read [% of full PWM].
const READ_PERCENT: [i16; 6] = [20, 25, 30, 35, 40, 45];
/// A wheel stands below this [rad/s].
const STANDING_RAD_S: f64 = 0.1;

/// The curve of each driven wheel, if the scenario's duty goes down as well as up.
pub(super) fn curve(setup: &Setup, trace: &Trace, metrics: &mut Metrics) {
    let duties: Vec<f32> = setup
        .scenario
        .commands
        .iter()
        .filter_map(|timed| match timed.command {
            Command::Move {
                level: MovementLevel::Duty(duty),
                ..
            } => Some(duty),
            _ => None,
        })
        .collect();
    let rises = duties.windows(2).filter(|two| two[1] > two[0]).count();
    let falls = duties.windows(2).filter(|two| two[1] < two[0]).count();
    // A ramp has many steps; the command that ends a movement is one.
    if rises < 20 || falls < 20 {
        return;
    }
    for (wheel, side) in [(0, "left"), (1, "right")] {
        let duty = |sample: &TruthSample| sample.duty[wheel].abs();
        let Some(top) = trace.samples.iter().map(duty).max().filter(|top| *top > 0) else {
            continue;
        };
        let turn = trace
            .samples
            .partition_point(|sample| sample.t_s < top_s(trace, wheel, top));
        let (up, down) = trace.samples.split_at(turn);
        for (samples, way) in [(up, "up"), (down, "down")] {
            for percent in READ_PERCENT {
                let at = (f64::from(percent) * 2.55).round() as i16;
                let speeds: Vec<f64> = samples
                    .iter()
                    .filter(|sample| (duty(sample) - at).abs() <= 1)
                    .map(|sample| sample.wheel_rad_s[wheel].abs())
                    .collect();
                if !speeds.is_empty() {
                    let mean = speeds.iter().sum::<f64>() / speeds.len() as f64;
                    metrics.insert(format!("{way}{percent}.{side}_rad_s"), mean);
                }
            }
        }
        let still = |sample: &&TruthSample| {
            duty(sample) > 0 && sample.wheel_rad_s[wheel].abs() < STANDING_RAD_S
        };
        if let Some(stop) = down.iter().find(still) {
            metrics.insert(format!("{side}_stop_duty"), f64::from(duty(stop)) / 255.0);
        }
    }
}

/// When the duty was at its top for the last time [s].
fn top_s(trace: &Trace, wheel: usize, top: i16) -> f64 {
    trace
        .samples
        .iter()
        .rev()
        .find(|sample| sample.duty[wheel].abs() == top)
        .map_or(f64::INFINITY, |sample| sample.t_s)
}
