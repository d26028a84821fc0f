//! The external interrupts INT0 to INT7 and the pin change interrupts PCINT0 to PCINT23 (2549Q, section 15).
//!
//! A flag is raised by its edge whether it is enabled or not, and stays until its routine is entered or a one is written to
//! it. Low level is no flag: it requests as long as it lasts.

use super::interrupts::Interrupts;
use super::ports::{Pin, Ports};
use crate::model::{Model, PinChange};
use crate::registers::{EICRA, EICRB, EIFR, EIMSK, PCICR, PCIFR, PCMSK0, PCMSK1, PCMSK2};

/// State of the external interrupts.
#[derive(Clone, Debug, Default)]
pub(crate) struct External {
    model: &'static Model,
    flags: u8,
    enabled: u8,
    /// Two bits of sense for each.
    sense: u16,
    change_flags: u8,
    change_enabled: u8,
    change_masks: [u8; 3],
}

/// The vector of INT0.
const INT0: u8 = 1;

impl External {
    pub(crate) fn new(model: &'static Model) -> External {
        External {
            model,
            ..External::default()
        }
    }

    /// Whether this is one of its vectors.
    pub(crate) fn has_vector(&self, vector: u8) -> bool {
        (INT0..self.model.numbers.pin_change + 3).contains(&vector)
    }

    pub(crate) fn read(&self, address: u16) -> u8 {
        let [low, high] = self.sense.to_le_bytes();
        match address {
            EIFR => self.flags,
            EIMSK => self.enabled,
            EICRA => low,
            EICRB => high,
            PCIFR => self.change_flags,
            PCICR => self.change_enabled,
            PCMSK0 | PCMSK1 | PCMSK2 => self.change_masks[usize::from(address - PCMSK0)],
            _ => 0,
        }
    }

    pub(crate) fn write(&mut self, address: u16, value: u8) {
        let [low, high] = self.sense.to_le_bytes();
        match address {
            EIFR => self.flags &= !value,
            EIMSK => self.enabled = value & self.lines(),
            EICRA => self.sense = u16::from_le_bytes([value, high]),
            EICRB => self.sense = u16::from_le_bytes([low, value]),
            PCIFR => self.change_flags &= !value,
            PCICR => self.change_enabled = value & 7,
            PCMSK0 | PCMSK1 | PCMSK2 => self.change_masks[usize::from(address - PCMSK0)] = value,
            _ => {}
        }
    }

    fn sense(&self, number: usize) -> u16 {
        self.sense >> (2 * number) & 3
    }

    /// A bit for each line that there is.
    fn lines(&self) -> u8 {
        0xFF >> (8 - self.model.external.0.len())
    }

    /// Levels of a port have changed: those in `levels`, to what they are in `ports` now.
    /// Edges of a Mega's INT4 to INT7, and of all of an Uno's, are seen with the peripherals' clock only (15.1).
    pub(crate) fn changed(&mut self, port: usize, levels: u8, ports: &Ports, clocked: bool) {
        let (pins, clocked_from) = self.model.external;
        for (number, pin) in pins.iter().enumerate() {
            if pin.port() != port || levels & pin.mask() == 0 {
                continue;
            }
            let rose = ports.level(*pin);
            let meant = match self.sense(number) {
                0 => false,
                1 => true,
                2 => !rose,
                _ => rose,
            };
            if meant && (clocked || number < clocked_from) {
                self.flags |= 1 << number;
            }
        }
        for change in self
            .model
            .pin_changes
            .iter()
            .filter(|change| change.port == port)
        {
            let PinChange {
                pins, group, shift, ..
            } = *change;
            if (levels & pins) << shift & self.change_masks[group] != 0 {
                self.change_flags |= 1 << group;
            }
        }
    }

    /// Whether a change of this pin raises an interrupt.
    pub(crate) fn awaits(&self, pin: Pin) -> bool {
        self.model.pin_changes.iter().any(|change| {
            let mask = (pin.mask() & change.pins) << change.shift & self.change_masks[change.group];
            change.port == pin.port() && mask != 0 && self.change_enabled & 1 << change.group != 0
        })
    }

    /// The flag of INT0 is up.
    pub(crate) fn int0_flag(&self) -> bool {
        self.flags & 1 != 0
    }

    /// Its routine is entered.
    pub(crate) fn acknowledge(&mut self, number: u8) {
        match number.checked_sub(self.model.numbers.pin_change) {
            Some(group) => self.change_flags &= !(1 << group),
            None => self.flags &= !(1 << (number - INT0)),
        }
    }

    /// Tells which of the vectors are requested.
    pub(crate) fn request(&self, interrupts: &mut Interrupts, ports: &Ports) {
        let mut requested = self.enabled & self.flags;
        if self.enabled != requested {
            for (number, pin) in self.model.external.0.iter().enumerate() {
                let low = self.sense(number) == 0 && !ports.level(*pin);
                requested |= self.enabled & u8::from(low) << number;
            }
        }
        interrupts.set_all(INT0, self.lines(), requested);
        let requested = self.change_enabled & self.change_flags;
        interrupts.set_all(self.model.numbers.pin_change, 7, requested);
    }
}
