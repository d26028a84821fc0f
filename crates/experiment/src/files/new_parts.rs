//! The parts of a robot file to start from: `NAME=KIND:PLACE`, and what else a kind says of itself behind its place.

use super::new_sensors::{Places, place_of, quoted};
use rumbo_sim::bus::DeviceKind;

/// The line of a part: name, kind and place with what is behind it.
pub(super) fn part_of([name, kind, place]: &[String; 3], places: &Places) -> String {
    let (place, more) = place.split_once(':').unwrap_or((place, ""));
    let of_place = match address_or_pin(place) {
        Ok(_) => place.to_owned(),
        Err(_) => format!("{place:?}"),
    };
    let rest: Vec<&str> = more.split(':').collect();
    let said = match (more, kind.as_str()) {
        ("", _) => String::new(),
        (codes, "infrared") if codes.contains('=') => own_remote(codes),
        (keys, "infrared") => format!(", keys = {}", quoted(keys)),
        (to, "button" | "switch") => format!(", to = {to:?}"),
        (pin, "vl53l0x") => format!(", xshut = {}", quoted(pin)),
        (_, "hd44780") if rest.len() >= 5 => return display(name, place, &rest),
        (size, _) => format!(", size = {size:?}"),
    };
    let at = place_of(places, name).filter(|_| has_place(kind));
    let at = at.map_or_else(String::new, |[x_m, y_m, deg]| {
        let angle = match kind.as_str() {
            "vl53l0x" => format!(", angle_deg = {deg}"),
            _ => String::new(),
        };
        format!(", x_m = {x_m}, y_m = {y_m}{angle}")
    });
    format!("parts.{name} = {{ {kind} = {of_place}{said}{at} }}")
}

/// Whether parts of a kind have a place on the robot.
pub fn has_place(kind: &str) -> bool {
    let devices = DeviceKind::ALL.into_iter();
    let mut placed = devices.filter(|device| device.has_place());
    placed.any(|device| device.name() == kind)
}

fn address_or_pin(place: &str) -> Result<u8, std::num::ParseIntError> {
    match place.strip_prefix("0x") {
        Some(digits) => u8::from_str_radix(digits, 16),
        None => place.parse(),
    }
}

/// A display on pins of its own, `12:11:5:4:3:2` and perhaps its size, in the order of LiquidCrystal's constructor.
fn display(name: &str, rs: &str, others: &[&str]) -> String {
    let lines = ["rs", "e", "d4", "d5", "d6", "d7"];
    let pins = [&[rs], &others[..5]].concat();
    let pins: Vec<String> = lines
        .iter()
        .zip(pins)
        .map(|(line, pin)| format!("{line} = {}", quoted(pin)))
        .collect();
    let size = others.get(5);
    let size = size.map_or_else(String::new, |size| format!(", size = {size:?}"));
    format!(
        "parts.{name} = {{ hd44780 = {{ {} }}{size} }}",
        pins.join(", ")
    )
}

/// The keys of a remote control by their codes, as `left=0x20DF1BE4:right=551525220`; behind `raw:` in the other order.
fn own_remote(codes: &str) -> String {
    let (table, codes) = match codes.strip_prefix("raw:") {
        Some(codes) => ("raw_keys", codes),
        None => ("keys", codes),
    };
    let is_bare = |key: &str| {
        key.chars()
            .all(|c| c.is_ascii_alphanumeric() || "-_".contains(c))
    };
    let entry = |code: &str| match code.split_once('=') {
        Some((key, bits)) if is_bare(key) => format!("{key} = {bits}"),
        Some((key, bits)) => format!("{key:?} = {bits}"),
        None => code.to_owned(),
    };
    let codes: Vec<String> = codes.split(':').map(entry).collect();
    format!(", {table} = {{ {} }}", codes.join(", "))
}
