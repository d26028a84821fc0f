//! Metrics of a basic movement: its end point, its turn, and the wheels' response.

use super::Metrics;
use crate::files::Setup;
use rumbo_sim::trace::{Trace, TruthSample};
use rumbo_wire::Command;

/// Shortest path that has a radius [m]; turning on the spot has none.
const MOVED_M: f64 = 0.2;

/// Metrics of the movement as a whole, from the first [`Command::Move`] to the end; of a program of one's own that is
/// told none, from the start.
pub(super) fn movement(setup: &Setup, trace: &Trace, metrics: &mut Metrics) {
    let moves = |command: &Command| matches!(command, Command::Move { .. });
    let Some(from_s) = setup
        .scenario
        .commands
        .iter()
        .find(|timed| moves(&timed.command))
        .map(|timed| timed.at_s)
        .or(setup.firmware.as_ref().map(|_| 0.0))
    else {
        return;
    };
    let samples = trace.between(from_s, f64::INFINITY);
    let (Some(first), Some(last)) = (samples.first(), samples.last()) else {
        return;
    };
    let mut put = |name: &str, value: f64| metrics.insert(name.into(), value);
    if !setup.scenario.wheels_in_air {
        let (dx, dy) = (last.x_m - first.x_m, last.y_m - first.y_m);
        let (sin, cos) = first.heading_rad.sin_cos();
        let length: f64 = samples
            .windows(2)
            .map(|two| (two[1].x_m - two[0].x_m).hypot(two[1].y_m - two[0].y_m))
            .sum();
        let turn = last.heading_rad - first.heading_rad;
        put("forward_m", dx * cos + dy * sin);
        put("sideways_m", dy * cos - dx * sin);
        put("path_m", length);
        put("turn_rad", turn);
        if turn.abs() > 0.1 && length > MOVED_M {
            put("radius_m", length / turn.abs());
        }
    }
    // The last third of the movement, up to its end: start and stop left out.
    let moving: Vec<&TruthSample> = samples
        .iter()
        .filter(|sample| sample.duty != [0; 2])
        .collect();
    let steady = &moving[moving.len() * 2 / 3..];
    if steady.is_empty() {
        return;
    }
    let mean = |wheel: usize| {
        steady
            .iter()
            .map(|sample| sample.wheel_rad_s[wheel])
            .sum::<f64>()
            / steady.len() as f64
    };
    put("left_rad_s", mean(0));
    put("right_rad_s", mean(1));
    if mean(0).abs() > 0.1 && mean(1).abs() > 0.1 {
        put("asymmetry", mean(0).abs() / mean(1).abs() - 1.0);
    }
}
