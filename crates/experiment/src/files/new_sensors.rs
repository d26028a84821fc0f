//! The sensors of a robot file to start from: sonars at the place that their names say; what looks down or for obstacles in
//! a row from left to right, as it was given; or where somebody says that they are.

use super::sonars::{self, is_of_sonar};
use rumbo_sim::wiring::SONARS;
use std::fmt::Write;

/// How the names of sensors begin among the pins, before a name of its own, and their table in a wiring: a Sharp gives a
/// voltage.
pub const NAMED: [(&str, &str); 5] = [
    ("line_", "line"),
    ("obstacle_", "obstacle"),
    ("sharp_", "obstacle"),
    ("light_", "light"),
    ("maxsonar_", "maxsonar"),
];

/// Sensors of a kind, which stand in a row from left to right.
struct InRow {
    /// Their table in a wiring.
    table: &'static str,
    /// Its comment.
    about: &'static str,
    /// What may be said of all of them in place of one, and the key that says it: `line_dark=low`.
    of_all: &'static [(&'static str, &'static str)],
    /// So far ahead \[m\].
    ahead_m: f64,
    /// From one to the next of so many \[m\].
    apart_m: fn(usize) -> f64,
    /// They look so far apart \[deg\].
    apart_deg: f64,
}

/// Two stand beside the tape, one on each side.
const LINES: InRow = InRow {
    table: "line",
    about: "Sensors that look down, from left to right: measure where they are. Over a dark floor they are high, unless\n\
            # dark = \"low\".",
    of_all: &[
        ("line_dark", "dark"),
        ("line_rc", "rc"),
        ("line_light_v", "light_v"),
        ("line_dark_v", "dark_v"),
    ],
    ahead_m: 0.09,
    apart_m: |count| if count == 2 { 0.04 } else { 0.015 },
    apart_deg: 0.0,
};

const OBSTACLES: InRow = InRow {
    table: "obstacle",
    about: "Infrared sensors for obstacles, from left to right: measure where they are and look. One is low where something \
            is\n# nearer than reach_m = 0.15, unless seen = \"high\"; an analogue one is a Sharp GP2Y0A21YK, or\n# model = \"gp2y0a02\" or \"gp2y0a41\".",
    of_all: &[
        ("obstacle_seen", "seen"),
        ("obstacle_reach_m", "reach_m"),
        ("sharp_model", "model"),
    ],
    ahead_m: 0.11,
    apart_m: |_| 0.05,
    apart_deg: 30.0,
};

const LIGHTS: InRow = InRow {
    table: "light",
    about: "Light sensors, from left to right: measure where they are and look. An analogue one is a photoresistor at 5 V \
            with\n# 10 kOhm to GND, higher where it is bright, unless bright = \"low\"; another one is low above switch_lux = 50.",
    of_all: &[
        ("light_bright", "bright"),
        ("light_resistor_kohm", "resistor_kohm"),
        ("light_rated_kohm", "rated_kohm"),
        ("light_switch_lux", "switch_lux"),
    ],
    ahead_m: 0.08,
    apart_m: |_| 0.08,
    apart_deg: 60.0,
};

const MAXSONARS: InRow = InRow {
    table: "maxsonar",
    about: "Range finders that measure by themselves, from left to right: measure where they are and look. One gives a pulse \
            (PW),\n# an analogue one a voltage (AN).",
    of_all: &[("maxsonar_rx", "rx")],
    ahead_m: 0.11,
    apart_m: |_| 0.06,
    apart_deg: 45.0,
};

/// Signals and their pins, or what is said of all sensors of a kind.
type Pins = [(String, String)];
/// Where sensors are by their signals: x and y \[m\], and the direction \[deg\].
type Places = [(String, [f64; 3])];

/// Where a sensor is, if that was said.
pub(super) fn place_of(places: &Places, signal: &str) -> Option<[f64; 3]> {
    let own = places.iter().find(|(name, _)| name == signal);
    own.map(|(_, place)| *place)
}

/// The sonars among pins: front, left and right, then those of other names as they were given.
pub(super) fn sonars(pins: &Pins) -> Vec<&str> {
    let names = pins.iter().filter(|(signal, _)| is_of_sonar(signal));
    let mut names: Vec<&str> = names
        .filter_map(|(signal, _)| signal.strip_suffix("_trigger"))
        .collect();
    let usual = ["front", "left", "right"];
    names.sort_by_key(|name| {
        usual
            .iter()
            .position(|own| own == name)
            .unwrap_or(usual.len())
    });
    names
}

/// The signals of a wiring with these pins, in the order in which a file has them.
pub(super) fn signals(pins: &Pins) -> Vec<String> {
    let names = sonars(pins).into_iter().map(str::to_owned);
    let others: Vec<String> = names
        .filter(|name| !SONARS.contains(&name.as_str()))
        .collect();
    sonars::signals(&others).collect()
}

/// Where a sonar usually sits and looks, by its name, `rear` or `front_left`: x and y \[m\], and the direction \[deg\].
pub(super) fn usual_place(sonar: &str) -> Option<[f64; 3]> {
    let says = |words: &[&str]| sonar.split('_').any(|own| words.contains(&own));
    let side = f64::from(i8::from(says(&["left"])) - i8::from(says(&["right"])));
    let (ahead, behind) = (
        says(&["front", "middle", "center", "centre"]),
        says(&["rear", "back"]),
    );
    match (ahead, behind, side != 0.0) {
        (true, false, false) => Some([0.11, 0.0, 0.0]),
        (true, false, true) => Some([0.1, 0.05 * side, 45.0 * side]),
        (false, false, true) => Some([0.05, 0.07 * side, 90.0 * side]),
        (false, true, true) => Some([-0.06, 0.06 * side, 135.0 * side]),
        (false, true, false) => Some([-0.08, 0.0, 180.0]),
        _ => None,
    }
}

/// The tables of the sensors that stand in rows, each empty without any.
pub(super) fn rows(wiring: &str, pins: &Pins, places: &Places) -> String {
    let said_of_all = |key: &str| pins.iter().any(|(signal, _)| signal == key);
    let rc = said_of_all("line_rc");
    // What else one says of itself, and which keys that are said of all it has.
    let is_analogue = |pin: &str| pin.parse::<u8>().is_err();
    let line = |_: &str, pin: &str| match is_analogue(pin) && !rc {
        true => (ANALOGUE, &[][..]),
        false => ("", &["light_v", "dark_v"][..]),
    };
    let obstacle = |signal: &str, _: &str| match signal.starts_with("sharp_") {
        true => (ANALOGUE, &["seen", "reach_m"][..]),
        false => ("", &["model"][..]),
    };
    let modules = said_of_all("light_switch_lux");
    let light = |_: &str, pin: &str| match is_analogue(pin) && !modules {
        true => (ANALOGUE, &[][..]),
        false => ("", &["resistor_kohm"][..]),
    };
    let range = |_: &str, pin: &str| match is_analogue(pin) {
        true => (ANALOGUE, &[][..]),
        false => ("", &[][..]),
    };
    [
        LINES.text(wiring, pins, places, line),
        OBSTACLES.text(wiring, pins, places, obstacle),
        LIGHTS.text(wiring, pins, places, light),
        MAXSONARS.text(wiring, pins, places, range),
    ]
    .concat()
}

const ANALOGUE: &str = ", analogue = true";

impl InRow {
    /// Their table, empty without any; `more` is what one says of itself, and which keys of all it has not.
    fn text<'k>(
        &self,
        wiring: &str,
        pins: &Pins,
        places: &Places,
        more: impl Fn(&str, &str) -> (&'k str, &'k [&'k str]),
    ) -> String {
        let sensors = self.sensors(pins);
        let row = in_row(&sensors, places);
        let mut text = String::new();
        if !sensors.is_empty() {
            let Self { about, table, .. } = self;
            let _ = write!(text, "\n# {about}\n[wiring.{wiring}.{table}]\n");
        }
        for (signal, name, pin) in sensors {
            let aside = aside(signal, &row);
            let usual = [
                self.ahead_m,
                (self.apart_m)(row.len()) * aside,
                self.apart_deg * aside,
            ];
            let [x_m, y_m, angle_deg] = place_of(places, signal).unwrap_or(usual);
            let looks = match self.apart_deg {
                0.0 => String::new(),
                _ => format!(", angle_deg = {angle_deg}"),
            };
            let (more, lacks) = more(signal, pin);
            let said = said(pins, self.of_all, |key| !lacks.contains(&key));
            let pin = quoted(pin);
            let _ = writeln!(
                text,
                "{name} = {{ pin = {pin}, x_m = {x_m}, y_m = {y_m:.4}{looks}{more}{said} }}"
            );
        }
        text
    }

    /// Signal, own name and pin of each, without what is said of all of them.
    fn sensors<'a>(&self, pins: &'a Pins) -> Vec<(&'a str, &'a str, &'a str)> {
        let begins = NAMED.iter().filter(|(_, table)| *table == self.table);
        let sensors = pins.iter().filter_map(|(signal, pin)| {
            let name = begins
                .clone()
                .find_map(|(begin, _)| signal.strip_prefix(begin))?;
            let is_one = self.of_all.iter().all(|(all, _)| all != signal);
            is_one.then_some((&signal[..], name, &pin[..]))
        });
        sensors.collect()
    }
}

/// The signals whose place is that in a row, as nobody said another.
fn in_row<'a>(sensors: &[(&'a str, &str, &str)], places: &Places) -> Vec<&'a str> {
    let signals = sensors.iter().map(|(signal, ..)| *signal);
    signals
        .filter(|signal| place_of(places, signal).is_none())
        .collect()
}

/// Where a signal is in a row, from the middle to the left, in steps from one to the next.
fn aside(signal: &str, row: &[&str]) -> f64 {
    let index = row
        .iter()
        .position(|own| *own == signal)
        .unwrap_or_default();
    0.5 * (row.len() as f64 - 1.0) - index as f64
}

/// What is said of all sensors of a kind, as keys of one.
fn said(pins: &Pins, of_all: &[(&str, &str)], has: impl Fn(&str) -> bool) -> String {
    let said = pins.iter().filter_map(|(signal, value)| {
        let (_, key) = of_all.iter().find(|(own, _)| own == signal)?;
        let is_plain = value == "true" || value.parse::<f64>().is_ok();
        let value = if is_plain {
            value.clone()
        } else {
            format!("{value:?}")
        };
        has(key).then(|| format!(", {key} = {value}"))
    });
    said.collect()
}

/// A pin as a file has it: a number, or a name in quotes.
pub(super) fn quoted(pin: &str) -> String {
    match pin.parse::<u8>() {
        Ok(_) => pin.to_owned(),
        Err(_) => format!("{pin:?}"),
    }
}
