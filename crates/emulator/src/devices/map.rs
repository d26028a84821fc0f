//! Which peripheral a register belongs to, by its address in the data space (2549Q, section 33).

/// The peripheral behind an address.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Owner {
    Ports,
    External,
    Timer(usize),
    /// GTCCR, which concerns all timers.
    TimerPrescalers,
    Usart(usize),
    Eeprom,
    Analog,
    Watchdog,
    Power,
    Programming,
    Spi,
    Twi,
    System,
    /// Nothing, or nothing that is modelled.
    Nobody,
}

/// Whose register this is.
pub(super) const fn owner(address: u16) -> Owner {
    match address {
        0x20..=0x34 | 0x100..=0x10B => Owner::Ports,
        0x35..=0x3A => Owner::Timer((address - 0x35) as usize),
        0x3B..=0x3D | 0x68..=0x6A | 0x6B..=0x6D => Owner::External,
        0x3E | 0x4A | 0x4B | 0x51 | 0x53..=0x55 | 0x74 | 0x75 => Owner::System,
        0x3F..=0x42 => Owner::Eeprom,
        0x43 => Owner::TimerPrescalers,
        0x44..=0x48 => Owner::Timer(0),
        0x4C..=0x4E => Owner::Spi,
        0x50 | 0x78..=0x7F => Owner::Analog,
        0x57 => Owner::Programming,
        0x60 => Owner::Watchdog,
        0x61 | 0x64..=0x66 => Owner::Power,
        0x6E..=0x73 => Owner::Timer((address - 0x6E) as usize),
        0x80..=0x82 | 0x84..=0x8D => Owner::Timer(1),
        0x90..=0x92 | 0x94..=0x9D => Owner::Timer(3),
        0xA0..=0xA2 | 0xA4..=0xAD => Owner::Timer(4),
        0xB0..=0xB4 | 0xB6 => Owner::Timer(2),
        0xB8..=0xBD => Owner::Twi,
        0xC0..=0xC2 | 0xC4..=0xC6 => Owner::Usart(0),
        0xC8..=0xCA | 0xCC..=0xCE => Owner::Usart(1),
        0xD0..=0xD2 | 0xD4..=0xD6 => Owner::Usart(2),
        0x120..=0x122 | 0x124..=0x12D => Owner::Timer(5),
        0x130..=0x132 | 0x134..=0x136 => Owner::Usart(3),
        _ => Owner::Nobody,
    }
}

/// Registers of flags below 0x40, where SBI touches one bit alone.
pub(super) const fn is_flags(address: u16) -> bool {
    matches!(address, 0x35..=0x3C)
}
