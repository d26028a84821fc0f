//! Lamps of a world, and the light sensors of a robot.
//!
//! ```toml
//! ambient_lux = 10         # of a world: the light of the room, 100 where it is left out
//! [[lamp]]
//! at_m = [2.5, 0.9]
//! height_m = 0.1           # 0.1 where it is left out
//! lumen = 806              # that of a bulb which replaces 60 W, 806, where it is left out
//!
//! [wiring.mine.light]      # of a robot: GL5528, 5 V at the photoresistor, 10 kOhm to GND
//! left = { pin = "A0", x_m = 0.08, y_m = 0.04, angle_deg = 45, analogue = true }
//! right = { pin = "A1", x_m = 0.08, y_m = -0.04, angle_deg = -45, analogue = true, bright = "low", resistor_kohm = 4.7 }
//! top = { pin = 4, x_m = 0.0, up_deg = 90, switch_lux = 200 }     # a module with a comparator: low where it is bright
//! ```

use super::line::{read_level, read_mounted};
use super::pin::is_free;
use super::read::{Allowed, Table};
use super::value::{ANGLE, PLACE};
use rumbo_sim::light::{Lamp, Light, LightReading, LightSensor};
use rumbo_sim::wiring::Wiring;

/// Most lamps of a world.
const MOST_LAMPS: usize = 50;
const HEIGHT: Allowed = Allowed::new(0.0, 10.0, "m");
/// From a light-emitting diode to a floodlight.
const FLUX: Allowed = Allowed::new(0.1, 20_000.0, "lm");
/// From a starless night to sunlight.
pub(super) const ILLUMINANCE: Allowed = Allowed::new(0.0, 100_000.0, "lx");
/// How far up a sensor looks.
const UP: Allowed = Allowed::new(-90.0, 90.0, "deg");
/// Of the other half of a divider, and of a photoresistor at 10 lx.
pub(super) const RESISTANCE: Allowed = Allowed::new(0.1, 1_000.0, "kOhm");
/// Of a corridor (EN 12464-1) \[lx\].
const AMBIENT_LUX: f64 = 100.0;
/// A lamp that stands on the floor \[m\].
const HEIGHT_M: f64 = 0.1;
/// A bulb that replaces one of 60 W (Regulation (EC) 244/2009) \[lm\].
const BULB_LUMEN: f64 = 806.0;
/// The usual divider \[kOhm\].
pub(super) const RESISTOR_KOHM: f64 = 10.0;
/// Where a trimmer usually stands \[lx\].
pub(super) const SWITCH_LUX: f64 = 50.0;

/// The light of a world.
pub(super) fn read_light(root: &Table<'_, '_>) -> Light {
    let lamps = root.tables("lamp", MOST_LAMPS).into_iter().map(|table| {
        let lamp = Lamp {
            at_m: table.required_pair("at_m", PLACE),
            height_m: table.number("height_m", HEIGHT).unwrap_or(HEIGHT_M),
            lumen: table.number("lumen", FLUX).unwrap_or(BULB_LUMEN),
        };
        table.finish();
        lamp
    });
    Light {
        lamps: lamps.collect(),
        ambient_lux: root
            .number("ambient_lux", ILLUMINANCE)
            .unwrap_or(AMBIENT_LUX),
    }
}

/// Reads the light sensors into a wiring.
pub(super) fn read_light_sensors(table: &Table<'_, '_>, wiring: &mut Wiring) {
    for key in table.keys() {
        let own = table.table(key.value);
        let (analogue, pin, at_m) = read_mounted(&own, wiring);
        let number = |key: &str, allowed, usual| own.number(key, allowed).unwrap_or(usual);
        let (other, remedy) = match analogue {
            true => ("switch_lux", "is of a module: leave analogue out"),
            false => ("resistor_kohm", "is of a sensor with analogue = true"),
        };
        if let Some((line, _)) = own.value(other) {
            own.complain(other, line, "a number", remedy);
        }
        let reading = match analogue {
            true => LightReading::Volts(1e3 * number("resistor_kohm", RESISTANCE, RESISTOR_KOHM)),
            false => LightReading::Level(number("switch_lux", ILLUMINANCE, SWITCH_LUX)),
        };
        let sensor = LightSensor {
            name: key.value.to_owned(),
            at_m,
            angle_rad: number("angle_deg", ANGLE, 0.0).to_radians(),
            up_rad: number("up_deg", UP, 0.0).to_radians(),
            pin: pin.unwrap_or_default(),
            reading,
            bright_high: read_level(&own, "bright").unwrap_or(analogue),
            rated_ohm: own.number("rated_kohm", RESISTANCE).map(|kohm| 1e3 * kohm),
        };
        own.finish();
        let Some(pin) = pin else { continue };
        is_free(&own, "pin", pin, wiring);
        wiring.light_sensors.push(sensor);
    }
    table.finish();
}
