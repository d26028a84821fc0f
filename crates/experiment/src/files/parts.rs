//! The parts of a wiring: what a person works or looks at, at a pin, and the [devices](super::devices) on the two-wire bus.
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
//! ```

use super::devices::read_device;
use super::pin::{is_free, read_pin};
use super::read::{Allowed, Table};
use rumbo_sim::bus::DeviceKind;
use rumbo_sim::remote::{self, ARROWS, CAR, Key, Known, MINI, RADIO, STARTER};
use rumbo_sim::wiring::{Part, PartKind, Wiring};

/// What a key of a remote control sends, or its command.
const CODE: Allowed = Allowed::new(0.0, u32::MAX as f64, "count");
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
