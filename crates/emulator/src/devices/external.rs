//! The external interrupts INT0 to INT7 and the pin change interrupts PCINT0 to PCINT23 (2549Q, section 15).
//!
//! A flag is raised by its edge whether it is enabled or not, and stays until its routine is entered or a one is written to
//! it. Low level is no flag: it requests as long as it lasts.

use super::interrupts::{Interrupts, vector};
use super::ports::{Pin, Ports};

pub(crate) const PCIFR: u16 = 0x3B;
pub(crate) const EIFR: u16 = 0x3C;
pub(crate) const EIMSK: u16 = 0x3D;
pub(crate) const PCICR: u16 = 0x68;
pub(crate) const EICRA: u16 = 0x69;
pub(crate) const EICRB: u16 = 0x6A;
pub(crate) const PCMSK0: u16 = 0x6B;
const PCMSK2: u16 = 0x6D;

const PORT_B: usize = 1;
const PORT_D: usize = 3;
const PORT_E: usize = 4;
const PORT_J: usize = 8;
const PORT_K: usize = 9;

/// State of the external interrupts.
#[derive(Clone, Debug, Default)]
pub(crate) struct External {
    flags: u8,
    enabled: u8,
    /// Two bits of sense for each.
    sense: u16,
    change_flags: u8,
    change_enabled: u8,
    change_masks: [u8; 3],
}

/// The pin of INT `number`.
fn pin(number: u8) -> Pin {
    let port = if number < 4 { PORT_D } else { PORT_E };
    Pin::at(port, number)
}

impl External {
    pub(crate) fn read(&self, address: u16) -> u8 {
        let [low, high] = self.sense.to_le_bytes();
        match address {
            EIFR => self.flags,
            EIMSK => self.enabled,
            EICRA => low,
            EICRB => high,
            PCIFR => self.change_flags,
            PCICR => self.change_enabled,
            PCMSK0..=PCMSK2 => self.change_masks[usize::from(address - PCMSK0)],
            _ => 0,
        }
    }

    pub(crate) fn write(&mut self, address: u16, value: u8) {
        let [low, high] = self.sense.to_le_bytes();
        match address {
            EIFR => self.flags &= !value,
            EIMSK => self.enabled = value,
            EICRA => self.sense = u16::from_le_bytes([value, high]),
            EICRB => self.sense = u16::from_le_bytes([low, value]),
            PCIFR => self.change_flags &= !value,
            PCICR => self.change_enabled = value & 7,
            PCMSK0..=PCMSK2 => self.change_masks[usize::from(address - PCMSK0)] = value,
            _ => {}
        }
    }

    fn sense(&self, number: u8) -> u16 {
        self.sense >> (2 * number) & 3
    }

    /// Levels of a port have changed: those in `levels`, to what they are in `ports` now.
    /// Edges of INT4 to INT7 are seen with the peripherals' clock only (section 15.1).
    pub(crate) fn changed(&mut self, port: usize, levels: u8, ports: &Ports, clocked: bool) {
        let numbers = match port {
            PORT_D => 0..4,
            PORT_E if clocked => 4..8,
            _ => 0..0,
        };
        for number in numbers {
            let mask = 1 << number;
            if levels & mask == 0 {
                continue;
            }
            let rose = ports.level(pin(number));
            let meant = match self.sense(number) {
                0 => false,
                1 => true,
                2 => !rose,
                _ => rose,
            };
            if meant {
                self.flags |= mask;
            }
        }
        let [first, second, third] = self.change_masks;
        let (group, hit) = match port {
            PORT_B => (0, levels & first),
            // PCINT8 is PE0, PCINT9 to 15 are PJ0 to PJ6.
            PORT_E => (1, levels & 1 & second),
            PORT_J => (1, levels << 1 & second),
            PORT_K => (2, levels & third),
            _ => return,
        };
        if hit != 0 {
            self.change_flags |= 1 << group;
        }
    }

    /// The flag of INT0 is up.
    pub(crate) fn int0_flag(&self) -> bool {
        self.flags & 1 != 0
    }

    /// Its routine is entered.
    pub(crate) fn acknowledge(&mut self, number: u8) {
        match number.checked_sub(vector::PCINT0) {
            Some(group) => self.change_flags &= !(1 << group),
            None => self.flags &= !(1 << (number - vector::INT0)),
        }
    }

    /// Tells which of the vectors are requested.
    pub(crate) fn request(&self, interrupts: &mut Interrupts, ports: &Ports) {
        for number in 0..8 {
            let mask = 1 << number;
            let low = self.sense(number) == 0 && !ports.level(pin(number));
            let requested = self.enabled & mask != 0 && (self.flags & mask != 0 || low);
            interrupts.set(vector::INT0 + number, requested);
        }
        for group in 0..3 {
            let requested = self.change_enabled & self.change_flags & (1 << group) != 0;
            interrupts.set(vector::PCINT0 + group, requested);
        }
    }
}
