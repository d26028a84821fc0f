//! What a person works at the robot's pins: buttons, switches and potentiometers.
//!
//! Lines `name=value`, of [`PARTS`](super::PARTS) as of a console, set them: 1 is pressed, closed or fully turned up, 0 the
//! opposite. So they take the way of typed text: over the page, into logs, and again from there.

use super::Mega;
use crate::wiring::{Part, PartKind};
use rumbo_emulator::devices::Input;

/// The supply of a potentiometer [V].
const SUPPLY_V: f64 = 5.0;
/// Where a potentiometer stands at first.
const MIDDLE: f64 = 0.5;

impl Mega {
    /// Puts the parts where they are at first.
    pub(super) fn set_out_parts(&mut self) {
        let count = self.firmware.parts().len();
        for index in 0..count {
            let kind = self.firmware.parts()[index].kind;
            let value = if kind == PartKind::Potentiometer {
                MIDDLE
            } else {
                0.0
            };
            self.worked.push(value);
            self.work(index, value);
        }
    }

    /// What has been set, with each part.
    pub fn parts(&self) -> impl Iterator<Item = (&Part, f64)> {
        self.firmware
            .parts()
            .iter()
            .zip(self.worked.iter().copied())
    }

    /// Sets parts by lines `name=value`; what is none changes nothing.
    pub(super) fn work_parts(&mut self, text: &[u8]) {
        for line in String::from_utf8_lossy(text).lines() {
            let Some((name, value)) = line.split_once('=') else {
                continue;
            };
            let parts = self.firmware.parts();
            let index = parts
                .iter()
                .position(|part| part.name == name && part.kind.is_worked());
            if let (Some(index), Ok(value)) = (index, value.trim().parse::<f64>()) {
                self.work(index, value.clamp(0.0, 1.0));
            }
        }
    }

    fn work(&mut self, index: usize, value: f64) {
        self.worked[index] = value;
        let Part {
            kind,
            pin,
            to_supply,
            ..
        } = self.firmware.parts()[index];
        let cycle = self.chip.cycle();
        let board = self.firmware.board();
        match (kind, board.pin(pin)) {
            (PartKind::Potentiometer, _) => {
                let channel = pin.saturating_sub(board.first_analogue);
                let volts = value * SUPPLY_V;
                self.chip.input(cycle, Input::Volts { channel, volts });
            }
            (PartKind::Button | PartKind::Switch, Some(pin)) => {
                let level = match (value >= MIDDLE, to_supply) {
                    (true, to_supply) => Some(to_supply),
                    // Open: a resistor pulls it down, or the chip's own one up.
                    (false, true) => Some(false),
                    (false, false) => None,
                };
                if let Some(level) = level {
                    self.meters.set(cycle, pin, level);
                }
                self.chip.input(cycle, Input::Pin(pin, level));
            }
            _ => {}
        }
    }
}
