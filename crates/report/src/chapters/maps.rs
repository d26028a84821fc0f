//! Maps that several chapters show: trajectories, walls and boxes, routes.

use crate::places::Places;
use crate::signals::ReportedRun;
use crate::text::{Language, Text, same, word};
use rumbo_plot::{Curve, Ink, Map, Points, Shape};
use rumbo_wire::Command;

const X_AXIS: Text = same("x (m)");
const Y_AXIS: Text = same("y (m)");
const IDEAL: Text = word("ideal");
const BY_ODOMETRY: Text = word("by-odometry");
const TRUE_TRAJECTORY: Text = word("true");
const STRAIGHT: Text = word("straight-line");
const START: Text = word("start");

/// A map with nothing on it.
pub(crate) fn map(language: Language) -> Map {
    Map {
        x: X_AXIS.of(language).to_owned(),
        y: Y_AXIS.of(language).to_owned(),
        ..Map::default()
    }
}

/// The ideal path, the trajectory by odometry, and the true one.
pub(super) fn trajectories(language: Language, outcome: &ReportedRun, ideal: Points) -> Vec<Curve> {
    let mut curves = vec![Curve::new(IDEAL.of(language), Ink::Reference, ideal)];
    let estimated = outcome.estimated_trajectory();
    if !estimated.is_empty() {
        curves.push(Curve::new(BY_ODOMETRY.of(language), Ink::First, estimated));
    }
    curves.push(Curve::new(
        TRUE_TRAJECTORY.of(language),
        Ink::True,
        outcome.true_trajectory(),
    ));
    curves
}

/// The walls and boxes of a run's world.
pub(crate) fn shapes(outcome: &ReportedRun) -> Vec<Shape> {
    let Ok(world) = outcome.setup.world.world() else {
        return Vec::new();
    };
    let shape = |obstacle: &rumbo_plant::world::Obstacle| {
        let corners: Points = obstacle.corners().map(|[x, y]| (x, y)).collect();
        Shape {
            filled: corners.len() > 2,
            corners,
        }
    };
    world.obstacles().iter().map(shape).collect()
}

/// The route of a run's commands in the world, from its start.
pub(super) fn route(outcome: &ReportedRun) -> Points {
    let start = outcome.setup.scenario.start;
    let (sin, cos) = start.heading_rad.sin_cos();
    let mut route = vec![(start.x_m, start.y_m)];
    for timed in &outcome.setup.scenario.commands {
        if let Command::Waypoint(waypoint) = timed.command {
            let (x, y) = (f64::from(waypoint.x_m), f64::from(waypoint.y_m));
            route.push((start.x_m + cos * x - sin * y, start.y_m + sin * x + cos * y));
        }
    }
    route
}

/// Distance of a point from a polyline.
pub(super) fn off_route(route: &Points, (x, y): (f64, f64)) -> f64 {
    let from_piece = |piece: &[(f64, f64)]| {
        let (a, b) = (piece[0], piece[1]);
        let (dx, dy) = (b.0 - a.0, b.1 - a.1);
        let along = ((x - a.0) * dx + (y - a.1) * dy) / (dx * dx + dy * dy).max(1e-12);
        let along = along.clamp(0.0, 1.0);
        (x - a.0 - along * dx).hypot(y - a.1 - along * dy)
    };
    route
        .windows(2)
        .map(from_piece)
        .fold(f64::INFINITY, f64::min)
}

/// Paths between boxes, and where the robot started.
pub(super) fn path_map(places: &Places, outcome: &ReportedRun, ideal: Points) -> Map {
    let language = places.language;
    let mut curves = trajectories(language, outcome, ideal);
    if curves[0].points.is_empty() {
        curves.remove(0);
    } else {
        curves[0].name = places.text(STRAIGHT).to_owned();
    }
    let start = outcome.setup.scenario.start;
    let arena = &outcome.setup.world.arena;
    Map {
        // A lane has an end, the robot's path has none.
        range: Some([
            [arena.from_m[0], arena.to_m[0]],
            [arena.from_m[1], arena.to_m[1]],
        ]),
        shapes: shapes(outcome),
        curves,
        marks: vec![(start.x_m, start.y_m, places.text(START).to_owned())],
        ..map(language)
    }
}
