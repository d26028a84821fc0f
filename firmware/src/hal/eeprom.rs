//! The EEPROM: a byte is read at once, and written while the program runs on (3.4 ms).

use super::registers::{eeprom, get, put};
use rumbo_robot::Cell;

/// Bits of EECR: read, begin a write, allow it.
const READ: u8 = 1 << 0;
const WRITE: u8 = 1 << 1;
const ALLOW: u8 = 1 << 2;

/// The last write is done.
pub fn is_ready() -> bool {
    get!(eeprom().eecr) & WRITE == 0
}

/// A byte, while [`is_ready`].
pub fn read(address: u16) -> u8 {
    put!(eeprom().eear, address);
    put!(eeprom().eecr, READ);
    get!(eeprom().eedr)
}

/// Begins to write a byte, while [`is_ready`]; an equal byte is not rewritten, since cells wear out.
pub fn write(cell: Cell) {
    if read(cell.address) == cell.value {
        return;
    }
    put!(eeprom().eedr, cell.value);
    // The write must begin within four cycles of being allowed.
    avr_device::interrupt::free(|_| {
        put!(eeprom().eecr, ALLOW);
        put!(eeprom().eecr, ALLOW | WRITE);
    });
}
