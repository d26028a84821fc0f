//! Which peripheral a register belongs to, by its address in the data space (2549Q, section 33).

use super::pin::{PORTS, register as port_register};
use crate::registers;

/// First address behind all registers of all models.
pub(crate) const REGISTERS_END: usize = 0x137;

/// The peripheral behind an address.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Owner {
    Ports,
    External,
    Timer(u8),
    /// GTCCR, which concerns all timers.
    TimerPrescalers,
    Usart(u8),
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

/// Whose register this is on a chip that has everything.
const fn owner(address: u16) -> Owner {
    match address {
        0x20..=0x34 | 0x100..=0x10B => Owner::Ports,
        0x35..=0x3A => Owner::Timer((address - 0x35) as u8),
        0x3B..=0x3D | 0x68..=0x6A | 0x6B..=0x6D => Owner::External,
        0x3E | 0x4A | 0x4B | 0x51 | 0x53..=0x55 | 0x74 | 0x75 => Owner::System,
        0x3F..=0x42 => Owner::Eeprom,
        registers::GTCCR => Owner::TimerPrescalers,
        0x44..=0x48 => Owner::Timer(0),
        0x4C..=0x4E => Owner::Spi,
        0x50 | 0x78..=0x7F => Owner::Analog,
        registers::SPMCSR => Owner::Programming,
        registers::WDTCSR => Owner::Watchdog,
        0x61 | 0x64..=0x66 => Owner::Power,
        0x6E..=0x73 => Owner::Timer((address - 0x6E) as u8),
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

/// Whose register each address is on a chip with these ports, timers and USARTs, and without some registers.
pub(crate) const fn owners(
    ports: &[u8; PORTS],
    timers: usize,
    usarts: usize,
    absent: &[u16],
) -> [Owner; REGISTERS_END] {
    let mut owners = [Owner::Nobody; REGISTERS_END];
    let mut address = 0;
    while address < REGISTERS_END as u16 {
        let present = match owner(address) {
            Owner::Ports => match port_register(address) {
                Some((port, _)) => ports[port] != 0,
                None => false,
            },
            Owner::Timer(number) => (number as usize) < timers,
            Owner::Usart(number) => (number as usize) < usarts,
            _ => true,
        };
        if present {
            owners[address as usize] = owner(address);
        }
        address += 1;
    }
    let mut at = 0;
    while at < absent.len() {
        owners[absent[at] as usize] = Owner::Nobody;
        at += 1;
    }
    owners
}

/// Registers of flags below 0x40, where SBI touches one bit alone.
pub(crate) const fn is_flags(address: u16) -> bool {
    matches!(address, 0x35..=0x3C)
}
