//! The devices of a wiring that are on the two-wire bus, each at its address, and displays of letters on pins.
//!
//! ```toml
//! parts.imu = { mpu6050 = 0x68 }          # with x_m and y_m where it is, interrupt = 2 for its INT, and where
//!                                         # its x, y and z point where not so: axes = "forward left up"
//! parts.tof = { vl53l0x = 0x29 }          # with x_m, y_m and angle_deg where it is and looks, on_servo = true,
//!                                         # and xshut = 7 for its XSHUT
//! parts.compass = { qmc5883l = 0x0d }     # or hmc5883l = 0x1e; with axes as above, and in iron_x_ut and iron_y_ut the field
//!                                         # of the robot's iron, ahead and to the left
//! parts.screen = { ssd1306 = 0x3c }       # with size = "128x32"
//! parts.text = { hd44780 = 0x27 }         # with size = "20x4"; on pins of its own
//!                                         # hd44780 = { rs = 12, e = 11, d4 = 5, d5 = 4, d6 = 3, d7 = 2 }
//! ```

use super::error::did_you_mean;
use super::pin::{is_free, read_pin};
use super::read::{Allowed, Table};
use super::value::ANGLE;
use rumbo_sim::bus::{BusDevice, DeviceKind, Place};
use rumbo_sim::wiring::Wiring;

/// What is written as an address: one of 7 bits, or by mistake one of 8.
const ADDRESS: Allowed = Allowed::new(0.0, 255.0, "count");
/// Position of a sensor on the body.
const MOUNT: Allowed = Allowed::new(-0.5, 0.5, "m");
/// The field of a robot's own iron.
const IRON: Allowed = Allowed::new(-500.0, 500.0, "uT");

/// The lines of a display on pins of its own, as [`Place::Lines`] has them.
const LINES: [&str; 6] = ["rs", "e", "d4", "d5", "d6", "d7"];

/// Reads a device into a wiring.
pub(super) fn read_device(own: &Table<'_, '_>, name: &str, kind: DeviceKind, wiring: &mut Wiring) {
    let kind = read_sized(own, kind);
    let kind = read_sensor(own, kind, wiring);
    let is_text = matches!(kind, DeviceKind::Hd44780 { .. });
    let place = match is_text && own.holds_table(kind.name()) {
        true => read_lines(&own.table(kind.name()), wiring).map(Place::Lines),
        false => {
            report_taken_bus(own, kind, wiring);
            read_address(own, kind, wiring).map(Place::Address)
        }
    };
    own.finish();
    if let Some(place) = place {
        wiring.bus.push(BusDevice {
            name: name.to_owned(),
            kind,
            place,
        });
    }
}

/// Reports what is on the pins of the bus.
fn report_taken_bus(own: &Table<'_, '_>, kind: DeviceKind, wiring: &Wiring) {
    let board = wiring.board;
    for (pin, line) in board.two_wire.into_iter().zip(["SDA", "SCL"]) {
        let owner = wiring.owner_of(pin).filter(|_| !wiring.has_bus());
        let owner = owner.filter(|_| !wiring.shield_pins().any(|own| own == pin));
        if let Some(other) = owner {
            own.complain_here(&format!(
                "{} is on the two-wire bus, and {other} on its pin {} ({line}): put {other} on another pin",
                kind.name(),
                board.shown(pin)
            ));
        }
    }
}

/// The pins of a display's lines.
fn read_lines(own: &Table<'_, '_>, wiring: &Wiring) -> Option<[u8; 6]> {
    let mut pins = Vec::new();
    for line in LINES {
        if !own.has(line) {
            own.complain_here(&format!(
                "needs {line}: the pins of the display are rs, e, d4, d5, d6 and d7, as LiquidCrystal has them"
            ));
            continue;
        }
        let Some(pin) = read_pin(own, line, wiring.board, false) else {
            continue;
        };
        is_free(own, line, pin, wiring);
        if pins.contains(&pin) {
            let place = own.value(line).map_or(0, |(line, _)| line);
            let remedy = "another line of the display is on that pin: give each its own";
            own.complain(line, place, &wiring.board.shown(pin), remedy);
        }
        pins.push(pin);
    }
    own.finish();
    pins.try_into().ok()
}

/// The size of a display.
fn read_sized(own: &Table<'_, '_>, kind: DeviceKind) -> DeviceKind {
    let sizes = kind.sizes();
    let size = match sizes.is_empty() {
        true => None,
        false => own.word("size"),
    };
    let Some(size) = size else { return kind };
    let sized = sizes.iter().find(|(name, _)| *name == size.value);
    sized.map_or_else(
        || {
            let names: Vec<String> = sizes.iter().map(|(name, _)| (*name).to_owned()).collect();
            own.complain("size", size.line, &size.value, &did_you_mean(&names));
            kind
        },
        |(_, sized)| *sized,
    )
}

/// Where a sensor is, how it is turned, and its pin beside the bus.
fn read_sensor(own: &Table<'_, '_>, mut kind: DeviceKind, wiring: &Wiring) -> DeviceKind {
    let place = || ["x_m", "y_m"].map(|key| own.number(key, MOUNT).unwrap_or(0.0));
    let free_pin = |key: &str| {
        let pin = own
            .has(key)
            .then(|| read_pin(own, key, wiring.board, false));
        pin.flatten().inspect(|pin| is_free(own, key, *pin, wiring))
    };
    match &mut kind {
        DeviceKind::Mpu6050 {
            at_m,
            axes,
            interrupt,
        } => {
            *axes = read_axes(own).unwrap_or(*axes);
            *at_m = place();
            *interrupt = free_pin("interrupt");
        }
        DeviceKind::Vl53l0x { mount, shutdown } => {
            [mount.x_m, mount.y_m] = place();
            mount.angle_rad = own.number("angle_deg", ANGLE).unwrap_or(0.0).to_radians();
            mount.on_servo = own.flag("on_servo").is_some_and(|flag| flag.value);
            *shutdown = free_pin("xshut");
        }
        DeviceKind::Qmc5883l(mounted) | DeviceKind::Hmc5883l(mounted) => {
            mounted.axes = read_axes(own).unwrap_or(mounted.axes);
            let iron = |key: &str| own.number(key, IRON).unwrap_or(0.0);
            mounted.iron_ut = ["iron_x_ut", "iron_y_ut"].map(iron);
        }
        DeviceKind::Ssd1306 { .. } | DeviceKind::Hd44780 { .. } => {}
    }
    kind
}

/// Where the axes of a sensor point.
fn read_axes(own: &Table<'_, '_>) -> Option<[i8; 3]> {
    let text = own.text("axes")?;
    let directions = DeviceKind::directions();
    let words = text.value.split_whitespace();
    let axes = words.map(|word| {
        let found = directions.iter().find(|(name, _)| *name == word);
        found.map(|(_, axis)| *axis)
    });
    let axes: Option<Vec<i8>> = axes.collect();
    let axes = axes.and_then(|axes| <[i8; 3]>::try_from(axes).ok());
    // Forward, left, up, and what is turned about one of them: an even order, as many opposites as that.
    let right_handed = |axes: &[i8; 3]| {
        let order = axes.map(i8::unsigned_abs);
        let even = [[1, 2, 3], [2, 3, 1], [3, 1, 2]].contains(&order);
        let odd = [[1, 3, 2], [2, 1, 3], [3, 2, 1]].contains(&order);
        let opposites = axes.iter().filter(|axis| **axis < 0).count();
        even && opposites.is_multiple_of(2) || odd && !opposites.is_multiple_of(2)
    };
    let axes = axes.filter(right_handed);
    if axes.is_none() {
        let names: Vec<&str> = directions.iter().map(|(name, _)| *name).collect();
        let remedy = format!(
            "must be where x, y and z of the chip point, right-handed, of {}, e.g. \"up left backward\"",
            names.join(", ")
        );
        own.complain("axes", text.line, &format!("{:?}", text.value), &remedy);
    }
    axes
}

/// The address of a device, one that it can have and no other one has.
fn read_address(own: &Table<'_, '_>, kind: DeviceKind, wiring: &Wiring) -> Option<u8> {
    let given = own.placed_number(kind.name(), ADDRESS)?;
    let (line, address) = (given.line, given.value as u8);
    let allowed = kind.addresses();
    let fits = |address: u8| allowed.iter().any(|range| range.contains(&address));
    let ranges: Vec<String> = allowed
        .iter()
        .map(|range| match range.start() == range.end() {
            true => format!("0x{:02x}", range.start()),
            false => format!("0x{:02x} to 0x{:02x}", range.start(), range.end()),
        })
        .collect();
    let ranges = ranges.join(" or ");
    // A program gives one of them another while it holds the other in reset.
    let shares = |other: &BusDevice| {
        kind.name() == other.kind.name() && (kind.has_reset() || other.kind.has_reset())
    };
    let mut others = wiring.bus.iter();
    let taken = others.find(|other| other.address() == Some(address) && !shares(other));
    let remedy = if let Some(other) = taken {
        let remedy = match kind {
            DeviceKind::Vl53l0x { .. } => {
                "give all but one a pin for their XSHUT, xshut = 7".to_owned()
            }
            _ if allowed.iter().all(|range| range.start() == range.end()) => {
                "a bus has one of them".to_owned()
            }
            _ => format!("set another one by its jumpers, {ranges}"),
        };
        format!("{} has that address already: {remedy}", other.name)
    } else if fits(address) {
        return Some(address);
    } else if address > 0x7F && fits(address / 2) {
        format!(
            "is not within 7 bits: it is 0x{:02x} with the bit for reading and writing behind it; write 0x{0:02x}",
            address / 2
        )
    } else {
        format!("must be an address that it can have, {ranges}")
    };
    own.complain(kind.name(), line, &format!("0x{address:02x}"), &remedy);
    None
}
