//! Which peripherals have a clock: sleep modes and power reduction; the oscillator's registers (2549Q, sections 10 and 11).
//!
//! When a clock stops, its peripheral freezes and resumes when the clock is back.

use super::system::Sleep;
use crate::registers::{CLKPR, OSCCAL, PRR0, PRR1};

/// Permits to change the system clock's prescaler, in CLKPR, for some cycles.
const CLKPCE: u8 = 0x80;
const OPEN_CYCLES: u64 = 4;
/// A plausible factory calibration.
const CALIBRATION: u8 = 0x8D;

/// Cycles of a crystal until it is trusted to have started, and until a running one is passed on (tables 10-4 and 11-2).
const START_CYCLES: u64 = 16 * 1024;
const STANDBY_CYCLES: u64 = 6;

/// Bits of PRR0 and PRR1.
const TIMERS: [(usize, u8); 6] = [(0, 5), (0, 3), (0, 6), (1, 3), (1, 4), (1, 5)];
const USARTS: [(usize, u8); 4] = [(0, 1), (1, 0), (1, 1), (1, 2)];
const ANALOG: (usize, u8) = (0, 0);
const SPI: (usize, u8) = (0, 2);
const TWI: (usize, u8) = (0, 7);

/// The state of the clocks.
#[derive(Clone, Debug)]
pub(super) struct Power {
    reduced: [u8; 2],
    asleep: Option<Sleep>,
    prescaler: u8,
    open_until: Option<u64>,
    calibration: u8,
}

impl Default for Power {
    fn default() -> Power {
        Power {
            reduced: [0; 2],
            asleep: None,
            prescaler: 0,
            open_until: None,
            calibration: CALIBRATION,
        }
    }
}

impl Power {
    pub(super) fn read(&self, address: u16, cycle: u64) -> u8 {
        match address {
            CLKPR if self.open_until.is_some_and(|until| cycle <= until) => self.prescaler | CLKPCE,
            CLKPR => self.prescaler,
            PRR0 => self.reduced[0],
            PRR1 => self.reduced[1],
            OSCCAL => self.calibration,
            _ => 0,
        }
    }

    pub(super) fn write(&mut self, address: u16, value: u8, cycle: u64) {
        match address {
            CLKPR if value == CLKPCE => self.open_until = Some(cycle + OPEN_CYCLES),
            CLKPR if self.open_until.is_some_and(|until| cycle <= until) && value & CLKPCE == 0 => {
                self.prescaler = value & 0x0F;
                self.open_until = None;
            }
            PRR0 => self.reduced[0] = value & 0xEF,
            PRR1 => self.reduced[1] = value & 0x3F,
            OSCCAL => self.calibration = value,
            _ => {}
        }
    }

    /// After a reset; CKDIV8 divides the clock by eight.
    pub(super) fn after_reset(divides: bool) -> Power {
        Power {
            prescaler: if divides { 3 } else { 0 },
            ..Power::default()
        }
    }

    /// Over what the system clock divides the crystal's; beyond 256 is reserved.
    pub(super) fn divisor(&self) -> u64 {
        1 << self.prescaler.min(8)
    }

    /// The CPU falls asleep.
    pub(super) fn sleep(&mut self, mode: Sleep) {
        self.asleep = Some(mode);
    }

    /// It wakes up; gives the crystal's cycles until the clocks run.
    pub(super) fn wake(&mut self) -> u64 {
        match self.asleep.take() {
            None | Some(Sleep::Idle | Sleep::QuietForAnalog) => 0,
            Some(Sleep::PowerDown | Sleep::PowerSave) => START_CYCLES,
            Some(Sleep::Standby | Sleep::ExtendedStandby) => STANDBY_CYCLES,
        }
    }

    /// The clock of the peripherals runs.
    pub(super) fn io_runs(&self) -> bool {
        matches!(self.asleep, None | Some(Sleep::Idle))
    }

    fn is_reduced(&self, (register, bit): (usize, u8)) -> bool {
        self.reduced[register % 2] >> bit & 1 != 0
    }

    pub(super) fn timer_runs(&self, index: usize) -> bool {
        self.io_runs() && !self.is_reduced(TIMERS[index % 6])
    }

    pub(super) fn usart_runs(&self, index: usize) -> bool {
        self.io_runs() && !self.is_reduced(USARTS[index % 4])
    }

    pub(super) fn spi_runs(&self) -> bool {
        self.io_runs() && !self.is_reduced(SPI)
    }

    pub(super) fn twi_runs(&self) -> bool {
        self.io_runs() && !self.is_reduced(TWI)
    }

    pub(super) fn analog_runs(&self) -> bool {
        (self.io_runs() || self.asleep == Some(Sleep::QuietForAnalog)) && !self.is_reduced(ANALOG)
    }
}
