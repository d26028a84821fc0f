//! Geometry and principles: the sonar's timing, the encoder's disc, angles to a wall, frames, points ahead.

use super::sketch::{Anchor, Sketch};
use crate::text::{Language, Text, t};
use std::f64::consts::TAU;

const ECHO_WIDTH: Text = t("Δt: out and back", "Δt: ida y vuelta");
const NEXT: Text = t(
    "at least 60 ms to the next ping",
    "al menos 60 ms hasta el siguiente disparo",
);
const BURST: Text = t("40 kHz burst", "ráfaga de 40 kHz");

/// The HC-SR04's lines over time.
pub(crate) fn sonar_timing(language: Language, description: &str) -> String {
    let mut sketch = Sketch::new();
    for (index, name) in ["TRIG", "40 kHz", "ECHO"].into_iter().enumerate() {
        sketch.text((8.0, 52.0 + 62.0 * index as f64), name, Anchor::Start);
    }
    let level = |row: f64, high: bool| 56.0 + 62.0 * row - if high { 26.0 } else { 0.0 };
    let pulse = |row: f64, from: f64, to: f64| {
        [
            (70.0, level(row, false)),
            (from, level(row, false)),
            (from, level(row, true)),
            (to, level(row, true)),
            (to, level(row, false)),
            (660.0, level(row, false)),
        ]
    };
    sketch.line(&pulse(0.0, 90.0, 112.0), "i1");
    sketch.text((101.0, 22.0), "10 µs", Anchor::Middle);
    let mut burst = vec![(70.0, level(1.0, false)), (120.0, level(1.0, false))];
    for cycle in 0..8 {
        let x = 120.0 + 7.0 * f64::from(cycle);
        burst.extend([
            (x, level(1.0, true)),
            (x + 3.5, level(1.0, true)),
            (x + 3.5, level(1.0, false)),
            (x + 7.0, level(1.0, false)),
        ]);
    }
    burst.push((660.0, level(1.0, false)));
    sketch.line(&burst, "i1");
    sketch.text(
        (190.0, level(1.0, true) + 10.0),
        BURST.of(language),
        Anchor::Start,
    );
    sketch.line(&pulse(2.0, 180.0, 420.0), "i2");
    sketch.measure(
        (180.0, level(2.0, true) - 8.0),
        (420.0, level(2.0, true) - 8.0),
        ECHO_WIDTH.of(language),
        (0.0, -5.0),
    );
    sketch.measure(
        (90.0, 206.0),
        (650.0, 206.0),
        NEXT.of(language),
        (0.0, 17.0),
    );
    sketch.finish(680.0, 232.0, description)
}

const DISC: Text = t(
    "disc of 8 poles on the motor's shaft",
    "disco de 8 polos en el eje del motor",
);
const HALL: Text = t("Hall sensor", "sensor Hall");
const LINE: Text = t(
    "signal: 8 edges per turn of the motor",
    "señal: 8 flancos por vuelta del motor",
);
const GEAR: Text = t(
    "48 turns of the motor = 1 turn of the wheel = 384 edges",
    "48 vueltas del motor = 1 vuelta de la rueda = 384 flancos",
);

/// The Hall encoder.
pub(crate) fn encoder(language: Language, description: &str) -> String {
    let mut sketch = Sketch::new();
    let (centre, radius) = ((110.0, 110.0), 70.0);
    for pole in 0..8 {
        let angle = |share: f64| TAU * (f64::from(pole) + share) / 8.0;
        let mut corners = vec![centre];
        corners.extend(
            (0..=6)
                .map(|step| angle(f64::from(step) / 6.0))
                .map(|angle| {
                    (
                        centre.0 + radius * angle.cos(),
                        centre.1 - radius * angle.sin(),
                    )
                }),
        );
        sketch.polygon(&corners, if pole % 2 == 0 { "o" } else { "b" });
        let middle = angle(0.5);
        let letter = if pole % 2 == 0 { "N" } else { "S" };
        sketch.text(
            (
                centre.0 + 0.72 * radius * middle.cos(),
                centre.1 - 0.72 * radius * middle.sin() + 4.0,
            ),
            letter,
            Anchor::Middle,
        );
    }
    sketch.circle(centre, 10.0, "b");
    sketch.rectangle((186.0, 98.0), (16.0, 24.0), "o");
    sketch.text((208.0, 114.0), HALL.of(language), Anchor::Start);
    sketch.text((20.0, 204.0), DISC.of(language), Anchor::Start);
    let mut edges = vec![(320.0, 120.0)];
    for edge in 0..8 {
        let x = 340.0 + 38.0 * f64::from(edge);
        let [before, after] = if edge % 2 == 0 {
            [120.0, 80.0]
        } else {
            [80.0, 120.0]
        };
        edges.extend([(x, before), (x, after)]);
    }
    edges.push((660.0, 120.0));
    sketch.line(&edges, "i1");
    sketch.text((320.0, 64.0), LINE.of(language), Anchor::Start);
    sketch.measure((340.0, 140.0), (644.0, 140.0), "2π / 48", (0.0, 18.0));
    sketch.text((320.0, 186.0), GEAR.of(language), Anchor::Start);
    sketch.finish(700.0, 216.0, description)
}

/// Where the wall of a pair of sonars is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Wall {
    /// Ahead of the robot: to the right of the drawing.
    Ahead,
    /// Beside it: above.
    Beside,
}

const WALL: Text = t("wall", "pared");
const AHEAD: Text = t("direction of travel", "sentido de avance");

/// Two sonars askew to a wall: what they read, the angle and the distance.
pub(crate) fn pair(language: Language, wall: Wall, description: &str) -> String {
    let mut sketch = Sketch::new();
    let (tilt, half, reach) = (0.32_f64, 62.0, 270.0);
    let (width, height) = if wall == Wall::Ahead {
        (620.0, 330.0)
    } else {
        (620.0, 430.0)
    };
    // u towards the wall, v towards the first sonar.
    let place = |u: f64, v: f64| match wall {
        Wall::Ahead => (150.0 + u, 195.0 - v),
        Wall::Beside => (290.0 + v, 310.0 - u),
    };
    let at = |u: f64, v: f64| {
        place(
            u * tilt.cos() - v * tilt.sin(),
            u * tilt.sin() + v * tilt.cos(),
        )
    };
    sketch.line(&[place(reach, -110.0), place(reach, 180.0)], "w");
    sketch.polygon(
        &[
            at(-90.0, half),
            at(0.0, half),
            at(0.0, -half),
            at(-90.0, -half),
        ],
        "b",
    );
    sketch.line(&[place(0.0, 0.0), place(reach, 0.0)], "d");
    // Names stand off their lines.
    let [first, second, gap] = match wall {
        Wall::Ahead => [(-6.0, -8.0), (4.0, 17.0), (-13.0, 4.0)],
        Wall::Beside => [(-16.0, 4.0), (-16.0, 4.0), (-8.0, 18.0)],
    };
    for (v, name, beside) in [(half, "d₁", first), (-half, "d₂", second)] {
        // Where the ray from this sonar meets the wall.
        let length = (reach + v * tilt.sin()) / tilt.cos();
        sketch.circle(at(0.0, v), 5.0, "o");
        sketch.measure(at(0.0, v), at(length, v), name, beside);
    }
    sketch.measure(at(-34.0, half), at(-34.0, -half), "δ", gap);
    // Parallel to the wall through the first sonar: the side of the triangle.
    sketch.line(&[at(reach / tilt.cos(), 0.0), at(0.0, 0.0)], "d");
    let angles = match wall {
        Wall::Ahead => (0.0, tilt),
        Wall::Beside => (TAU / 4.0 - tilt, TAU / 4.0),
    };
    sketch.arc(place(0.0, 0.0), 110.0, angles.0, angles.1, "l");
    let mark = place(132.0 * (0.5 * tilt).cos(), 132.0 * (0.5 * tilt).sin());
    sketch.text((mark.0, mark.1 + 4.0), "θ", Anchor::Middle);
    let (x, y) = place(reach - 26.0, -6.0);
    let anchor = match wall {
        Wall::Ahead => Anchor::Start,
        Wall::Beside => Anchor::End,
    };
    sketch.text((x, y + 10.0), "d", anchor);
    match wall {
        Wall::Ahead => sketch.text(
            (place(reach, 0.0).0 + 10.0, 40.0),
            WALL.of(language),
            Anchor::Start,
        ),
        Wall::Beside => {
            sketch.text(
                (place(reach, 188.0).0, place(reach, 0.0).1 + 4.0),
                WALL.of(language),
                Anchor::Start,
            );
            let (from, to) = (at(-45.0, half + 8.0), at(-45.0, half + 62.0));
            sketch.arrow(&[from, to]);
            sketch.text((to.0 + 5.0, to.1 + 4.0), AHEAD.of(language), Anchor::Start);
        }
    }
    sketch.finish(width, height, description)
}

const GOAL: Text = t("goal", "objetivo");

/// The robot in the global frame, its own frame, and the goal's bearing.
pub(crate) fn frames(language: Language, description: &str) -> String {
    let mut sketch = Sketch::new();
    let origin = (60.0, 260.0);
    sketch.arrow(&[origin, (590.0, 260.0)]);
    sketch.arrow(&[origin, (60.0, 24.0)]);
    sketch.text((596.0, 264.0), "X", Anchor::Start);
    sketch.text((60.0, 16.0), "Y", Anchor::Middle);
    let (robot, goal, heading) = ((230.0, 180.0), (500.0, 60.0), 0.2_f64);
    for (from, to) in [
        (robot, (robot.0, 260.0)),
        (robot, (60.0, robot.1)),
        (goal, (goal.0, 260.0)),
        (goal, (60.0, goal.1)),
    ] {
        sketch.line(&[from, to], "d");
    }
    for ((x, y), name, anchor) in [
        ((robot.0, 276.0), "x", Anchor::Middle),
        ((52.0, robot.1 + 4.0), "y", Anchor::End),
        ((goal.0, 276.0), "x*", Anchor::Middle),
        ((52.0, goal.1 + 4.0), "y*", Anchor::End),
    ] {
        sketch.text((x, y), name, anchor);
    }
    let body = |u: f64, v: f64| {
        (
            robot.0 + u * heading.cos() - v * heading.sin(),
            robot.1 - u * heading.sin() - v * heading.cos(),
        )
    };
    sketch.polygon(
        &[
            body(-20.0, 24.0),
            body(42.0, 24.0),
            body(42.0, -24.0),
            body(-20.0, -24.0),
        ],
        "b",
    );
    for side in [24.0, -24.0] {
        sketch.polygon(
            &[
                body(-11.0, side + 4.0),
                body(11.0, side + 4.0),
                body(11.0, side - 4.0),
                body(-11.0, side - 4.0),
            ],
            "o",
        );
    }
    sketch.arrow(&[body(0.0, 0.0), body(115.0, 0.0)]);
    sketch.arrow(&[body(0.0, 0.0), body(0.0, 66.0)]);
    sketch.text(
        (body(120.0, 0.0).0, body(120.0, 0.0).1 + 12.0),
        "x'",
        Anchor::Start,
    );
    sketch.text(
        (body(0.0, 72.0).0 - 6.0, body(0.0, 72.0).1),
        "y'",
        Anchor::End,
    );
    sketch.line(&[robot, goal], "ir");
    sketch.circle(goal, 5.0, "k");
    sketch.text(
        (goal.0 + 9.0, goal.1 - 6.0),
        GOAL.of(language),
        Anchor::Start,
    );
    let bearing = (robot.1 - goal.1).atan2(goal.0 - robot.0);
    sketch.line(&[robot, (robot.0 + 190.0, robot.1)], "d");
    sketch.arc(robot, 92.0, 0.0, heading, "l");
    sketch.text((robot.0 + 98.0, robot.1 - 5.0), "φ", Anchor::Start);
    sketch.arc(robot, 160.0, 0.0, bearing, "l");
    sketch.text((robot.0 + 164.0, robot.1 - 30.0), "φ*", Anchor::Start);
    sketch.finish(640.0, 286.0, description)
}

const NEAREST: Text = t("place on the path", "posición sobre el camino");
const LOOKAHEAD: Text = t("lookahead", "punto de mira");

/// Pure pursuit: the point ahead on the path, and the circle to it.
pub(crate) fn lookahead(language: Language, description: &str) -> String {
    let mut sketch = Sketch::new();
    let y = 70.0;
    sketch.line(&[(40.0, y), (620.0, y)], "ir");
    for index in 0..9 {
        sketch.circle((60.0 + 68.0 * f64::from(index), y), 2.5, "k");
    }
    let (robot, point) = ((170.0, 190.0), (400.0, y));
    let body = |u: f64, v: f64| (robot.0 + u, robot.1 - v);
    sketch.polygon(
        &[
            body(-18.0, 20.0),
            body(34.0, 20.0),
            body(34.0, -20.0),
            body(-18.0, -20.0),
        ],
        "b",
    );
    sketch.arrow(&[robot, body(96.0, 0.0)]);
    sketch.line(&[robot, (robot.0, y)], "d");
    sketch.circle((robot.0, y), 4.0, "k");
    sketch.text((robot.0, y - 12.0), NEAREST.of(language), Anchor::Middle);
    sketch.circle(point, 5.0, "k");
    sketch.text((point.0, y - 12.0), LOOKAHEAD.of(language), Anchor::Middle);
    sketch.measure((robot.0, y + 16.0), (point.0, y + 16.0), "L", (0.0, 15.0));
    // The circle that is tangent to the heading and goes through the point.
    let (dx, dy) = (point.0 - robot.0, robot.1 - point.1);
    let radius = (dx * dx + dy * dy) / (2.0 * dy);
    let centre = (robot.0, robot.1 - radius);
    let end = (dx / radius).asin();
    sketch.arc(centre, radius, -TAU / 4.0, -TAU / 4.0 + end, "i1");
    sketch.line(&[(robot.0 + dx, robot.1), point], "d");
    sketch.line(&[robot, (robot.0 + dx, robot.1)], "d");
    sketch.text((robot.0 + dx + 6.0, robot.1 - 50.0), "y", Anchor::Start);
    sketch.text((robot.0 + 0.72 * dx, robot.1 + 16.0), "x", Anchor::Middle);
    sketch.finish(660.0, 230.0, description)
}

const BOX: Text = t("box", "caja");
const SWEEP: Text = t("1. sweep to both edges", "1. barrido hasta ambas esquinas");
const AROUND: Text = t("2. around the nearer one", "2. rodeo por la más próxima");
const REJOIN: Text = t("3. on to the goal", "3. hacia el objetivo");

/// How the robot goes around a box: look to both sides, pass the edge, go on to the goal.
pub(crate) fn around_box(language: Language, description: &str) -> String {
    let mut sketch = Sketch::new();
    for (column, title) in [SWEEP, AROUND, REJOIN].into_iter().enumerate() {
        let x = 8.0 + 232.0 * column as f64;
        sketch.text((x + 104.0, 18.0), title.of(language), Anchor::Middle);
        sketch.rectangle((x + 96.0, 66.0), (40.0, 104.0), "o");
        sketch.text((x + 116.0, 124.0), BOX.of(language), Anchor::Middle);
        sketch.line(&[(x + 12.0, 104.0), (x + 204.0, 104.0)], "ir");
        sketch.circle((x + 204.0, 104.0), 4.0, "k");
        let robot = |sketch: &mut Sketch, (cx, cy): (f64, f64)| {
            sketch.rectangle((cx - 14.0, cy - 9.0), (28.0, 18.0), "b");
            sketch.line(&[(cx + 14.0, cy - 5.0), (cx + 14.0, cy + 5.0)], "l");
        };
        match column {
            0 => {
                for edge in [66.0, 170.0] {
                    sketch.line(&[(x + 54.0, 104.0), (x + 96.0, edge)], "i2");
                }
                sketch.arc((x + 54.0, 104.0), 30.0, 0.0, 0.74, "l");
                sketch.arc((x + 54.0, 104.0), 24.0, 0.0, -1.0, "l");
                robot(&mut sketch, (x + 40.0, 104.0));
            }
            1 => {
                sketch.arrow(&[(x + 40.0, 104.0), (x + 58.0, 46.0), (x + 124.0, 40.0)]);
                robot(&mut sketch, (x + 124.0, 40.0));
            }
            _ => {
                sketch.arrow(&[
                    (x + 40.0, 104.0),
                    (x + 58.0, 46.0),
                    (x + 152.0, 40.0),
                    (x + 200.0, 98.0),
                ]);
                robot(&mut sketch, (x + 156.0, 46.0));
            }
        }
    }
    sketch.finish(700.0, 190.0, description)
}
