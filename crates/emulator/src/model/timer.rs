//! Where a timer's registers, vectors and pins are.

use super::pin::Pin;
use crate::registers;

/// Channels of a timer; the 8-bit ones have two.
pub(crate) const CHANNELS: usize = 3;

/// The flags as in TIFR.
pub(crate) const OVERFLOW: u8 = 0x01;
pub(crate) const MATCH: [u8; CHANNELS] = [0x02, 0x04, 0x08];
pub(crate) const CAPTURE: u8 = 0x20;

/// The timer with a prescaler of its own, which may have a clock of its own too.
pub(crate) const ASYNCHRONOUS: usize = 2;

/// Control register A of each.
const BASES: [u16; 6] = [
    registers::TCCR0A,
    registers::TCCR1A,
    registers::TCCR2A,
    registers::TCCR3A,
    registers::TCCR4A,
    registers::TCCR5A,
];

/// A register of a timer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Register {
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
    pub(crate) const fn busy(self) -> Option<u8> {
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
#[derive(Debug)]
pub(crate) struct Place {
    pub(crate) number: usize,
    /// 16 bits.
    pub(crate) wide: bool,
    pub(crate) channels: usize,
    /// Address of control register A.
    base: u16,
    flags: u16,
    enabled: u16,
    /// Flag and vector.
    pub(crate) vectors: [(u8, u8); 5],
    pub(crate) outputs: [Pin; CHANNELS],
    pub(crate) clock: Option<Pin>,
    pub(crate) capture: Option<Pin>,
}

impl Place {
    /// With a pin that may clock it, and one whose edges it captures.
    pub(crate) const fn with(mut self, clock: Pin, capture: Option<Pin>) -> Place {
        self.clock = Some(clock);
        self.capture = capture;
        self
    }

    /// The pins whose changes it acts upon.
    pub(crate) fn inputs(&self) -> impl Iterator<Item = Pin> + use<> {
        [self.clock, self.capture].into_iter().flatten()
    }

    /// The register at an address.
    pub(crate) fn register(&self, address: u16) -> Option<Register> {
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
                6 if self.number == ASYNCHRONOUS => Register::Asynchronous,
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
    pub(crate) fn flag(&self, vector: u8) -> Option<u8> {
        let found = self.vectors.iter().find(|(_, own)| *own == vector);
        found.map(|(flag, _)| *flag)
    }
}

/// A timer of 16 bits with three outputs and vectors in this order: capture, the matches, overflow.
pub(crate) const fn wide(number: usize, first_vector: u8, outputs: [Pin; 3]) -> Place {
    Place {
        number,
        wide: true,
        channels: 3,
        base: BASES[number],
        flags: registers::TIFR0 + number as u16,
        enabled: registers::TIMSK0 + number as u16,
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

/// The same with two outputs.
pub(crate) const fn wide_of_two(number: usize, first_vector: u8, [a, b]: [Pin; 2]) -> Place {
    let overflow = (OVERFLOW, first_vector + 3);
    Place {
        channels: 2,
        vectors: [
            (CAPTURE, first_vector),
            (MATCH[0], first_vector + 1),
            (MATCH[1], first_vector + 2),
            overflow,
            overflow,
        ],
        ..wide(number, first_vector, [a, b, b])
    }
}

/// A timer of 8 bits with two outputs and vectors in this order: the matches, overflow.
pub(crate) const fn narrow(number: usize, first_vector: u8, [a, b]: [Pin; 2]) -> Place {
    let overflow = (OVERFLOW, first_vector + 2);
    Place {
        wide: false,
        channels: 2,
        vectors: [
            (MATCH[0], first_vector),
            (MATCH[1], first_vector + 1),
            overflow,
            overflow,
            overflow,
        ],
        ..wide(number, first_vector, [a, b, b])
    }
}
