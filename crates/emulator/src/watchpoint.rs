//! What an access stops the program at.

use std::ops::Range;

/// Addresses of the data space, an access to which stops the program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Watchpoint {
    /// Which: registers from 0, peripherals from 0x20, SRAM from 0x200.
    pub addresses: Range<u16>,
    /// Reading one of them stops.
    pub reads: bool,
    /// Writing one of them stops.
    pub writes: bool,
}
