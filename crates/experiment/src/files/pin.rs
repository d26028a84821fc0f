//! Pins of a board in files: numbers, names such as `"A0"`, and levels that a jumper holds.

use super::read::{Allowed, Table};
use rumbo_sim::boards::Board;
use rumbo_sim::wiring::{Wiring, is_driver_input};

/// What a signal of a wiring is connected to.
pub(super) enum Wired {
    /// A pin of the board.
    Pin(u8),
    /// A level that it is held at.
    Held(bool),
}

/// The pin of a signal, by number or name, or the level that an input of the driver is held at.
pub(super) fn read_wired(
    table: &Table<'_, '_>,
    signal: &str,
    board: &Board,
    analogue: bool,
) -> Option<(usize, Wired)> {
    let last = board.last_pin();
    let placed = if table.is_text(signal) {
        let name = table.text(signal)?;
        let level = match (name.value.as_str(), is_driver_input(signal)) {
            ("high", true) => Some(true),
            ("low", true) => Some(false),
            _ => None,
        };
        if let Some(level) = level {
            return Some((name.line, Wired::Held(level)));
        }
        let Some(number) = board.numbered(&name.value) else {
            let held = match is_driver_input(signal) {
                true => ", or \"high\" or \"low\" where a jumper holds it",
                false => "",
            };
            let remedy = format!(
                "must be a pin of the {}, 0 to {}, such as 5 or \"A0\"{held}",
                board.title,
                board.shown(last)
            );
            table.complain(signal, name.line, &format!("{:?}", name.value), &remedy);
            return None;
        };
        (name.line, number)
    } else {
        let pin = table.placed_number(signal, Allowed::new(0.0, last.into(), "count"))?;
        (pin.line, pin.value as u8)
    };
    let (line, number) = placed;
    if board.pin(number).is_none() && !analogue {
        let remedy = format!(
            "is an analogue input only on the {}; take another pin",
            board.title
        );
        table.complain(signal, line, &board.shown(number), &remedy);
    }
    Some((line, Wired::Pin(number)))
}

/// A pin of the board, by number or name.
pub(super) fn read_pin(
    table: &Table<'_, '_>,
    key: &str,
    board: &Board,
    analogue: bool,
) -> Option<u8> {
    let (line, wired) = read_wired(table, key, board, analogue)?;
    match wired {
        Wired::Pin(number) if !analogue || number >= board.first_analogue => Some(number),
        Wired::Pin(number) => {
            let remedy = format!(
                "must be an analogue input of the {}, \"A0\" to \"{}\"",
                board.title,
                board.shown(board.last_analogue)
            );
            table.complain(key, line, &board.shown(number), &remedy);
            None
        }
        Wired::Held(_) => None,
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
