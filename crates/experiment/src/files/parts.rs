//! The parts of a wiring: what a person works or looks at, at a pin, and the devices on the two-wire bus, at an address.
//!
//! ```toml
//! parts.start = { button = 8 }            # to GND; to = "gnd" or "5v": that, with a resistor to the other one
//! parts.mode = { switch = "A2" }
//! parts.speed = { potentiometer = "A0" }
//! parts.lamp = { led = 13 }               # or buzzer
//! parts.remote = { infrared = 11 }        # a remote control with arrows; with keys = 21 that of a car radio,
//!                                         # keys = "car" that with its arrows above the digits, "starter" of
//!                                         # starter kits, "mini" Adafruit's,
//!                                         # keys = { left = 0x20DF1BE4 } any other one, by IRremote's `value`s up to
//!                                         # version 2; raw_keys, by its `decodedRawData` from 3 on
//! parts.imu = { mpu6050 = 0x68 }          # with x_m and y_m where it is, interrupt = 2 for its INT, and where
//!                                         # its x, y and z point where not so: axes = "forward left up"
//! parts.screen = { ssd1306 = 0x3c }       # with size = "128x32"
//! parts.text = { hd44780 = 0x27 }         # with size = "20x4"
//! ```

use super::error::did_you_mean;
use super::pin::read_pin;
use super::read::{Allowed, Table};
use rumbo_sim::bus::{BusDevice, DeviceKind};
use rumbo_sim::remote::{self, ARROWS, CAR, Key, Known, MINI, RADIO, STARTER};
use rumbo_sim::wiring::{Part, PartKind, Wiring};

/// What is written as an address: one of 7 bits, or by mistake one of 8.
const ADDRESS: Allowed = Allowed::new(0.0, 255.0, "count");
/// What a key of a remote control sends, or its command.
const CODE: Allowed = Allowed::new(0.0, u32::MAX as f64, "count");
/// Position of a sensor on the body.
const MOUNT: Allowed = Allowed::new(-0.5, 0.5, "m");

/// Reads the table of parts into a wiring.
pub(super) fn read_parts(table: &Table<'_, '_>, wiring: &mut Wiring) {
    for key in table.keys() {
        let own = table.table(key.value);
        let parts = PartKind::ALL
            .into_iter()
            .filter(|kind| own.has(kind.name()));
        let parts: Vec<PartKind> = parts.collect();
        let devices = DeviceKind::ALL
            .into_iter()
            .filter(|kind| own.has(kind.name()));
        let devices: Vec<DeviceKind> = devices.collect();
        match (&parts[..], &devices[..]) {
            ([kind], []) => read_part(&own, key.value, *kind, wiring),
            ([], [kind]) => read_device(&own, key.value, *kind, wiring),
            _ => {
                let kinds = PartKind::ALL.map(PartKind::name).join(", ");
                let devices = DeviceKind::ALL.map(DeviceKind::name).join(", ");
                own.complain_here(&format!(
                    "needs one of {kinds}, with its pin, e.g. {} = {{ button = 8 }}, or one of {devices}, with its address",
                    key.value
                ));
            }
        }
    }
    table.finish();
}

fn read_part(own: &Table<'_, '_>, name: &str, kind: PartKind, wiring: &mut Wiring) {
    let analogue = kind == PartKind::Potentiometer;
    let pin = read_pin(own, kind.name(), wiring.board, analogue);
    let resistor = own.text("to").map(|to| {
        if !["gnd", "5v"].contains(&to.value.as_str())
            || !matches!(kind, PartKind::Button | PartKind::Switch)
        {
            own.complain(
                "to",
                to.line,
                &to.value,
                "must be \"gnd\" or \"5v\", of a button or a switch",
            );
        }
        to.value == "gnd"
    });
    let keys = read_keys(own, kind);
    own.finish();
    let Some(pin) = pin else { return };
    is_free(own, kind.name(), pin, wiring);
    wiring.parts.push(Part {
        name: name.to_owned(),
        kind,
        pin,
        resistor,
        keys,
    });
}

/// The keys of a remote control: those of one that is known, or each with its code.
fn read_keys(own: &Table<'_, '_>, kind: PartKind) -> Vec<Key> {
    if kind != PartKind::Infrared {
        return Vec::new();
    }
    for (table, order) in [
        ("keys", u32::reverse_bits as fn(u32) -> u32),
        ("raw_keys", |bits| bits),
    ] {
        if own.holds_table(table) {
            return read_codes(&own.table(table), order);
        }
    }
    remote::keys(read_known(own))
}

/// Keys with their codes; one below 256 is a command at address 0.
fn read_codes(codes: &Table<'_, '_>, order: fn(u32) -> u32) -> Vec<Key> {
    let read = codes.keys().into_iter().filter_map(|key| {
        let code = codes.placed_number(key.value, CODE)?.value as u32;
        let command = u8::try_from(code).map(|command| remote::bits(command.into()));
        Some((
            key.value.to_owned(),
            command.unwrap_or_else(|_| order(code)),
        ))
    });
    let read: Vec<Key> = read.collect();
    if codes.keys().is_empty() {
        codes.complain_here("needs a key, e.g. forward = 0xFF18E7");
    }
    codes.finish();
    read
}

/// A remote control that is known, by how many keys it has.
fn read_known(own: &Table<'_, '_>) -> &'static [Known] {
    if !own.has("keys") {
        return &ARROWS;
    }
    if own.is_text("keys") {
        return read_named_keys(own);
    }
    let Some(count) = own.placed_number("keys", Allowed::new(1.0, 99.0, "count")) else {
        return &ARROWS;
    };
    let remotes = [&ARROWS[..], &RADIO];
    let found = remotes
        .into_iter()
        .find(|keys| keys.len() == count.value as usize);
    found.unwrap_or_else(|| {
        let remedy = format!(
            "there is one with arrows, {} keys, and that of a car radio, {}; \"car\", its arrows above the digits; \"starter\"; \
             \"mini\"; and any other one by its codes, {{ forward = 0xFF18E7 }}",
            ARROWS.len(),
            RADIO.len()
        );
        own.complain("keys", count.line, &count.value.to_string(), &remedy);
        &ARROWS
    })
}

/// A remote control that has as many keys as another one.
fn read_named_keys(own: &Table<'_, '_>) -> &'static [Known] {
    match own.text("keys") {
        Some(name) if name.value == "mini" => &MINI,
        Some(name) if name.value == "starter" => &STARTER,
        Some(name) if name.value != "car" => {
            let remedy = "must be 17, 21, \"car\", \"starter\", \"mini\" or the codes of keys, { forward = 0xFF18E7 }";
            own.complain("keys", name.line, &format!("{:?}", name.value), remedy);
            &CAR
        }
        _ => &CAR,
    }
}

/// Reports a pin that something else is on.
pub(super) fn is_free(own: &Table<'_, '_>, key: &str, pin: u8, wiring: &Wiring) {
    if let Some(other) = wiring.owner_of(pin) {
        let remedy = format!("{other} is on that pin already: give each its own");
        let line = own.value(key).map_or(0, |(line, _)| line);
        own.complain(key, line, &wiring.board.shown(pin), &remedy);
    }
}

fn read_device(own: &Table<'_, '_>, name: &str, kind: DeviceKind, wiring: &mut Wiring) {
    let address = read_address(own, kind, wiring);
    let mut kind = kind;
    let sizes = kind.sizes();
    if !sizes.is_empty()
        && let Some(size) = own.word("size")
    {
        match sizes.iter().find(|(name, _)| *name == size.value) {
            Some((_, sized)) => kind = *sized,
            None => {
                let names: Vec<String> = sizes.iter().map(|(name, _)| (*name).to_owned()).collect();
                own.complain("size", size.line, &size.value, &did_you_mean(&names));
            }
        }
    }
    if let DeviceKind::Mpu6050 {
        at_m,
        axes,
        interrupt,
    } = &mut kind
    {
        *axes = read_axes(own).unwrap_or(*axes);
        *at_m = ["x_m", "y_m"].map(|key| own.number(key, MOUNT).unwrap_or(0.0));
        *interrupt = own
            .has("interrupt")
            .then(|| read_pin(own, "interrupt", wiring.board, false))
            .flatten();
        if let Some(pin) = *interrupt {
            is_free(own, "interrupt", pin, wiring);
        }
    }
    own.finish();
    let board = wiring.board;
    for (pin, line) in board.two_wire.into_iter().zip(["SDA", "SCL"]) {
        let owner = wiring.owner_of(pin).filter(|_| wiring.bus.is_empty());
        let owner = owner.filter(|_| !wiring.shield_pins().any(|own| own == pin));
        if let Some(other) = owner {
            own.complain_here(&format!(
                "{} is on the two-wire bus, and {other} on its pin {} ({line}): put {other} on another pin",
                kind.name(),
                board.shown(pin)
            ));
        }
    }
    if let Some(address) = address {
        wiring.bus.push(BusDevice {
            name: name.to_owned(),
            kind,
            address,
        });
    }
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
        .map(|range| format!("0x{:02x} to 0x{:02x}", range.start(), range.end()))
        .collect();
    let ranges = ranges.join(" or ");
    let taken = wiring.bus.iter().find(|other| other.address == address);
    let remedy = if let Some(other) = taken {
        format!(
            "{} has that address already: set another one by its jumpers, {ranges}",
            other.name
        )
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
