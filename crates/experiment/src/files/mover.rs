//! `[[mover]]` of a world file: a body that follows a path whatever happens, or a door that turns about its hinge.
//!
//! ```toml
//! [[mover]]
//! name = "person"              # may be missing
//! diameter_m = 0.3             # or size_m = [0.5, 0.3] with angle_deg: a box, which does not turn on its way
//! path_m = [[1.5, -1.2], [1.5, 1.2]]
//! speed_m_s = 0.4
//! repeat = "back_and_forth"    # or "loop"; "once" where it is left out
//! start_s = 2
//! pause_s = 1                  # at each point of the path
//! [[mover]]                    # a door, from its hinge along its own x
//! size_m = [0.8, 0.04]
//! hinge_m = [2.0, 1.0]
//! angles_deg = [0, 90]
//! speed_deg_s = 45
//! ```

use super::read::{Allowed, Table};
use super::value::{ANGLE, PLACE, SIDE, shown};
use rumbo_plant::contact::Pose;
use rumbo_plant::moving::{Body, Course, MoverRepeat, MoverRoute, TimedWaypoint};
use rumbo_plant::world::{Point, ShapeError};

/// Movers of a world; each costs every sonar and every step near it.
pub(crate) const MOST_MOVERS: usize = 32;
const MOST_POINTS: usize = 100;
const SPEED: Allowed = Allowed::new(0.01, 3.0, "m/s");
const TURN: Allowed = Allowed::new(1.0, 180.0, "deg/s");
const TIME: Allowed = Allowed::new(0.0, 3600.0, "s");
/// Corners of a round outline: 24 of them are within 0.4 % of the radius.
const ROUND: usize = 24;

/// A body that moves through a world.
#[derive(Clone, Debug, PartialEq)]
pub struct Mover {
    /// Its name; empty where it has none.
    pub name: String,
    /// Corners in its own frame, counter-clockwise, in m.
    pub corners_m: Vec<Point>,
    /// Where it goes.
    pub route: MoverRoute,
    /// It turns about a hinge, which may be in a wall.
    pub is_door: bool,
}

impl Mover {
    /// It in the plant's form.
    ///
    /// # Errors
    /// Corners that are none; those of a parsed file are some.
    pub fn body(&self) -> Result<Body, ShapeError> {
        Body::new(self.corners_m.clone(), Course::Route(self.route.clone()))
    }

    /// How errors name the `index`-th of a world.
    #[must_use]
    pub fn called(&self, index: usize) -> String {
        match self.name.as_str() {
            "" => format!("mover {}", index + 1),
            name => format!("mover {name:?}"),
        }
    }
}

/// Reads a mover; `None` where a problem was reported.
pub(crate) fn read_mover(table: &Table<'_, '_>) -> Option<Mover> {
    let name = table
        .text("name")
        .map_or_else(String::new, |name| name.value);
    let is_door = table.has("hinge_m");
    let corners_m = read_outline(table, is_door);
    let start_us = micros(table.number("start_s", TIME).unwrap_or(0.0));
    let pause_us = micros(table.number("pause_s", TIME).unwrap_or(0.0));
    let repeat = read_repeat(table, is_door);
    let legs = if is_door {
        read_hinge(table)
    } else {
        read_path(table, repeat == MoverRepeat::Loop)
    };
    table.finish();
    let route = MoverRoute::new(timed(&legs?, pause_us), repeat, start_us);
    match route {
        Ok(route) => Some(Mover {
            name,
            corners_m: corners_m?,
            route,
            is_door,
        }),
        Err(error) => {
            table.complain_here(&error.to_string());
            None
        }
    }
}

/// Poses, each with the time from the one before \[s\].
type Legs = Vec<(Pose, f64)>;

fn timed(legs: &Legs, pause_us: u64) -> Vec<TimedWaypoint> {
    let mut waypoints: Vec<TimedWaypoint> = Vec::new();
    let mut at_us = 0;
    for &(pose, way_s) in legs {
        // Two waypoints at one instant are none.
        at_us += if waypoints.is_empty() {
            0
        } else {
            micros(way_s).max(1)
        };
        waypoints.push(TimedWaypoint { at_us, pose });
        if pause_us > 0 {
            at_us += pause_us;
            waypoints.push(TimedWaypoint { at_us, pose });
        }
    }
    waypoints
}

fn micros(s: f64) -> u64 {
    (s * 1e6).round() as u64
}

fn read_outline(table: &Table<'_, '_>, is_door: bool) -> Option<Vec<Point>> {
    let size_m = table.pair("size_m", SIDE);
    let diameter_m = table.number("diameter_m", SIDE);
    let angle_deg = table.number("angle_deg", ANGLE);
    let has = |key| table.has(key);
    if has("size_m") == has("diameter_m") {
        table.complain_here("needs either size_m = [length, width] or diameter_m, in m");
        return None;
    }
    if has("angle_deg") && (is_door || has("diameter_m")) {
        table.complain_here("angle_deg is of a box that follows a path; leave it out");
        return None;
    }
    if is_door && has("diameter_m") {
        table.complain_here("what turns about a hinge needs size_m = [length, width]");
        return None;
    }
    if let Some(diameter_m) = diameter_m {
        let corner = |i| {
            let (s, c) = libm::sincos(std::f64::consts::TAU * i as f64 / ROUND as f64);
            [0.5 * diameter_m * c, 0.5 * diameter_m * s]
        };
        return Some((0..ROUND).map(corner).collect());
    }
    let [length_m, width_m] = size_m?;
    let ahead_m = if is_door { 0.5 * length_m } else { 0.0 };
    let angle_rad = angle_deg.unwrap_or(0.0).to_radians();
    let half_m = [0.5 * length_m, 0.5 * width_m];
    let corners = rumbo_plant::world::rectangle(half_m, [ahead_m, 0.0], [0.0, 0.0], angle_rad);
    Some(corners.to_vec())
}

fn read_repeat(table: &Table<'_, '_>, is_door: bool) -> MoverRepeat {
    let Some(repeat) = table.text("repeat") else {
        return MoverRepeat::Once;
    };
    match repeat.value.as_str() {
        "once" => MoverRepeat::Once,
        "loop" if !is_door => MoverRepeat::Loop,
        "back_and_forth" => MoverRepeat::BackAndForth,
        other => {
            let remedy = match is_door {
                true => "write \"once\" or \"back_and_forth\"",
                false => "write \"once\", \"loop\" or \"back_and_forth\"",
            };
            table.complain("repeat", repeat.line, &format!("{other:?}"), remedy);
            MoverRepeat::Once
        }
    }
}

fn read_path(table: &Table<'_, '_>, closed: bool) -> Option<Legs> {
    table.require("path_m", "a list of points [x, y] in m; a door has hinge_m");
    let speed_m_s = table.required_number("speed_m_s", SPEED);
    let (line, items) = table.items("path_m", "a list of points [x, y] in m")?;
    if !(2..=MOST_POINTS).contains(&items.len()) {
        let points = match items.len() {
            1 => "1 point".to_owned(),
            n => format!("{n} points"),
        };
        let remedy = format!("a path has 2 to {MOST_POINTS} points [x, y] in m");
        table.complain("path_m", line, &points, &remedy);
        return None;
    }
    let mut points = Vec::new();
    for (number, item) in items.iter().enumerate() {
        let key = format!("path_m[{}]", number + 1);
        let parts = item
            .value
            .as_array()
            .map(|parts| parts.iter().map(|part| part.get_ref()));
        let parts: Vec<_> = parts.into_iter().flatten().collect();
        let [x, y] = parts[..] else {
            table.complain(&key, item.line, &shown(item.value), "must be [x, y] in m");
            return None;
        };
        let judged = |value| table.judge_number(&key, item.line, value, PLACE);
        let point = [judged(x)?, judged(y)?];
        if points.last() == Some(&point) {
            let remedy = "is the point before; pause_s makes it wait there";
            table.complain(&key, item.line, &shown(item.value), remedy);
            return None;
        }
        points.push(point);
    }
    if closed && points.first() != points.last() {
        points.extend(points.first().copied());
    }
    let mut legs = Vec::new();
    let mut before = points.first().copied()?;
    for point in points {
        let way_m = libm::hypot(point[0] - before[0], point[1] - before[1]);
        let [x_m, y_m] = point;
        let pose = Pose {
            x_m,
            y_m,
            heading_rad: 0.0,
        };
        legs.push((pose, way_m / speed_m_s.max(SPEED.min)));
        before = point;
    }
    Some(legs)
}

fn read_hinge(table: &Table<'_, '_>) -> Option<Legs> {
    if table.value("path_m").is_some() {
        table.complain_here(
            "has both path_m and hinge_m: a body follows a path, or turns about a hinge",
        );
    }
    let [x_m, y_m] = table.pair("hinge_m", PLACE)?;
    let [from_deg, to_deg] = table.required_pair("angles_deg", ANGLE);
    let speed_deg_s = table.required_number("speed_deg_s", TURN);
    if from_deg == to_deg {
        table.complain_here("angles_deg are the same: a door needs two different ones");
        return None;
    }
    let pose = |deg: f64| Pose {
        x_m,
        y_m,
        heading_rad: deg.to_radians(),
    };
    let way_s = (to_deg - from_deg).abs() / speed_deg_s.max(TURN.min);
    Some(vec![(pose(from_deg), 0.0), (pose(to_deg), way_s)])
}
