//! The sensors of a robot file to start from: sonars at the place that their names say; what looks down or for obstacles in
//! a row from left to right, as it was given, `rear` or `back` in one behind; or where somebody says that they are.

use super::sonars::{self, is_of_sonar};
use rumbo_sim::wiring::SONARS;
use std::fmt::Write;

/// How the name of a line sensor begins among the pins, before a name of its own.
pub const LINE: &str = "line_";
/// How the name of an infrared switch for obstacles begins.
pub const OBSTACLE: &str = "obstacle_";
/// How that of a Sharp begins, which gives a voltage.
pub const SHARP: &str = "sharp_";

/// What may be said of all sensors of a kind in place of one, and the key that says it: `line_dark=low`.
const OF_LINES: [(&str, &str); 4] = [
    ("line_dark", "dark"),
    ("line_rc", "rc"),
    ("line_light_v", "light_v"),
    ("line_dark_v", "dark_v"),
];
const OF_OBSTACLES: [(&str, &str); 2] =
    [("obstacle_seen", "seen"), ("obstacle_reach_m", "reach_m")];

/// In place of a pin, how far apart line sensors are \[m\]: 0.0095 those of a QTR-8.
pub const PITCH: &str = "line_pitch_m";
/// Words for what is behind the wheels.
const BEHIND: [&str; 2] = ["rear", "back"];

/// Line sensors are so far ahead, and so far apart \[m\]; two stand beside the tape, one on each side.
const LINE_AHEAD_M: f64 = 0.09;
const PITCH_M: f64 = 0.015;
const ASTRIDE_M: f64 = 0.04;
/// Those for obstacles are so far ahead, so far apart \[m\], and look so far apart \[deg\].
const AHEAD_M: f64 = 0.11;
/// What is behind the wheels is so far ahead of them \[m\].
const REAR_M: f64 = -0.08;
const APART_M: f64 = 0.05;
const APART_DEG: f64 = 30.0;

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
        says(&BEHIND),
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

/// The table of the line sensors, empty without any.
pub(super) fn line_sensors(wiring: &str, pins: &Pins, places: &Places) -> String {
    let rc = pins.iter().any(|(signal, _)| signal == "line_rc");
    let sensors = of_kind(pins, &OF_LINES, |signal| {
        signal.starts_with(LINE) && signal != PITCH
    });
    let pitch = pins.iter().find(|(signal, _)| signal == PITCH);
    let pitch_m: Option<f64> = pitch.and_then(|(_, metres)| metres.parse().ok());
    let mut text = String::new();
    if !sensors.is_empty() {
        let _ = write!(
            text,
            "\n# Sensors that look down, from left to right: measure where they are. Over a dark floor they are high, unless\n\
             # dark = \"low\".\n[wiring.{wiring}.line]\n"
        );
    }
    for (signal, pin) in &sensors {
        let usual = || {
            let row = row_of(signal, &sensors, places);
            let usual_m = if row.len() == 2 { ASTRIDE_M } else { PITCH_M };
            let x_m = if is_behind(signal) {
                REAR_M
            } else {
                LINE_AHEAD_M
            };
            [x_m, pitch_m.unwrap_or(usual_m) * aside(signal, &row), 0.0]
        };
        let [x_m, y_m, _] = place_of(places, signal).unwrap_or_else(usual);
        let analogue = pin.parse::<u8>().is_err() && !rc;
        let kind = if analogue { ", analogue = true" } else { "" };
        // Voltages are those of the analogue ones.
        let said = said(pins, &OF_LINES, |key| analogue || !key.ends_with("_v"));
        let (name, pin) = (&signal[LINE.len()..], quoted(pin));
        let _ = writeln!(
            text,
            "{name} = {{ pin = {pin}, x_m = {x_m}, y_m = {y_m:.4}{kind}{said} }}"
        );
    }
    text
}

/// The table of the infrared sensors for obstacles, empty without any.
pub(super) fn obstacle_sensors(wiring: &str, pins: &Pins, places: &Places) -> String {
    let sensors = of_kind(pins, &OF_OBSTACLES, |signal| {
        signal.starts_with(OBSTACLE) || signal.starts_with(SHARP)
    });
    let mut text = String::new();
    if !sensors.is_empty() {
        let _ = write!(
            text,
            "\n# Infrared sensors for obstacles, from left to right: measure where they are and look. One is low where something is\n\
             # nearer than reach_m = 0.15, unless seen = \"high\"; an analogue one is a Sharp GP2Y0A21YK.\n[wiring.{wiring}.obstacle]\n"
        );
    }
    for (signal, pin) in &sensors {
        let usual = || {
            let aside = aside(signal, &row_of(signal, &sensors, places));
            let (y_m, angle_deg) = (APART_M * aside, APART_DEG * aside);
            match is_behind(signal) {
                true if angle_deg < 0.0 => [REAR_M, y_m, -180.0 - angle_deg],
                true => [REAR_M, y_m, 180.0 - angle_deg],
                false => [AHEAD_M, y_m, angle_deg],
            }
        };
        let [x_m, y_m, angle_deg] = place_of(places, signal).unwrap_or_else(usual);
        let (name, more) = match signal.strip_prefix(SHARP) {
            Some(name) => (name, ", analogue = true".to_owned()),
            None => (
                &signal[OBSTACLE.len()..],
                said(pins, &OF_OBSTACLES, |_| true),
            ),
        };
        let pin = quoted(pin);
        let _ = writeln!(
            text,
            "{name} = {{ pin = {pin}, x_m = {x_m}, y_m = {y_m:.3}, angle_deg = {angle_deg}{more} }}"
        );
    }
    text
}

/// Sensors of a kind, without what is said of all of them.
fn of_kind<'a>(
    pins: &'a Pins,
    of_all: &[(&str, &str)],
    is_kind: impl Fn(&str) -> bool,
) -> Vec<(&'a str, &'a str)> {
    let signals = pins.iter().map(|(signal, pin)| (&signal[..], &pin[..]));
    let own = signals
        .filter(|(signal, _)| is_kind(signal) && of_all.iter().all(|(all, _)| all != signal));
    own.collect()
}

/// Whether a name says that a sensor is behind the wheels.
fn is_behind(signal: &str) -> bool {
    signal.split('_').any(|word| BEHIND.contains(&word))
}

/// The signals in the row of one, ahead or behind: those whose place nobody said.
fn row_of<'a>(signal: &str, sensors: &[(&'a str, &str)], places: &Places) -> Vec<&'a str> {
    let signals = sensors.iter().map(|(other, _)| *other);
    signals
        .filter(|other| is_behind(other) == is_behind(signal) && place_of(places, other).is_none())
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
