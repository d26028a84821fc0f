//! The sensors of a robot file to start from: sonars at the place that their names say; what looks down or for obstacles in
//! a row from left to right, as it was given; or where somebody says that they are.

use super::new_asked::{self, LINE, OBSTACLE};
use super::sonars::{self, is_of_sonar};
use rumbo_sim::wiring::SONARS;
use std::fmt::Write;

/// How that of a Sharp begins, which gives a voltage.
pub const SHARP: &str = "sharp_";

/// Line sensors are so far ahead, and so far apart \[m\]; two stand beside the tape, one on each side.
const LINE_AHEAD_M: f64 = 0.09;
const PITCH_M: f64 = 0.015;
const ASTRIDE_M: f64 = 0.04;
/// Those for obstacles are so far ahead, so far apart \[m\], and look so far apart \[deg\].
const AHEAD_M: f64 = 0.11;
const APART_M: f64 = 0.05;
const APART_DEG: f64 = 30.0;

/// Signals and their pins, or what is said of all sensors of a kind.
type Pins = [(String, String)];
/// Where sensors are by their signals: x and y \[m\], and the direction \[deg\].
pub(super) type Places = [(String, [f64; 3])];

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

/// The table of the line sensors, empty without any.
pub(super) fn line_sensors(wiring: &str, pins: &Pins, places: &Places) -> String {
    let rc = pins.iter().any(|(signal, _)| signal == "line_rc");
    let sensors = lines(pins, places);
    let mut text = String::new();
    if !sensors.is_empty() {
        let _ = write!(
            text,
            "\n# Sensors that look down, from left to right: measure where they are. Over a dark floor they are high, unless\n\
             # dark = \"low\".\n[wiring.{wiring}.line]\n"
        );
    }
    for (signal, pin, [x_m, y_m, _]) in sensors {
        let analogue = pin.parse::<u8>().is_err() && !rc;
        let kind = if analogue { ", analogue = true" } else { "" };
        // Voltages are those of the analogue ones.
        let said = said(pins, LINE, |key| analogue || !key.ends_with("_v"));
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
    let sensors = obstacles(pins, places);
    let mut text = String::new();
    if !sensors.is_empty() {
        let _ = write!(
            text,
            "\n# Infrared sensors for obstacles, from left to right: measure where they are and look. One is low where something is\n\
             # nearer than reach_m = 0.15, unless seen = \"high\"; an analogue one is a Sharp GP2Y0A21YK.\n[wiring.{wiring}.obstacle]\n"
        );
    }
    for (signal, pin, [x_m, y_m, angle_deg]) in sensors {
        let (name, more) = match signal.strip_prefix(SHARP) {
            Some(name) => (name, ", analogue = true".to_owned()),
            None => (&signal[OBSTACLE.len()..], said(pins, OBSTACLE, |_| true)),
        };
        let pin = quoted(pin);
        let _ = writeln!(
            text,
            "{name} = {{ pin = {pin}, x_m = {x_m}, y_m = {y_m:.3}, angle_deg = {angle_deg}{more} }}"
        );
    }
    text
}

/// Where each sensor is whose place is that of its row or of its name, or was said.
pub(super) fn places(pins: &Pins, places: &Places) -> Vec<(String, [f64; 3])> {
    let sonars = sonars(pins).into_iter().filter_map(|sonar| {
        let place = place_of(places, sonar).or_else(|| usual_place(sonar))?;
        Some((sonar, place))
    });
    let rows = [lines(pins, places), obstacles(pins, places)].concat();
    let rows = rows.into_iter().map(|(signal, _, place)| (signal, place));
    let all = sonars.chain(rows);
    all.map(|(sensor, place)| (sensor.to_owned(), place))
        .collect()
}

/// A sensor's signal, its pin, and where it is.
type Placed<'a> = (&'a str, &'a str, [f64; 3]);

fn lines<'a>(pins: &'a Pins, places: &Places) -> Vec<Placed<'a>> {
    let is_line = |signal: &str| signal.starts_with(LINE);
    in_row(pins, places, is_line, |count| {
        let pitch_m = if count == 2 { ASTRIDE_M } else { PITCH_M };
        ([LINE_AHEAD_M, 0.0, 0.0], [0.0, pitch_m, 0.0])
    })
}

fn obstacles<'a>(pins: &'a Pins, places: &Places) -> Vec<Placed<'a>> {
    let is_obstacle = |signal: &str| signal.starts_with(OBSTACLE) || signal.starts_with(SHARP);
    in_row(pins, places, is_obstacle, |_| {
        ([AHEAD_M, 0.0, 0.0], [0.0, APART_M, APART_DEG])
    })
}

/// Sensors of a kind where somebody says that they are, the others in a row: its middle and the step to the left, by its length.
fn in_row<'a>(
    pins: &'a Pins,
    places: &Places,
    is_kind: impl Fn(&str) -> bool,
    row: impl Fn(usize) -> ([f64; 3], [f64; 3]),
) -> Vec<Placed<'a>> {
    let signals = pins.iter().map(|(signal, pin)| (&signal[..], &pin[..]));
    let own: Vec<_> = signals
        .filter(|(signal, _)| is_kind(signal) && new_asked::find(signal).is_none())
        .collect();
    let elsewhere = |signal: &str| place_of(places, signal);
    let count = own
        .iter()
        .filter(|(signal, _)| elsewhere(signal).is_none())
        .count();
    let (middle, step) = row(count);
    let mut steps = 0.5 * (count as f64 - 1.0);
    let placed = own.into_iter().map(|(signal, pin)| {
        let place = elsewhere(signal).unwrap_or_else(|| {
            let place = [0, 1, 2].map(|axis| middle[axis] + steps * step[axis]);
            steps -= 1.0;
            place
        });
        (signal, pin, place)
    });
    placed.collect()
}

/// What is said of all sensors of a kind, as keys of one.
fn said(pins: &Pins, kind: &str, has: impl Fn(&str) -> bool) -> String {
    let said = pins.iter().filter_map(|(signal, value)| {
        let key = signal.strip_prefix(kind)?;
        let is_plain = value.parse::<bool>().is_ok() || value.parse::<f64>().is_ok();
        let value = if is_plain {
            value.clone()
        } else {
            format!("{value:?}")
        };
        (has(key) && new_asked::find(signal).is_some()).then(|| format!(", {key} = {value}"))
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
