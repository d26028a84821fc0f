//! All memories in one space of addresses, as the toolchain and debuggers number them: flash from 0, the data space from
//! 0x800000, the EEPROM from 0x810000, the signature at 0x840000.

use crate::chip::Chip;

/// The data space: registers, peripherals, SRAM.
pub const DATA: u32 = 0x80_0000;
/// The EEPROM.
pub const EEPROM: u32 = 0x81_0000;
/// The signature.
pub const SIGNATURE: u32 = 0x84_0000;

/// A byte of one of the memories.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// Of the flash.
    Flash(usize),
    /// Of the data space.
    Data(usize),
    /// Of the EEPROM.
    Eeprom(usize),
    /// Of the signature.
    Signature(usize),
}

impl Chip {
    /// The memory at an address, and where in it; `None` if there is none.
    pub fn place(&self, address: u32) -> Option<Place> {
        let model = self.model();
        let within = |start: u32, bytes: usize| {
            let at = address.checked_sub(start)? as usize;
            (at < bytes).then_some(at)
        };
        let flash = within(0, model.flash_bytes()).map(Place::Flash);
        flash
            .or_else(|| within(DATA, usize::from(model.ram_end) + 1).map(Place::Data))
            .or_else(|| within(EEPROM, model.eeprom_bytes).map(Place::Eeprom))
            .or_else(|| within(SIGNATURE, model.signature.len()).map(Place::Signature))
    }

    /// The byte at an address, read without effect on a peripheral; `None` if there is none.
    pub fn read_space(&self, address: u32) -> Option<u8> {
        match self.place(address)? {
            Place::Flash(at) => self.cpu().flash().get(at).copied(),
            Place::Data(at) => Some(self.read_data(at as u16)),
            Place::Eeprom(at) => self.devices().eeprom().get(at).copied(),
            Place::Signature(at) => self.model().signature.get(at).copied(),
        }
    }

    /// Writes a byte; returns whether there is something to write to.
    pub fn write_space(&mut self, address: u32, value: u8) -> bool {
        match self.place(address) {
            Some(Place::Data(at)) => self.write_data(at as u16, value),
            Some(Place::Eeprom(at)) => self.devices_mut().eeprom_mut()[at] = value,
            Some(Place::Flash(at)) => {
                let flash = self.cpu().flash();
                let mut bytes = [flash[at & !1], flash[at | 1]];
                bytes[at & 1] = value;
                let word = (at / 2) as u32;
                self.cpu_mut().write_flash(word, u16::from_le_bytes(bytes));
            }
            Some(Place::Signature(_)) | None => return false,
        }
        true
    }
}
