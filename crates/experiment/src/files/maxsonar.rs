//! The range finders of a robot that measure by themselves.
//!
//! ```toml
//! [wiring.mine.maxsonar]
//! front = { pin = 7, x_m = 0.11 }                            # PW, a pulse of 147 us an inch
//! left = { pin = "A0", x_m = 0.05, angle_deg = 90, analogue = true, rx = 4 }   # AN, 9.8 mV an inch; stopped by pin 4
//! ```

use super::line::read_mounted;
use super::pin::{is_free, read_pin};
use super::read::Table;
use super::value::ANGLE;
use rumbo_sim::maxsonar::MaxSonar;
use rumbo_sim::wiring::Wiring;

/// Reads the range finders into a wiring.
pub(super) fn read_maxsonars(table: &Table<'_, '_>, wiring: &mut Wiring) {
    for key in table.keys() {
        let own = table.table(key.value);
        let (analogue, pin, at_m) = read_mounted(&own, wiring);
        let rx = own
            .has("rx")
            .then(|| read_pin(&own, "rx", wiring.board, false));
        let angle_deg = own.number("angle_deg", ANGLE).unwrap_or(0.0);
        own.finish();
        let Some(pin) = pin else { continue };
        is_free(&own, "pin", pin, wiring);
        // Several may be stopped by one pin.
        let rx = rx.flatten();
        let is_shared = wiring.maxsonars.iter().any(|other| other.rx == rx);
        wiring.maxsonars.push(MaxSonar {
            name: key.value.to_owned(),
            at_m,
            angle_rad: angle_deg.to_radians(),
            pin,
            analogue,
            rx: None,
        });
        if let Some(rx) = rx.filter(|_| !is_shared) {
            is_free(&own, "rx", rx, wiring);
        }
        if let Some(own) = wiring.maxsonars.last_mut() {
            own.rx = rx;
        }
    }
    table.finish();
}
