//! Metrics of a lane: when its four straights were done, how the turns between them came out, and how near the boxes were.

use super::Metrics;
use crate::files::Setup;
use crate::trace::{Sample, Trace};
use rumbo_plant::world::World;
use rumbo_wire::Command;
use std::f64::consts::FRAC_PI_2;

/// Straights of the lane of the report.
const STRAIGHTS: usize = 4;
/// A robot within this of a multiple of a quarter turn [rad] that moves forward is on a straight.
const ALONG_RAD: f64 = 0.25;
/// Way that makes a straight [m].
const STRAIGHT_M: f64 = 0.1;
/// Wheels slower than this stand [rad/s].
const STANDS_RAD_S: f64 = 0.05;
/// Points along the outline of the body are this far apart [m].
const OUTLINE_M: f64 = 0.005;

/// One straight: the headings at its beginning, counted in quarter turns from the start, and the times of its begin and its end.
struct Straight {
    quarter: f64,
    begin: Sample,
    end_s: f64,
    way_m: f64,
}

/// The straights of a run: the robot drives along a multiple of a quarter turn from its first heading until it stands.
fn straights(samples: &[Sample]) -> Vec<Straight> {
    let mut found: Vec<Straight> = Vec::new();
    let Some(first) = samples.first() else {
        return found;
    };
    let mut current: Option<Straight> = None;
    for two in samples.windows(2) {
        let quarter = ((two[1].heading_rad - first.heading_rad) / FRAC_PI_2).round();
        let off_rad = two[1].heading_rad - first.heading_rad - quarter * FRAC_PI_2;
        let stands = two[1]
            .wheel_rad_s
            .iter()
            .all(|rad_s| rad_s.abs() < STANDS_RAD_S);
        let forward = two[1].wheel_rad_s.iter().sum::<f64>() > STANDS_RAD_S;
        let step_m = (two[1].x_m - two[0].x_m).hypot(two[1].y_m - two[0].y_m);
        match current.take() {
            Some(mut straight) if straight.quarter == quarter && !stands => {
                straight.way_m += step_m;
                current = Some(straight);
            }
            Some(mut straight) => {
                straight.end_s = two[1].t_s;
                if straight.way_m > STRAIGHT_M {
                    match found.last_mut() {
                        // It stood and went on the same way: one straight.
                        Some(last) if last.quarter == straight.quarter => {
                            last.end_s = straight.end_s;
                            last.way_m += straight.way_m;
                        }
                        _ => found.push(straight),
                    }
                }
            }
            None if !stands && forward && off_rad.abs() < ALONG_RAD => {
                current = Some(Straight {
                    quarter,
                    begin: two[0],
                    end_s: f64::INFINITY,
                    way_m: step_m,
                });
            }
            None => {}
        }
    }
    found
}

/// The outline of a body from `from` to `to` in its own frame.
fn outline(from: [f64; 2], to: [f64; 2]) -> Vec<[f64; 2]> {
    let corners = [from, [to[0], from[1]], to, [from[0], to[1]], from];
    let mut points = Vec::new();
    for side in corners.windows(2) {
        let length_m = (side[1][0] - side[0][0]).hypot(side[1][1] - side[0][1]);
        let count = (length_m / OUTLINE_M).ceil();
        let mut step = 0.0;
        while step < count {
            points.push(
                [0, 1].map(|axis| side[0][axis] + (side[1][axis] - side[0][axis]) * step / count),
            );
            step += 1.0;
        }
    }
    points
}

/// Least distance of the body from any box [m].
fn clearance_m(world: &World, body: &[[f64; 2]], samples: &[Sample]) -> f64 {
    let mut least_m = f64::INFINITY;
    for sample in samples.iter().step_by(5) {
        let (sin, cos) = sample.heading_rad.sin_cos();
        for [ahead_m, left_m] in body {
            let point = [
                sample.x_m + cos * ahead_m - sin * left_m,
                sample.y_m + sin * ahead_m + cos * left_m,
            ];
            for obstacle in world.obstacles() {
                least_m = least_m.min(obstacle.distance_m(point));
            }
        }
    }
    least_m
}

/// The metrics of a scenario that follows a lane; none for others.
pub(super) fn lane(setup: &Setup, trace: &Trace, metrics: &mut Metrics) {
    let mut commands = setup.scenario.commands.iter();
    let Some(begin) = commands.find(|timed| timed.command == Command::Lane) else {
        return;
    };
    let samples = trace.between(begin.at_s, f64::INFINITY);
    let straights = straights(samples);
    let mut put = |name: &str, value: f64| metrics.insert(name.into(), value);
    let lane = &straights[..straights.len().min(STRAIGHTS)];
    let finish_s = lane
        .get(STRAIGHTS - 1)
        .map_or(f64::NAN, |last| last.end_s - begin.at_s);
    let first_rad = samples.first().map_or(f64::NAN, |first| first.heading_rad);
    let mut worst_rad = f64::NAN;
    for (number, two) in lane.windows(2).enumerate() {
        let turn_rad = two[1].begin.heading_rad - two[0].begin.heading_rad;
        put(&format!("turn{}_rad", number + 1), turn_rad);
        let error_rad = two[1].begin.heading_rad - first_rad - two[1].quarter * FRAC_PI_2;
        worst_rad = error_rad.abs().max(worst_rad);
    }
    put("finish_s", finish_s);
    put("straights", straights.len() as f64);
    put("heading_error_rad", worst_rad);
    put("path_m", lane.iter().map(|straight| straight.way_m).sum());
    let body = &setup.robot.plant.body;
    let (half_m, aside_m) = (0.5 * body.length_m, 0.5 * body.width_m);
    let outline = outline(
        [body.centre_ahead_m - half_m, -aside_m],
        [body.centre_ahead_m + half_m, aside_m],
    );
    if let Ok(world) = setup.world.world() {
        put("clearance_m", clearance_m(&world, &outline, samples));
    }
}
