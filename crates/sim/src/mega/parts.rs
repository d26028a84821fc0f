//! What a person works at the robot's pins: buttons, switches, potentiometers and remote controls.
//!
//! Lines `name=value`, of [`PARTS`](super::PARTS) as of a console, set them: 1 or `on` is pressed, closed or fully turned up, 0
//! or `off` the opposite; of a remote control the value is the key that is pressed. So they take the way of typed text: over the page, into logs,
//! and again from there.

use super::{CYCLES_PER_US, Mega};
use crate::remote::Remote;
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
            if kind == PartKind::Infrared {
                self.remotes.push((index, Remote::default()));
                self.receive_infrared(index, self.chip.cycle(), true);
            }
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
            let Some(index) = index else { continue };
            let value = value.trim();
            let mut remotes = self.remotes.iter_mut();
            if let Some((_, remote)) = remotes.find(|(of, _)| *of == index) {
                let key = parts[index].keys.iter().find(|(key, _)| *key == value);
                let now_us = (self.chip.cycle() - self.zero_cycle) / CYCLES_PER_US;
                key.into_iter()
                    .for_each(|(_, bits)| remote.press(*bits, now_us));
                continue;
            }
            let value = match value {
                "on" => Ok(1.0),
                "off" => Ok(0.0),
                value => value.parse::<f64>(),
            };
            if let Ok(value) = value {
                self.work(index, value.clamp(0.0, 1.0));
            }
        }
    }

    /// What the remote controls send within this time [us].
    pub(crate) fn send_infrared(&mut self, from_us: u64, to_us: u64) {
        for number in 0..self.remotes.len() {
            let (index, remote) = &mut self.remotes[number];
            let index = *index;
            for (cycle, level) in remote.send(from_us, to_us) {
                self.receive_infrared(index, self.zero_cycle + cycle, level);
            }
        }
    }

    /// The output of an infrared receiver has this level from a cycle on.
    fn receive_infrared(&mut self, index: usize, cycle: u64, level: bool) {
        let pin = self.firmware.parts()[index].pin;
        self.put(cycle, self.firmware.board().pin(pin), level);
    }

    fn work(&mut self, index: usize, value: f64) {
        self.worked[index] = value;
        let Part {
            kind,
            pin,
            resistor,
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
                let level = match value >= MIDDLE {
                    true => Some(resistor == Some(false)),
                    false => resistor,
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
