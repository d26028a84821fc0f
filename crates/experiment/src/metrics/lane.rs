//! Metrics of a lane: completion times of its four straights, errors of the turns, and the clearance to the boxes.

use super::Metrics;
use crate::files::Setup;
use rumbo_plant::world::World;
use rumbo_sim::trace::{Trace, TruthSample};
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

/// One straight: the headings at its beginning, counted in quarter turns from the start, and the times of its begin and
/// its end.
struct Straight {
    quarter: f64,
    begin: TruthSample,
    end_s: f64,
    way_m: f64,
}

/// The straights of a run: the robot drives along a multiple of a quarter turn from its first heading until it stands.
fn straights(samples: &[TruthSample]) -> Vec<Straight> {
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
fn clearance_m(world: &World, body: &[[f64; 2]], samples: &[TruthSample]) -> f64 {
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

#[cfg(test)]
mod tests {
    use super::*;
    use rumbo_plant::world::Block;

    /// A robot that drives each piece, a way [m] along its heading or a turn on the spot [rad], and stands for a moment
    /// after it.
    fn driven(pieces: &[(f64, f64)]) -> Vec<TruthSample> {
        const STEPS: i32 = 50;
        let mut sample = TruthSample {
            t_s: 0.0,
            x_m: 0.0,
            y_m: 0.0,
            heading_rad: 0.3,
            wrapped_rad: 0.3,
            wheel_rad_s: [0.0; 2],
            duty: [0; 2],
            seen_m: Some([f64::INFINITY; _]),
            servo_rad: 0.0,
            battery_v: 7.4,
            touching: false,
        };
        let mut samples = vec![sample];
        for (way_m, turn_rad) in pieces {
            for _ in 0..STEPS {
                let step_m = way_m / f64::from(STEPS);
                sample.t_s += 0.01;
                sample.x_m += step_m * sample.heading_rad.cos();
                sample.y_m += step_m * sample.heading_rad.sin();
                sample.heading_rad += turn_rad / f64::from(STEPS);
                let (forward, turn) = (10.0 * way_m, 2.0 * turn_rad);
                sample.wheel_rad_s = [forward - turn, forward + turn];
                samples.push(sample);
            }
            sample.t_s += 0.01;
            sample.wheel_rad_s = [0.0; 2];
            samples.push(sample);
        }
        samples
    }

    #[test]
    fn straights_are_what_is_driven_between_quarter_turns() {
        let samples = driven(&[
            (0.5, 0.0),
            (0.0, FRAC_PI_2),
            (0.65, 0.0),
            (0.0, -1.5),
            (0.95, 0.0),
        ]);
        let found = straights(&samples);
        let quarters: Vec<_> = found.iter().map(|straight| straight.quarter).collect();
        assert_eq!(quarters, [0.0, 1.0, 0.0]);
        for (straight, way_m) in found.iter().zip([0.5, 0.65, 0.95]) {
            assert!((straight.way_m - way_m).abs() < 0.02, "{}", straight.way_m);
        }
        let end_s = samples.last().unwrap().t_s;
        assert!((found[2].end_s - end_s).abs() < 1e-9);
        let turned_rad = found[2].begin.heading_rad - 0.3;
        assert!(
            (turned_rad - (FRAC_PI_2 - 1.5)).abs() < 0.01,
            "{turned_rad}"
        );
    }

    #[test]
    fn a_stop_on_the_way_does_not_make_two_straights_and_a_nudge_makes_none() {
        let stopped = straights(&driven(&[(0.5, 0.0), (0.4, 0.0)]));
        assert_eq!(stopped.len(), 1);
        assert!((stopped[0].way_m - 0.9).abs() < 0.02);
        let nudged = straights(&driven(&[(0.5, 0.0), (0.0, FRAC_PI_2), (0.05, 0.0)]));
        assert_eq!(nudged.len(), 1);
        assert!(straights(&[]).is_empty());
    }

    #[test]
    fn the_clearance_is_that_of_the_bodys_nearest_point() {
        let block = Block {
            center_m: [1.0, 0.5],
            size_m: [0.4, 0.4],
            heading_rad: 0.0,
        };
        let world = World::new(&[], &[block]).unwrap();
        let body = outline([-0.07, -0.075], [0.13, 0.075]);
        let sample = TruthSample {
            x_m: 1.0,
            heading_rad: 0.0,
            ..driven(&[])[0]
        };
        // The box begins at y = 0.3, the body ends at y = 0.075.
        let least_m = clearance_m(&world, &body, &[sample]);
        assert!((least_m - 0.225).abs() < 1e-9, "{least_m}");
    }
}
