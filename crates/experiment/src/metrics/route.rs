//! Metrics of a route: how far the robot strayed from it, by its own odometry and in truth, where it ended, how long it
//! took.
//!
//! The route is a polyline from where the robot stands when it starts. The odometry is that of the telemetry.

use super::Metrics;
use crate::files::Setup;
use rumbo_control::mode::waypoints::{Route, Waypoint};
use rumbo_sim::trace::{Trace, TruthSample};
use rumbo_wire::{Command, EventKind, FromRobot};
use std::f64::consts::TAU;

/// A place and a direction.
#[derive(Clone, Copy)]
struct Frame {
    x_m: f64,
    y_m: f64,
    heading_rad: f64,
}

impl Frame {
    const ORIGIN: Self = Self {
        x_m: 0.0,
        y_m: 0.0,
        heading_rad: 0.0,
    };

    /// Where the robot truly is.
    fn of(sample: &TruthSample) -> Self {
        Self {
            x_m: sample.x_m,
            y_m: sample.y_m,
            heading_rad: sample.heading_rad,
        }
    }

    /// A point seen from here, in the world.
    fn point(&self, x_m: f64, y_m: f64) -> [f64; 2] {
        let (sin, cos) = self.heading_rad.sin_cos();
        [
            self.x_m + cos * x_m - sin * y_m,
            self.y_m + sin * x_m + cos * y_m,
        ]
    }
}

/// The route that holds in the end, and since when.
struct Asked {
    from_s: f64,
    relative: bool,
    repeat: bool,
    waypoints: Vec<Waypoint>,
}

impl Asked {
    /// The last route of a scenario, from the time at which the robot is armed and has it.
    fn last(setup: &Setup) -> Option<Self> {
        let default = Route::default();
        let mut asked = Asked {
            from_s: 0.0,
            relative: default.relative,
            repeat: default.repeat,
            waypoints: default.waypoints().to_vec(),
        };
        let mut armed_s = None;
        for timed in &setup.scenario.commands {
            match timed.command {
                Command::Arm => {
                    armed_s.get_or_insert(timed.at_s);
                    continue;
                }
                Command::Route { repeat, relative } => {
                    asked.waypoints.clear();
                    (asked.repeat, asked.relative) = (repeat, relative);
                }
                Command::Waypoint(waypoint) => asked.waypoints.push(waypoint),
                Command::Goal { x_m, y_m } => {
                    asked.waypoints = vec![Waypoint {
                        x_m,
                        y_m,
                        heading_rad: None,
                    }];
                    (asked.repeat, asked.relative) = (false, false);
                }
                _ => continue,
            }
            asked.from_s = timed.at_s;
        }
        asked.from_s = asked.from_s.max(armed_s?);
        (!asked.waypoints.is_empty()).then_some(asked)
    }

    /// How far the robot strayed from the route by its own telemetry, frame by frame [m]; empty where another program
    /// drove it.
    fn strayed_by_odometry_m(&self, trace: &Trace) -> Vec<f64> {
        let poses: Vec<(f64, Frame)> = trace
            .messages
            .iter()
            .filter_map(|message| match message.what {
                FromRobot::Telemetry(telemetry) => Some((
                    message.t_s,
                    Frame {
                        x_m: f64::from(telemetry.pose.x_m),
                        y_m: f64::from(telemetry.pose.y_m),
                        heading_rad: f64::from(telemetry.pose.heading_rad),
                    },
                )),
                _ => None,
            })
            .collect();
        let (before, after) = poses.split_at(poses.partition_point(|(t_s, _)| *t_s <= self.from_s));
        let start = before.last().map_or(Frame::ORIGIN, |(_, pose)| *pose);
        let polyline = self.polyline(start, Frame::ORIGIN);
        let strayed_m = |(_, pose): &(f64, Frame)| distance_m(&polyline, [pose.x_m, pose.y_m]);
        after.iter().map(strayed_m).collect()
    }

    /// The polyline from `start`, its waypoints as seen from `origin`.
    fn polyline(&self, start: Frame, origin: Frame) -> Vec<[f64; 2]> {
        let origin = if self.relative { start } else { origin };
        let place =
            |waypoint: &Waypoint| origin.point(f64::from(waypoint.x_m), f64::from(waypoint.y_m));
        let mut points = vec![[start.x_m, start.y_m]];
        points.extend(self.waypoints.iter().map(place));
        if self.repeat {
            points.extend(self.waypoints.first().map(place));
        }
        points
    }
}

/// Distance of a point from a polyline [m].
fn distance_m(polyline: &[[f64; 2]], [x_m, y_m]: [f64; 2]) -> f64 {
    polyline
        .windows(2)
        .map(|ends| {
            let [from, to] = [ends[0], ends[1]];
            let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
            let square = (dx * dx + dy * dy).max(1e-12);
            let part = ((x_m - from[0]) * dx + (y_m - from[1]) * dy) / square;
            let part = part.clamp(0.0, 1.0);
            (x_m - from[0] - part * dx).hypot(y_m - from[1] - part * dy)
        })
        .fold(f64::INFINITY, f64::min)
}

/// Worst and root mean square.
fn worst_and_rms(distances_m: &[f64]) -> (f64, f64) {
    let square = distances_m.iter().map(|d| d * d).sum::<f64>() / distances_m.len() as f64;
    (
        distances_m.iter().copied().fold(0.0, f64::max),
        square.sqrt(),
    )
}

/// Metrics of the last route of a scenario.
pub(super) fn route(setup: &Setup, trace: &Trace, metrics: &mut Metrics) {
    let Some(asked) = Asked::last(setup) else {
        return;
    };
    let samples = trace.between(asked.from_s, f64::INFINITY);
    let Some(first) = samples.first() else {
        return;
    };
    let scenario = &setup.scenario.start;
    let origin = Frame {
        x_m: scenario.x_m,
        y_m: scenario.y_m,
        heading_rad: scenario.heading_rad,
    };
    let in_truth = asked.polyline(Frame::of(first), origin);
    let truly_m: Vec<f64> = samples
        .iter()
        .map(|sample| distance_m(&in_truth, [sample.x_m, sample.y_m]))
        .collect();
    let path_m: f64 = samples
        .windows(2)
        .map(|two| (two[1].x_m - two[0].x_m).hypot(two[1].y_m - two[0].y_m))
        .sum();
    for (name, distances_m) in [
        ("odometry", asked.strayed_by_odometry_m(trace)),
        ("true", truly_m),
    ] {
        if !distances_m.is_empty() {
            let (worst_m, rms_m) = worst_and_rms(&distances_m);
            metrics.insert(format!("{name}_worst_m"), worst_m);
            metrics.insert(format!("{name}_rms_m"), rms_m);
        }
    }
    metrics.insert("path_m".into(), path_m);
    if !asked.repeat {
        end(&asked, trace, samples, origin, &in_truth, metrics);
    }
}

/// Where and when a route that is driven once ended.
fn end(
    asked: &Asked,
    trace: &Trace,
    samples: &[TruthSample],
    origin: Frame,
    polyline: &[[f64; 2]],
    metrics: &mut Metrics,
) {
    let (Some(first), Some(last)) = (samples.first(), samples.last()) else {
        return;
    };
    let Some([x_m, y_m]) = polyline.last() else {
        return;
    };
    let mut put = |name: &str, value: f64| metrics.insert(name.into(), value);
    put("end_error_m", (last.x_m - x_m).hypot(last.y_m - y_m));
    let aim = asked.waypoints.last();
    if let Some(heading_rad) = aim.and_then(|waypoint| waypoint.heading_rad) {
        let from = if asked.relative {
            Frame::of(first)
        } else {
            origin
        };
        let error_rad = last.heading_rad - from.heading_rad - f64::from(heading_rad);
        let turns = (error_rad / TAU).round();
        put("end_turn_rad", (error_rad - turns * TAU).abs());
    }
    let reached_s = trace
        .messages
        .iter()
        .find_map(|message| match message.what {
            FromRobot::Event(event)
                if event.kind == EventKind::Reached && message.t_s > asked.from_s =>
            {
                Some(message.t_s)
            }
            _ => None,
        });
    let finish_s = reached_s.map_or(f64::NAN, |at_s| at_s - asked.from_s);
    put("finish_s", finish_s);
}
