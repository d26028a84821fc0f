//! Fuses and lock bits (2549Q, section 30).

/// What the fuses and lock bits are programmed to; zeros are programmed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fuses {
    /// Clock source, start-up time, CKDIV8 (bit 7).
    pub low: u8,
    /// BOOTRST (bit 0), BOOTSZ (bits 1 and 2), WDTON (bit 4), EESAVE, SPIEN, JTAGEN, OCDEN.
    pub high: u8,
    /// Brown-out detection.
    pub extended: u8,
    /// Lock bits.
    pub lock: u8,
}

impl Fuses {
    /// CKDIV8: the system clock starts with an eighth of the crystal's.
    pub(crate) const fn divides_clock(self) -> bool {
        self.low & 0x80 == 0
    }

    /// A reset leads to the boot section.
    pub const fn starts_in_boot(self) -> bool {
        self.high & 1 == 0
    }
}
