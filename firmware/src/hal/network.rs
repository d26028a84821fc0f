//! The network of mode 9, behind the program in flash: beyond what 16 bits of address reach.

use core::arch::asm;
use rumbo_robot::NETWORK_AT;

/// Upper byte of its addresses, and where it begins below that.
const PAGE: u8 = (NETWORK_AT >> 16) as u8;
const START: u16 = (NETWORK_AT & 0xFFFF) as u16;

/// A byte of it.
pub fn read(at: u16) -> u8 {
    let byte;
    // SAFETY: reads flash, which has no side effects; nothing else here uses RAMPZ (at I/O address 0x3B), interrupts
    // included.
    unsafe {
        asm!(
            "out 0x3B, {page}",
            "elpm {byte}, Z",
            page = in(reg_upper) PAGE,
            byte = out(reg) byte,
            in("Z") START.wrapping_add(at),
            options(nostack, preserves_flags, readonly),
        );
    }
    byte
}
