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
pub(crate) enum TimerRegister {
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

impl TimerRegister {
    /// The bit of ASSR that is set while a new value waits for the clock.
    pub(crate) const fn busy(self) -> Option<u8> {
        match self {
            TimerRegister::Count => Some(0x10),
            TimerRegister::Compare(0) => Some(0x08),
            TimerRegister::Compare(_) => Some(0x04),
            TimerRegister::ControlA => Some(0x02),
            TimerRegister::ControlB => Some(0x01),
            _ => None,
        }
    }
}

/// The place of one timer.
#[derive(Debug)]
pub(crate) struct TimerInstance {
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

impl TimerInstance {
    /// With a pin that may clock it, and one whose edges it captures.
    pub(crate) const fn with(mut self, clock: Pin, capture: Option<Pin>) -> TimerInstance {
        self.clock = Some(clock);
        self.capture = capture;
        self
    }

    /// The pins whose changes it acts upon.
    pub(crate) fn inputs(&self) -> impl Iterator<Item = Pin> + use<> {
        [self.clock, self.capture].into_iter().flatten()
    }

    /// The register at an address.
    pub(crate) fn register(&self, address: u16) -> Option<TimerRegister> {
        if address == self.flags {
            return Some(TimerRegister::Flags);
        }
        if address == self.enabled {
            return Some(TimerRegister::Enabled);
        }
        let offset = address.checked_sub(self.base)?;
        if !self.wide {
            return Some(match offset {
                0 => TimerRegister::ControlA,
                1 => TimerRegister::ControlB,
                2 => TimerRegister::Count,
                3 => TimerRegister::Compare(0),
                4 => TimerRegister::Compare(1),
                6 if self.number == ASYNCHRONOUS => TimerRegister::Asynchronous,
                _ => return None,
            });
        }
        Some(match offset {
            0 => TimerRegister::ControlA,
            1 => TimerRegister::ControlB,
            2 => TimerRegister::ControlC,
            4 => TimerRegister::Count,
            5 => TimerRegister::CountHigh,
            6 => TimerRegister::Capture,
            7 => TimerRegister::CaptureHigh,
            8 | 10 | 12 => TimerRegister::Compare(usize::from(offset - 8) / 2),
            9 | 11 | 13 => TimerRegister::CompareHigh(usize::from(offset - 9) / 2),
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
pub(crate) const fn wide(number: usize, vector: u8, outputs: [Pin; 3]) -> TimerInstance {
    TimerInstance {
        number,
        wide: true,
        channels: 3,
        base: BASES[number],
        flags: registers::TIFR0 + number as u16,
        enabled: registers::TIMSK0 + number as u16,
        vectors: [
            (CAPTURE, vector),
            (MATCH[0], vector + 1),
            (MATCH[1], vector + 2),
            (MATCH[2], vector + 3),
            (OVERFLOW, vector + 4),
        ],
        outputs,
        clock: None,
        capture: None,
    }
}

/// The same with two outputs.
pub(crate) const fn wide_of_two(number: usize, vector: u8, [a, b]: [Pin; 2]) -> TimerInstance {
    let overflow = (OVERFLOW, vector + 3);
    TimerInstance {
        channels: 2,
        vectors: [
            (CAPTURE, vector),
            (MATCH[0], vector + 1),
            (MATCH[1], vector + 2),
            overflow,
            overflow,
        ],
        ..wide(number, vector, [a, b, b])
    }
}

/// A timer of 8 bits with two outputs and vectors in this order: the matches, overflow.
pub(crate) const fn narrow(number: usize, vector: u8, [a, b]: [Pin; 2]) -> TimerInstance {
    let overflow = (OVERFLOW, vector + 2);
    TimerInstance {
        wide: false,
        channels: 2,
        vectors: [
            (MATCH[0], vector),
            (MATCH[1], vector + 1),
            overflow,
            overflow,
            overflow,
        ],
        ..wide(number, vector, [a, b, b])
    }
}
