//! Figures of logs: the signals of one, or those of several overlaid.

use rumbo_log::{Log, Row};
use rumbo_plot::{Curve, Ink, Map, Panel, Plot, Points, Shape, Sheet, WIDTH, Words};
use std::f64::consts::{PI, TAU};

const RPM_PER_RAD_S: f64 = 30.0 / PI;
const CM_PER_M: f64 = 100.0;
const DEG_PER_RAD: f64 = 180.0 / PI;
/// The modes whose reference is a distance.
const DISTANCE_MODES: [f64; 4] = [1.0, 2.0, 3.0, 4.0];

/// A signal of a figure: its column, its name for people, and what it is multiplied with.
type Signal = (&'static str, &'static str, f64);

/// Panels that show signals over time: title, unit, signals.
const OVER_TIME: [(&str, &str, &[Signal]); 4] = [
    (
        "Distances",
        "cm",
        &[
            ("range_front_m", "front", CM_PER_M),
            ("range_left_m", "left", CM_PER_M),
            ("range_right_m", "right", CM_PER_M),
        ],
    ),
    (
        "Wheel speeds",
        "rpm",
        &[
            ("left_rad_s", "left", RPM_PER_RAD_S),
            ("right_rad_s", "right", RPM_PER_RAD_S),
        ],
    ),
    (
        "PWM",
        "of 255",
        &[("left_pwm", "left", 1.0), ("right_pwm", "right", 1.0)],
    ),
    (
        "Heading",
        "degrees",
        &[
            ("heading_rad", "estimated", DEG_PER_RAD),
            ("true_heading_rad", "true", DEG_PER_RAD),
        ],
    ),
];

/// One log: what it has of distances, speeds, PWM and heading over time, and the map.
pub(crate) fn of_one(log: &Log) -> Sheet {
    let mut panels = Vec::new();
    for (title, unit, signals) in OVER_TIME {
        let curves = signals.iter().zip(Ink::PALETTE);
        let mut curves: Vec<Curve> = curves
            .filter_map(|((column, name, factor), ink)| {
                let points = over(log, column, *factor);
                let ink = if *name == "true" { Ink::True } else { ink };
                has_values(&points).then(|| Curve::new(name, ink, points))
            })
            .collect();
        if curves.is_empty() {
            continue;
        }
        curves.extend(references(log, title));
        panels.push(Panel::new(&format!("{title}, {unit}"), curves));
    }
    let ways = [
        ("estimated", Ink::First, estimated_trajectory(log)),
        ("true", Ink::True, way(log, ["true_x_m", "true_y_m"])),
    ];
    let ways = ways.map(|(name, ink, points)| Curve::new(name, ink, points));
    sheet(panels, shapes(log), ways.into())
}

/// The same signals with all logs overlaid, each in its colour.
pub(crate) fn of_many(logs: &[(&str, &Log)]) -> Sheet {
    let coloured = || logs.iter().zip(Ink::PALETTE.into_iter().cycle());
    let mut panels = Vec::new();
    for (_, unit, signals) in OVER_TIME {
        for (column, _, factor) in signals {
            let curves: Vec<Curve> = coloured()
                .filter_map(|((name, log), ink)| {
                    let points = over(log, column, *factor);
                    has_values(&points).then(|| Curve::new(name, ink, points))
                })
                .collect();
            if !curves.is_empty() {
                let label = format!("{}, {unit}", title_of(column));
                panels.push(Panel::new(&label, curves));
            }
        }
    }
    let ways = coloured().map(|((name, log), ink)| {
        let truth = way(log, ["true_x_m", "true_y_m"]);
        let points = match truth.len() > 1 {
            true => truth,
            false => estimated_trajectory(log),
        };
        Curve::new(name, ink, points)
    });
    let shapes = logs.first().map_or_else(Vec::new, |(_, log)| shapes(log));
    sheet(panels, shapes, ways.collect())
}

/// The panels and, where a path is known, the map. A robot that reports distances only has none.
fn sheet(panels: Vec<Panel>, shapes: Vec<Shape>, mut ways: Vec<Curve>) -> Sheet {
    let (words, mut sheet) = (Words::default(), Sheet::new(1));
    if !panels.is_empty() {
        sheet = sheet.with("", Plot::over_time(panels).picture(words, WIDTH));
    }
    ways.retain(|way| way.points.len() > 1);
    match ways.is_empty() {
        true => sheet,
        false => sheet.with("Trajectory", Map::of(shapes, ways).picture(words, WIDTH)),
    }
}

fn title_of(column: &str) -> &'static str {
    match column {
        "range_front_m" => "Distance ahead",
        "range_left_m" => "Distance on the left",
        "range_right_m" => "Distance on the right",
        "left_rad_s" => "Speed of the left wheel",
        "right_rad_s" => "Speed of the right wheel",
        "left_pwm" => "PWM of the left wheel",
        "right_pwm" => "PWM of the right wheel",
        "heading_rad" => "Heading, estimated",
        _ => "Heading, true",
    }
}

fn has_values(points: &Points) -> bool {
    points.iter().filter(|(_, y)| y.is_finite()).count() > 1
}

/// A signal over time, gaps where it is unknown or clear. Angles go on through a half turn.
fn over(log: &Log, column: &str, factor: f64) -> Points {
    let Some(at) = Row::column(column) else {
        return Vec::new();
    };
    let mut before: Option<f64> = None;
    log.rows
        .iter()
        .map(|row| {
            let mut value = row.get(at).filter(|value| value.is_finite());
            if column.ends_with("heading_rad") {
                value = value.map(|angle| {
                    before.map_or(angle, |before| {
                        angle + TAU * ((before - angle) / TAU).round()
                    })
                });
                before = value.or(before);
            }
            (
                row.t_ms as f64 / 1e3,
                value.map_or(f64::NAN, |value| value * factor),
            )
        })
        .collect()
}

/// The references that belong to this panel.
fn references(log: &Log, title: &str) -> Vec<Curve> {
    let given = |name, points: Points| {
        has_values(&points).then(|| Curve::new(name, Ink::Reference, points))
    };
    match title {
        "Distances" => {
            let points = log.rows.iter().map(|row| {
                let mode = row.signal("mode").unwrap_or(-1.0);
                let value = row
                    .signal("reference_left")
                    .filter(|value| *value != 0.0 && DISTANCE_MODES.contains(&mode));
                (
                    row.t_ms as f64 / 1e3,
                    value.map_or(f64::NAN, |value| value * CM_PER_M),
                )
            });
            let points: Points = points.filter(|(_, value)| value.is_finite()).collect();
            given("reference", points).into_iter().collect()
        }
        "Wheel speeds" => [
            ("left_ref_rad_s", "left reference"),
            ("right_ref_rad_s", "right reference"),
        ]
        .into_iter()
        .filter_map(|(column, name)| given(name, over(log, column, RPM_PER_RAD_S)))
        .collect(),
        _ => Vec::new(),
    }
}

/// Walls and boxes.
fn shapes(log: &Log) -> Vec<Shape> {
    let obstacles = log
        .scene()
        .map(|scene| scene.obstacles.as_slice())
        .unwrap_or_default();
    let corners = |corners_m: &[[f64; 2]]| -> Points {
        corners_m.iter().map(|[x_m, y_m]| (*x_m, *y_m)).collect()
    };
    obstacles
        .iter()
        .map(|obstacle| Shape {
            corners: corners(&obstacle.corners_m),
            filled: obstacle.closed,
        })
        .collect()
}

fn way(log: &Log, columns: [&str; 2]) -> Points {
    let point = |row: &Row| Some((row.signal(columns[0])?, row.signal(columns[1])?));
    log.rows.iter().filter_map(point).collect()
}

/// The estimated trajectory in the world.
fn estimated_trajectory(log: &Log) -> Points {
    let point = |row: &Row| {
        let (x_m, y_m) = (row.signal("x_m")?, row.signal("y_m")?);
        let place = ["origin_x_m", "origin_y_m", "origin_heading_rad"]
            .map(|name| row.signal(name).unwrap_or(0.0));
        let (sin, cos) = place[2].sin_cos();
        Some((
            place[0] + cos * x_m - sin * y_m,
            place[1] + sin * x_m + cos * y_m,
        ))
    };
    log.rows.iter().filter_map(point).collect()
}
