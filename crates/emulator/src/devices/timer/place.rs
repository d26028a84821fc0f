//! Where each timer's registers, vectors and pins are (2549Q, sections 1, 14.1 and 33).

use super::wave::{CAPTURE, CHANNELS, MATCH, OVERFLOW};
use crate::devices::ports::Pin;

/// A register of a timer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Register {
    ControlA,
    ControlB,
    ControlC,
    Count,
    CountHigh,
    Capture,
    CaptureHigh,
    Compare(usize),
    CompareHigh(usize),
    Flags,
    Enabled,
    Asynchronous,
}

impl Register {
    /// The bit of ASSR that is set while a new value waits for the clock.
    pub(super) const fn busy(self) -> Option<u8> {
        match self {
            Register::Count => Some(0x10),
            Register::Compare(0) => Some(0x08),
            Register::Compare(_) => Some(0x04),
            Register::ControlA => Some(0x02),
            Register::ControlB => Some(0x01),
            _ => None,
        }
    }
}

/// The place of one timer.
pub(super) struct Place {
    /// Address of control register A.
    base: u16,
    wide: bool,
    pub(super) flags: u16,
    enabled: u16,
    /// Flag and vector.
    pub(super) vectors: [(u8, u8); 5],
    pub(super) outputs: [Pin; CHANNELS],
    pub(super) clock: Option<Pin>,
    pub(super) capture: Option<Pin>,
}

impl Place {
    /// The register at an address.
    pub(super) fn register(&self, address: u16) -> Option<Register> {
        if address == self.flags {
            return Some(Register::Flags);
        }
        if address == self.enabled {
            return Some(Register::Enabled);
        }
        let offset = address.checked_sub(self.base)?;
        if !self.wide {
            return Some(match offset {
                0 => Register::ControlA,
                1 => Register::ControlB,
                2 => Register::Count,
                3 => Register::Compare(0),
                4 => Register::Compare(1),
                6 if self.base == 0xB0 => Register::Asynchronous,
                _ => return None,
            });
        }
        Some(match offset {
            0 => Register::ControlA,
            1 => Register::ControlB,
            2 => Register::ControlC,
            4 => Register::Count,
            5 => Register::CountHigh,
            6 => Register::Capture,
            7 => Register::CaptureHigh,
            8 | 10 | 12 => Register::Compare(usize::from(offset - 8) / 2),
            9 | 11 | 13 => Register::CompareHigh(usize::from(offset - 9) / 2),
            _ => return None,
        })
    }

    /// The flag that has this vector.
    pub(super) fn flag(&self, vector: u8) -> Option<u8> {
        let found = self.vectors.iter().find(|(_, own)| *own == vector);
        found.map(|(flag, _)| *flag)
    }
}

/// A pin that exists, by the name of the table.
const fn pin(letter: char, bit: u8) -> Pin {
    match Pin::new(letter, bit) {
        Some(pin) => pin,
        None => Pin::at(0, 0),
    }
}

const fn wide(base: u16, number: u16, first_vector: u8, outputs: [Pin; 3]) -> Place {
    Place {
        base,
        wide: true,
        flags: 0x35 + number,
        enabled: 0x6E + number,
        vectors: [
            (CAPTURE, first_vector),
            (MATCH[0], first_vector + 1),
            (MATCH[1], first_vector + 2),
            (MATCH[2], first_vector + 3),
            (OVERFLOW, first_vector + 4),
        ],
        outputs,
        clock: None,
        capture: None,
    }
}

const fn narrow(base: u16, number: u16, first_vector: u8, outputs: [Pin; 2]) -> Place {
    let [a, b] = outputs;
    let overflow = (OVERFLOW, first_vector + 2);
    Place {
        base,
        wide: false,
        flags: 0x35 + number,
        enabled: 0x6E + number,
        vectors: [
            (MATCH[0], first_vector),
            (MATCH[1], first_vector + 1),
            overflow,
            overflow,
            overflow,
        ],
        outputs: [a, b, b],
        clock: None,
        capture: None,
    }
}

/// The six timers.
pub(super) static PLACES: [Place; 6] = [
    Place {
        clock: Some(pin('D', 7)),
        ..narrow(0x44, 0, 21, [pin('B', 7), pin('G', 5)])
    },
    Place {
        clock: Some(pin('D', 6)),
        capture: Some(pin('D', 4)),
        ..wide(0x80, 1, 16, [pin('B', 5), pin('B', 6), pin('B', 7)])
    },
    narrow(0xB0, 2, 13, [pin('B', 4), pin('H', 6)]),
    Place {
        clock: Some(pin('E', 6)),
        capture: Some(pin('E', 7)),
        ..wide(0x90, 3, 31, [pin('E', 3), pin('E', 4), pin('E', 5)])
    },
    Place {
        clock: Some(pin('H', 7)),
        capture: Some(pin('L', 0)),
        ..wide(0xA0, 4, 41, [pin('H', 3), pin('H', 4), pin('H', 5)])
    },
    Place {
        clock: Some(pin('L', 2)),
        capture: Some(pin('L', 1)),
        ..wide(0x120, 5, 46, [pin('L', 3), pin('L', 4), pin('L', 5)])
    },
];
