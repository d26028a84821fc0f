//! Figures of logs: the signals of one, or those of several overlaid.

use rumbo_log::{Log, Row, SIGNALS, Signal};
use rumbo_plot::{Curve, Ink, Map, Panel, Plot, Points, Shape, Sheet, WIDTH, Words};
use std::f64::consts::TAU;

/// The modes whose reference is a distance.
const DISTANCE_MODES: [f64; 4] = [1.0, 2.0, 3.0, 4.0];

/// Panels that show signals over time.
const OVER_TIME: [(&str, &[&str]); 4] = [
    (
        "Distances",
        &["range_front_m", "range_left_m", "range_right_m"],
    ),
    ("Wheel speeds", &["left_rad_s", "right_rad_s"]),
    ("PWM", &["left_pwm", "right_pwm"]),
    ("Heading", &["heading_rad", "true_heading_rad"]),
];

/// One log: what it has of distances, speeds, PWM and heading over time, and the map; or the signals with these names, those
/// of one unit together.
pub(crate) fn of_one(log: &Log, chosen: &[String]) -> Sheet {
    let mut panels = Vec::new();
    if !chosen.is_empty() {
        let mut left: Vec<&Signal> = chosen.iter().filter_map(|name| signal(name)).collect();
        while let Some(unit) = left.first().map(|signal| signal.shown.0) {
            let (of_unit, others) = left.into_iter().partition(|each| each.shown.0 == unit);
            left = others;
            let of_unit: Vec<&Signal> = of_unit;
            let curves = of_unit.into_iter().zip(Ink::PALETTE.into_iter().cycle());
            let curves =
                curves.map(|(signal, ink)| Curve::new(signal.about, ink, over(log, signal)));
            let curves: Vec<Curve> = curves.filter(|curve| has_values(&curve.points)).collect();
            if !curves.is_empty() {
                panels.push(Panel::new(unit, curves));
            }
        }
        return sheet(panels, Vec::new(), Vec::new());
    }
    for (title, names) in OVER_TIME {
        let signals = || names.iter().filter_map(|name| signal(name));
        let curves = signals().zip(Ink::PALETTE);
        let mut curves: Vec<Curve> = curves
            .filter_map(|(signal, ink)| {
                let points = over(log, signal);
                let ink = match signal.name.starts_with("true_") {
                    true => Ink::True,
                    false => ink,
                };
                has_values(&points).then(|| Curve::new(signal.label, ink, points))
            })
            .collect();
        if curves.is_empty() {
            continue;
        }
        curves.extend(references(log, title));
        let unit = signals().next().map_or("", |signal| signal.shown.0);
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
    for signal in OVER_TIME
        .iter()
        .flat_map(|(_, names)| names.iter().filter_map(|name| signal(name)))
    {
        let curves: Vec<Curve> = coloured()
            .filter_map(|((name, log), ink)| {
                let points = over(log, signal);
                has_values(&points).then(|| Curve::new(name, ink, points))
            })
            .collect();
        if !curves.is_empty() {
            let label = format!("{}, {}", signal.about, signal.shown.0);
            panels.push(Panel::new(&label, curves));
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

/// A signal that is plotted.
pub(crate) fn signal(name: &str) -> Option<&'static Signal> {
    SIGNALS
        .iter()
        .find(|signal| signal.name == name && !signal.about.is_empty())
}

fn has_values(points: &Points) -> bool {
    points.iter().filter(|(_, y)| y.is_finite()).count() > 1
}

/// A signal over time as people read it, gaps where it is unknown or clear. Angles go on through a half turn.
fn over(log: &Log, signal: &Signal) -> Points {
    let (_, factor) = signal.shown;
    let mut before: Option<f64> = None;
    log.rows
        .iter()
        .map(|row| {
            let value = row.signal(signal.name);
            let mut value = value.filter(|value| value.is_finite());
            if signal.name.ends_with("heading_rad") {
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
    let given =
        |name, ink, points: Points| has_values(&points).then(|| Curve::new(name, ink, points));
    match title {
        "Distances" => {
            let points = log.rows.iter().map(|row| {
                let mode = row.signal("mode").unwrap_or(-1.0);
                let value = row
                    .signal("reference_left")
                    .filter(|value| *value != 0.0 && DISTANCE_MODES.contains(&mode));
                (
                    row.t_ms as f64 / 1e3,
                    value.map_or(f64::NAN, |value| value * 100.0),
                )
            });
            let points: Points = points.filter(|(_, value)| value.is_finite()).collect();
            given("reference", Ink::Reference, points)
                .into_iter()
                .collect()
        }
        "Wheel speeds" => ["left_ref_rad_s", "right_ref_rad_s"]
            .iter()
            .filter_map(|name| signal(name))
            .zip([Ink::FirstReference, Ink::SecondReference])
            .filter_map(|(signal, ink)| given(signal.label, ink, over(log, signal)))
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
