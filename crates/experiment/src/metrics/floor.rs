//! How a robot with line sensors keeps to the lines of its world: the middle of its sensors, by ground truth.

use super::Metrics;
use crate::files::Setup;
use rumbo_plant::contact::Pose;
use rumbo_sim::floor::{DarkLine, Nearest, nearest};
use rumbo_sim::trace::Trace;

/// A robot that drives to its line has this long [s].
const FROM_S: f64 = 1.0;
/// Farther from it the robot has lost its line [m].
pub(crate) const LOST_M: f64 = 0.05;

/// From sample to sample a robot does not go farther along its line: it is another place of it [m].
const STEP_M: f64 = 0.05;

/// Where the middle of the line sensors was by the nearest line, in time [s]; nothing without sensors or lines.
pub(crate) fn places(setup: &Setup, trace: &Trace) -> Vec<(f64, Nearest)> {
    let sensors = setup
        .firmware
        .as_ref()
        .map(|firmware| firmware.line_sensors());
    let sensors = sensors.unwrap_or_default();
    if sensors.is_empty() {
        return Vec::new();
    }
    let mut middle = sensors[0].clone();
    for axis in 0..2 {
        let sum: f64 = sensors.iter().map(|sensor| sensor.at_m[axis]).sum();
        middle.at_m[axis] = sum / sensors.len() as f64;
    }
    let samples = trace.between(FROM_S, f64::INFINITY);
    let places = samples.iter().filter_map(|sample| {
        let pose = Pose {
            x_m: sample.x_m,
            y_m: sample.y_m,
            heading_rad: sample.heading_rad,
        };
        let place = nearest(&setup.world.lines, middle.place(&pose))?;
        Some((sample.t_s, place))
    });
    places.collect()
}

/// The distance from the nearest line, the way along it, and for how long it was lost.
pub(super) fn following(setup: &Setup, trace: &Trace, metrics: &mut Metrics) {
    let places = places(setup, trace).into_iter();
    let places: Vec<Nearest> = places.map(|(_, place)| place).collect();
    if places.is_empty() {
        return;
    }
    let distances: Vec<f64> = places.iter().map(|place| place.distance_m).collect();
    let count = distances.len().max(1) as f64;
    let square: f64 = distances.iter().map(|distance| distance * distance).sum();
    let lost = distances
        .iter()
        .filter(|distance| **distance > LOST_M)
        .count() as f64;
    let mut put = |name: &str, value: f64| metrics.insert(name.into(), value);
    put("line_rms_m", (square / count).sqrt());
    put(
        "line_worst_m",
        distances.iter().copied().fold(0.0, f64::max),
    );
    put("line_lost_share", lost / count);
    put("line_way_m", way_m(&setup.world.lines, &places));
}

/// How far it came along its line, either way.
pub(crate) fn way_m(lines: &[DarkLine], places: &[Nearest]) -> f64 {
    let steps = places.windows(2).map(|pair| {
        let step_m = pair[1].along_m - pair[0].along_m;
        let lap_m = lines.get(pair[1].line).and_then(DarkLine::lap_m);
        // Over the first point of a closed line.
        let step_m = lap_m.map_or(step_m, |lap_m| step_m - lap_m * (step_m / lap_m).round());
        let is_on = pair.iter().all(|place| place.distance_m <= LOST_M);
        match is_on && pair[0].line == pair[1].line && step_m.abs() < STEP_M {
            true => step_m,
            false => 0.0,
        }
    });
    steps.sum::<f64>().abs()
}
