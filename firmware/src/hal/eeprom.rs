//! The EEPROM, a byte at a time: a write takes 3.4 ms, for which nobody waits.

use super::registers::{eeprom, get, put};

/// Bytes of the ATmega2560's EEPROM.
pub const SIZE: u16 = 4_096;

/// A write is under way: neither read nor write.
pub fn is_busy() -> bool {
    get!(eeprom().eecr()) & 0b10 != 0
}

/// The byte at `address`; to be called when nothing is being written.
pub fn read(address: u16) -> u8 {
    put!(eeprom().eear(), address % SIZE);
    put!(eeprom().eecr(), 1);
    get!(eeprom().eedr())
}

/// Begins to write a byte; to be called when nothing is being written.
pub fn begin_write(address: u16, byte: u8) {
    put!(eeprom().eear(), address % SIZE);
    put!(eeprom().eedr(), byte);
    // The second write must follow the first within four cycles.
    avr_device::interrupt::free(|_| {
        put!(eeprom().eecr(), 0b100);
        put!(eeprom().eecr(), 0b110);
    });
}
