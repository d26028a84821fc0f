//! Where a USART's registers, vectors and pins are.

use super::pin::Pin;
use crate::registers;

/// A register of a USART.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum UsartRegister {
    StatusA,
    ControlB,
    ControlC,
    RateLow,
    RateHigh,
    Data,
}

/// The place of one USART.
#[derive(Debug)]
pub(crate) struct UsartInstance {
    pub(crate) number: usize,
    /// Address of UCSRA.
    base: u16,
    /// Vector of reception; those of the empty buffer and of the complete transmission follow.
    pub(crate) vector: u8,
    pub(crate) receive: Pin,
    pub(crate) transmit: Pin,
    /// XCK.
    pub(crate) clock: Pin,
}

/// UCSRA of each.
const BASES: [u16; 4] = [
    registers::UCSR0A,
    registers::UCSR1A,
    registers::UCSR2A,
    registers::UCSR3A,
];

impl UsartInstance {
    /// With the vector of reception, and the pins RXD, TXD and XCK.
    pub(crate) const fn new(number: usize, vector: u8, pins: [Pin; 3]) -> UsartInstance {
        let [receive, transmit, clock] = pins;
        UsartInstance {
            number,
            base: BASES[number],
            vector,
            receive,
            transmit,
            clock,
        }
    }

    /// The pins whose changes it acts upon.
    pub(crate) fn inputs(&self) -> [Pin; 2] {
        [self.receive, self.clock]
    }

    pub(crate) const fn register(&self, address: u16) -> Option<UsartRegister> {
        Some(match address.wrapping_sub(self.base) {
            0 => UsartRegister::StatusA,
            1 => UsartRegister::ControlB,
            2 => UsartRegister::ControlC,
            4 => UsartRegister::RateLow,
            5 => UsartRegister::RateHigh,
            6 => UsartRegister::Data,
            _ => return None,
        })
    }
}
