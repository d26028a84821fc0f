//! Dark lines of a world, and the sensors of a robot that see them.
//!
//! ```toml
//! [[line]]                 # of a world
//! points_m = [[0, 0], [1, 0], [1, 1]]
//! width_m = 0.02           # 0.019, that of tape, where it is left out
//! closed = true            # back to its first point
//!
//! [wiring.mine.line]       # of a robot: a name, a pin, and where it is
//! left = { pin = 2, x_m = 0.08, y_m = 0.015 }
//! right = { pin = "A1", x_m = 0.08, y_m = -0.015, analogue = true, dark = "low" }
//! far = { pin = "A2", x_m = 0.08, y_m = -0.03, analogue = true, light_v = 0.2, dark_v = 4.8 }
//! beside = { pin = 4, x_m = 0.08, y_m = 0.03, rc = true }    # a time: QTR-RC
//! ```

use super::pin::{is_free, read_pin};
use super::read::{Allowed, Table};
use super::value::PLACE;
use rumbo_sim::floor::{DarkLine, FloorReading, LineSensor, USUAL_V};
use rumbo_sim::wiring::Wiring;

/// Most lines of a world, and corners of one.
const MOST_LINES: usize = 100;
const MOST_POINTS: usize = 500;
const WIDTH: Allowed = Allowed::new(0.002, 0.2, "m");
/// Position of a sensor on the body.
pub(super) const MOUNT: Allowed = Allowed::new(-0.5, 0.5, "m");
/// Voltages at a pin.
pub(super) const SUPPLY: Allowed = Allowed::new(0.0, 5.0, "V");
/// That of usual tape.
const TAPE_M: f64 = 0.019;

/// The lines of a world.
pub(super) fn read_lines(root: &Table<'_, '_>) -> Vec<DarkLine> {
    let tables = root.tables("line", MOST_LINES);
    tables.iter().map(read_line).collect()
}

fn read_line(table: &Table<'_, '_>) -> DarkLine {
    let mut points_m = Vec::new();
    let what = "a list of points [x, y] in m, at least two";
    table.require("points_m", what);
    if let Some((line, items)) = table.items("points_m", what) {
        for item in items.iter().take(MOST_POINTS) {
            let pair = item.value.as_array().map(|pair| {
                let numbers = pair.iter().map(|each| each.get_ref());
                let numbers =
                    numbers.map(|each| table.judge_number("points_m", item.line, each, PLACE));
                numbers.collect::<Vec<_>>()
            });
            match pair.as_deref() {
                Some([Some(x_m), Some(y_m)]) => points_m.push([*x_m, *y_m]),
                Some(pair) if pair.contains(&None) => {}
                _ => table.complain("points_m", item.line, "a point", "must be [x, y] in m"),
            }
        }
        if items.len() < 2 || items.len() > MOST_POINTS {
            let remedy = format!("must be {what}, at most {MOST_POINTS}");
            table.complain(
                "points_m",
                line,
                &format!("{} points", items.len()),
                &remedy,
            );
        }
    }
    let width_m = table.number("width_m", WIDTH).unwrap_or(TAPE_M);
    if table.flag("closed").is_some_and(|closed| closed.value) {
        points_m.extend(points_m.first().copied());
    }
    table.finish();
    DarkLine { points_m, width_m }
}

/// Whether a key says `"high"`, not `"low"`.
pub(super) fn read_level(table: &Table<'_, '_>, key: &str) -> Option<bool> {
    let level = table.text(key)?;
    if !["high", "low"].contains(&level.value.as_str()) {
        let remedy = "must be \"high\" or \"low\"";
        table.complain(key, level.line, &level.value, remedy);
    }
    Some(level.value == "high")
}

/// What sensors of a robot have: whether the output is analogue, its pin, and the place on the robot.
pub(super) fn read_mounted(table: &Table<'_, '_>, wiring: &Wiring) -> (bool, Option<u8>, [f64; 2]) {
    let analogue = table.flag("analogue").is_some_and(|flag| flag.value);
    table.require("pin", "the pin of the sensor's output, e.g. 2 or \"A0\"");
    let pin = read_pin(table, "pin", wiring.board, analogue);
    let at_m = [
        table.required_number("x_m", MOUNT),
        table.number("y_m", MOUNT).unwrap_or(0.0),
    ];
    (analogue, pin, at_m)
}

/// What a sensor gives.
fn read_reading(table: &Table<'_, '_>, analogue: bool) -> FloorReading {
    let mut volts = USUAL_V;
    for (key, volts) in ["light_v", "dark_v"].into_iter().zip(&mut volts) {
        let Some(number) = table.placed_number(key, SUPPLY) else {
            continue;
        };
        *volts = number.value;
        if !analogue {
            let remedy = "is of a sensor with analogue = true";
            table.complain(key, number.line, &number.value.to_string(), remedy);
        }
    }
    match (table.flag("rc").filter(|rc| rc.value), analogue) {
        (Some(rc), true) => {
            table.complain(
                "rc",
                rc.line,
                "true",
                "or analogue = true: a sensor gives a time or a voltage",
            );
            FloorReading::Discharge
        }
        (Some(_), false) => FloorReading::Discharge,
        (None, true) => FloorReading::Volts(volts),
        (None, false) => FloorReading::Level,
    }
}

/// Reads the line sensors into a wiring.
pub(super) fn read_line_sensors(table: &Table<'_, '_>, wiring: &mut Wiring) {
    for key in table.keys() {
        let own = table.table(key.value);
        let (analogue, pin, at_m) = read_mounted(&own, wiring);
        let dark_high = read_level(&own, "dark").unwrap_or(true);
        let reading = read_reading(&own, analogue);
        own.finish();
        let Some(pin) = pin else { continue };
        is_free(&own, "pin", pin, wiring);
        wiring.line_sensors.push(LineSensor {
            name: key.value.to_owned(),
            at_m,
            pin,
            reading,
            dark_high,
        });
    }
    table.finish();
}
