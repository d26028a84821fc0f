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
