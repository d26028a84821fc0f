//! Where each USART's registers, vectors and pins are (2549Q, sections 1, 14.1 and 33).

use crate::devices::ports::Pin;

/// A register of a USART.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Register {
    StatusA,
    ControlB,
    ControlC,
    RateLow,
    RateHigh,
    Data,
}

/// The place of one USART.
pub(super) struct Place {
    /// Address of UCSRA.
    pub(super) base: u16,
    /// Vector of reception; those of the empty buffer and of the complete transmission follow.
    pub(super) vector: u8,
    pub(super) receive: Pin,
    pub(super) transmit: Pin,
    /// XCK.
    pub(super) clock: Pin,
}

impl Place {
    pub(super) const fn register(&self, address: u16) -> Option<Register> {
        Some(match address.wrapping_sub(self.base) {
            0 => Register::StatusA,
            1 => Register::ControlB,
            2 => Register::ControlC,
            4 => Register::RateLow,
            5 => Register::RateHigh,
            6 => Register::Data,
            _ => return None,
        })
    }
}

const fn place(base: u16, vector: u8, port: usize, bit: u8, clock: u8) -> Place {
    Place {
        base,
        vector,
        receive: Pin::at(port, bit),
        transmit: Pin::at(port, bit + 1),
        clock: Pin::at(port, clock),
    }
}

/// USART 0 on PE0 and PE1, 1 on PD2 and PD3, 2 on PH0 and PH1, 3 on PJ0 and PJ1; XCK on PE2, PD5, PH2 and PJ2.
pub(super) static PLACES: [Place; 4] = [
    place(0xC0, 25, 4, 0, 2),
    place(0xC8, 36, 3, 2, 5),
    place(0xD0, 51, 7, 0, 2),
    place(0x130, 54, 8, 0, 2),
];
