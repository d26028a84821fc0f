//! The sensors of a robot file to start from: sonars at the place that their names say; those of other kinds in a row from
//! left to right, as it was given, `rear` or `back` in one behind; or where somebody says that they are.

use super::new_asked::{self, LIGHT, LINE, LINE_PITCH, MAXSONAR, OBSTACLE, SHARP};
use super::sonars::{self, is_of_sonar};
use rumbo_sim::wiring::SONARS;
use std::fmt::Write;

/// How the names of sensors begin among the pins, before a name of its own, and their table in a wiring: a Sharp gives a
/// voltage.
pub const NAMED: [(&str, &str); 5] = [
    (LINE, "line"),
    (OBSTACLE, "obstacle"),
    (SHARP, "obstacle"),
    (LIGHT, "light"),
    (MAXSONAR, "maxsonar"),
];
/// Says that light sensors are modules with a comparator.
const LIGHT_SWITCH: &str = "light_switch_lux";
/// The pin of all MaxSonars' RX.
const MAXSONAR_RX: &str = "maxsonar_rx";
/// Words for what is behind the wheels.
const BEHIND: [&str; 2] = ["rear", "back"];
/// It is so far ahead of them \[m\].
const REAR_M: f64 = -0.08;

/// Sensors of a kind, which stand in a row from left to right.
struct InRow {
    /// Their table in a wiring.
    table: &'static str,
    /// Its comment.
    about: &'static str,
    /// So far ahead \[m\].
    ahead_m: f64,
    /// From one to the next of so many \[m\].
    apart_m: fn(usize) -> f64,
    /// They look so far apart \[deg\]; nothing of those that look down.
    apart_deg: f64,
}

/// Two stand beside the tape, one on each side.
const LINES: InRow = InRow {
    table: "line",
    about: "Sensors that look down, from left to right: measure where they are. Over a dark floor they are high, unless\n\
            # dark = \"low\".",
    ahead_m: 0.09,
    apart_m: |count| if count == 2 { 0.04 } else { 0.015 },
    apart_deg: 0.0,
};

const OBSTACLES: InRow = InRow {
    table: "obstacle",
    about: "Infrared sensors for obstacles, from left to right: measure where they are and look. One is low where something \
            is\n# nearer than reach_m = 0.15, unless seen = \"high\"; an analogue one is a Sharp GP2Y0A21YK, or\n# model = \"gp2y0a02\" or \"gp2y0a41\".",
    ahead_m: 0.11,
    apart_m: |_| 0.05,
    apart_deg: 30.0,
};

const LIGHTS: InRow = InRow {
    table: "light",
    about: "Light sensors, from left to right: measure where they are and look. An analogue one is a photoresistor at 5 V \
            with\n# 10 kOhm to GND, higher where it is bright, unless bright = \"low\"; another one is low above switch_lux = 50.",
    ahead_m: 0.08,
    apart_m: |_| 0.08,
    apart_deg: 60.0,
};

const MAXSONARS: InRow = InRow {
    table: "maxsonar",
    about: "Range finders that measure by themselves, from left to right: measure where they are and look. One gives a pulse \
            (PW),\n# an analogue one a voltage (AN).",
    ahead_m: 0.11,
    apart_m: |_| 0.06,
    apart_deg: 45.0,
};

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

/// The tables of the sensors that stand in rows, each empty without any.
pub(super) fn rows(wiring: &str, pins: &Pins, places: &Places) -> String {
    let said_of_all = |key: &str| pins.iter().any(|(signal, _)| signal == key);
    let rc = said_of_all("line_rc");
    // What else one says of itself, and which keys that are said of all it has.
    let line = |_: &str, pin: &str| match is_analogue(pin) && !rc {
        true => (ANALOGUE, &[][..]),
        false => ("", &["light_v", "dark_v"][..]),
    };
    let obstacle = |signal: &str, _: &str| match signal.starts_with(SHARP) {
        true => (ANALOGUE, &["seen", "reach_m"][..]),
        false => ("", &["model"][..]),
    };
    let modules = said_of_all(LIGHT_SWITCH);
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

/// Where each sensor is whose place is that of its row or of its name, or was said.
pub(super) fn places(pins: &Pins, places: &Places) -> Vec<(String, [f64; 3])> {
    let sonars = sonars(pins).into_iter().filter_map(|sonar| {
        let place = place_of(places, sonar).or_else(|| usual_place(sonar))?;
        Some((sonar, place))
    });
    let rows = [LINES, OBSTACLES, LIGHTS, MAXSONARS];
    let rows = rows.iter().flat_map(|row| row.sensors(pins, places));
    let all = sonars.chain(rows.map(|sensor| (sensor.signal, sensor.place)));
    all.map(|(sensor, place)| (sensor.to_owned(), place))
        .collect()
}

/// How far line sensors are apart where nobody says it \[m\].
pub(super) fn line_pitch_m(pins: &Pins) -> f64 {
    let sensors = LINES.sensors(pins, &[]).into_iter();
    let ahead = sensors.filter(|sensor| !is_behind(sensor.signal));
    (LINES.apart_m)(ahead.count())
}

/// Whether there are photoresistors among the light sensors: on an analogue input, unless all are said to be modules.
pub(super) fn are_photoresistors(pins: &Pins) -> bool {
    let are_modules = pins.iter().any(|(signal, _)| signal == LIGHT_SWITCH);
    let sensors = LIGHTS.sensors(pins, &[]);
    !are_modules && sensors.iter().any(|sensor| is_analogue(sensor.pin))
}

fn is_analogue(pin: &str) -> bool {
    pin.parse::<u8>().is_err()
}

/// A sensor in a row.
struct Sensor<'a> {
    signal: &'a str,
    /// That of its own, behind the beginning.
    name: &'a str,
    pin: &'a str,
    place: [f64; 3],
}

impl InRow {
    /// Their table, empty without any; `more` is what one says of itself, and which keys of all it has not.
    fn text<'k>(
        &self,
        wiring: &str,
        pins: &Pins,
        places: &Places,
        more: impl Fn(&str, &str) -> (&'k str, &'k [&'k str]),
    ) -> String {
        let sensors = self.sensors(pins, places);
        let mut text = String::new();
        if !sensors.is_empty() {
            let Self { about, table, .. } = self;
            let _ = write!(text, "\n# {about}\n[wiring.{wiring}.{table}]\n");
        }
        for sensor in sensors {
            let [x_m, y_m, angle_deg] = sensor.place;
            let looks = match self.apart_deg {
                0.0 => String::new(),
                _ => format!(", angle_deg = {angle_deg}"),
            };
            let (more, lacks) = more(sensor.signal, sensor.pin);
            let said = self.said(pins, |key| !lacks.contains(&key));
            let (name, pin) = (sensor.name, quoted(sensor.pin));
            let _ = writeln!(
                text,
                "{name} = {{ pin = {pin}, x_m = {x_m}, y_m = {y_m:.4}{looks}{more}{said} }}"
            );
        }
        text
    }

    /// What a signal is called behind the beginning of those of this kind.
    fn own_name<'a>(&self, signal: &'a str) -> Option<&'a str> {
        let mut begins = NAMED.iter().filter(|(_, table)| *table == self.table);
        begins.find_map(|(begin, _)| signal.strip_prefix(begin))
    }

    /// Those among the pins, where somebody says that they are or in a row, ahead or behind.
    fn sensors<'a>(&self, pins: &'a Pins, places: &Places) -> Vec<Sensor<'a>> {
        let own = pins.iter().filter_map(|(signal, pin)| {
            let name = self.own_name(signal)?;
            (!is_of_all(signal)).then_some((&signal[..], name, &pin[..]))
        });
        let own: Vec<_> = own.collect();
        let pitch = pins.iter().find(|(signal, _)| signal == LINE_PITCH);
        let pitch_m: Option<f64> = pitch.and_then(|(_, metres)| metres.parse().ok());
        let usual = |signal: &str| {
            let with = |other: &str| {
                is_behind(other) == is_behind(signal) && place_of(places, other).is_none()
            };
            let row: Vec<_> = own.iter().filter(|(other, ..)| with(other)).collect();
            let before = row
                .iter()
                .take_while(|(other, ..)| *other != signal)
                .count();
            let aside = 0.5 * (row.len() as f64 - 1.0) - before as f64;
            let apart_m = pitch_m.filter(|_| self.table == LINES.table);
            let y_m = apart_m.unwrap_or((self.apart_m)(row.len())) * aside;
            let angle_deg = self.apart_deg * aside;
            match is_behind(signal) {
                false => [self.ahead_m, y_m, angle_deg],
                true if self.apart_deg == 0.0 => [REAR_M, y_m, 0.0],
                true => [REAR_M, y_m, 180.0_f64.copysign(angle_deg) - angle_deg],
            }
        };
        let sensors = own.iter().map(|&(signal, name, pin)| Sensor {
            signal,
            name,
            pin,
            place: place_of(places, signal).unwrap_or_else(|| usual(signal)),
        });
        sensors.collect()
    }

    /// What is said of all of them, as keys of one.
    fn said(&self, pins: &Pins, has: impl Fn(&str) -> bool) -> String {
        let said = pins.iter().filter_map(|(signal, value)| {
            let key = self
                .own_name(signal)
                .filter(|key| is_of_all(signal) && has(key))?;
            let is_plain = value.parse::<bool>().is_ok() || value.parse::<f64>().is_ok();
            let value = if is_plain {
                value.clone()
            } else {
                format!("{value:?}")
            };
            (signal != LINE_PITCH).then(|| format!(", {key} = {value}"))
        });
        said.collect()
    }
}

/// Whether it is said of all sensors of a kind, and is none of them.
fn is_of_all(signal: &str) -> bool {
    signal == MAXSONAR_RX || new_asked::find(signal).is_some()
}

/// Whether a name says that a sensor is behind the wheels.
fn is_behind(signal: &str) -> bool {
    signal.split('_').any(|word| BEHIND.contains(&word))
}

/// A pin as a file has it: a number, or a name in quotes.
pub(super) fn quoted(pin: &str) -> String {
    match pin.parse::<u8>() {
        Ok(_) => pin.to_owned(),
        Err(_) => format!("{pin:?}"),
    }
}
