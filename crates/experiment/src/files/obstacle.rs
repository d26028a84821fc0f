//! The infrared sensors of a robot that look for obstacles.
//!
//! ```toml
//! [wiring.mine.obstacle]
//! left = { pin = 2, x_m = 0.1, y_m = 0.05, angle_deg = 30 }   # low where something is nearer than reach_m = 0.15
//! front = { pin = "A0", x_m = 0.1, analogue = true }          # a voltage, Sharp GP2Y0A21YK; with model = "gp2y0a02", 20 to
//!                                                             # 150 cm, with "gp2y0a41" 4 to 30 cm
//! ```

use super::line::{read_level, read_mounted};
use super::named::read_named;
use super::pin::is_free;
use super::read::{Allowed, Table};
use rumbo_sim::obstacle::{ObstacleSensor, SHARPS, Sight};
use rumbo_sim::wiring::Wiring;

/// Where a sensor may look.
const ANGLE: Allowed = Allowed::new(-180.0, 180.0, "deg");
/// What the potentiometer of a switch sets.
pub(super) const REACH: Allowed = Allowed::new(0.02, 0.8, "m");
/// Where it usually stands \[m\].
pub(super) const REACH_M: f64 = 0.15;

/// Reads the sensors into a wiring.
pub(super) fn read_obstacle_sensors(table: &Table<'_, '_>, wiring: &mut Wiring) {
    for key in table.keys() {
        let own = table.table(key.value);
        let (analogue, pin, at_m) = read_mounted(&own, wiring);
        let angle_deg = own.number("angle_deg", ANGLE).unwrap_or(0.0);
        let sight = match analogue {
            true => Sight::Volts(read_named(&own, "model", &SHARPS, |sharp| sharp.name)),
            false => Sight::Switch {
                reach_m: own.number("reach_m", REACH).unwrap_or(REACH_M),
                seen_high: read_level(&own, "seen").unwrap_or(false),
            },
        };
        own.finish();
        let Some(pin) = pin else { continue };
        is_free(&own, "pin", pin, wiring);
        wiring.obstacle_sensors.push(ObstacleSensor {
            name: key.value.to_owned(),
            at_m,
            angle_rad: angle_deg.to_radians(),
            pin,
            sight,
        });
    }
    table.finish();
}
