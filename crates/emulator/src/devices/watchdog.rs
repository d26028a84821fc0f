//! The watchdog: a timer on its own 128 kHz oscillator that interrupts, resets, or does one after the other (2549Q, section 12.4).
//!
//! What it does and how long it waits changes only within four cycles after WDCE was written together with WDE; WDE and WDIE
//! may be set at any time. After a reset by the watchdog WDRF keeps WDE set, with the shortest time, until a program clears WDRF.

use super::Core;
use super::schedule::Source;

const WDIF: u8 = 0x80;
const WDIE: u8 = 0x40;
const WDP3: u8 = 0x20;
const WDCE: u8 = 0x10;
const WDE: u8 = 0x08;
const WDP: u8 = 0x07;

/// Cycles for which WDCE permits.
const OPEN_CYCLES: u64 = 4;
/// Cycles of the crystal in one of the oscillator: 16 MHz over 128 kHz.
const TICK: u64 = 125;
/// Ticks of the shortest time.
const SHORTEST: u64 = 2048;

/// What is to be done when the time is over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum TimeOut {
    Interrupt,
    Reset,
}

/// The watchdog.
#[derive(Clone, Debug, Default)]
pub(super) struct Watchdog {
    /// WDIE, WDE and the prescaler's bits.
    control: u8,
    flag: bool,
    open_until: Option<u64>,
    /// The time when it last started from 0.
    started: u64,
}

impl Watchdog {
    /// After a reset, which may have been its own.
    pub(super) fn after_reset(by_itself: bool, time: u64) -> Watchdog {
        Watchdog {
            control: if by_itself { WDE } else { 0 },
            started: time,
            ..Watchdog::default()
        }
    }

    fn is_open(&self, cycle: u64) -> bool {
        self.open_until.is_some_and(|until| cycle <= until)
    }

    pub(super) fn read(&self, cycle: u64) -> u8 {
        let flag = if self.flag { WDIF } else { 0 };
        let open = if self.is_open(cycle) { WDCE } else { 0 };
        self.control | flag | open
    }

    /// Writes WDTCSR; `held` as long as WDRF holds WDE.
    pub(super) fn write(&mut self, core: &mut Core, value: u8, held: bool, cycle: u64) {
        let ran = self.runs();
        self.flag &= value & WDIF == 0;
        let before = self.control;
        self.control = if self.is_open(cycle) && value & WDCE == 0 {
            value & (WDIE | WDE | WDP3 | WDP)
        } else {
            value & (WDIE | WDE) | before & (WDE | WDP3 | WDP)
        };
        if held {
            self.control |= WDE;
        }
        if value & WDCE != 0 && value & WDE != 0 {
            self.open_until = Some(cycle + OPEN_CYCLES);
        } else if value & WDCE == 0 {
            self.open_until = None;
        }
        if !ran {
            self.started = core.clock.time(cycle);
        }
        self.reschedule(core, cycle);
    }

    fn runs(&self) -> bool {
        self.control & (WDE | WDIE) != 0
    }

    /// Time to its end: 16 ms at least, 8 s at most.
    fn period(&self) -> u64 {
        let select = self.control & WDP | (self.control & WDP3) >> 2;
        (SHORTEST << select.min(9)) * TICK
    }

    pub(super) fn reschedule(&self, core: &mut Core, cycle: u64) {
        let end = self.started + self.period();
        let due = core.clock.cycle(end).max(cycle + 1);
        let due = self.runs().then_some(due);
        core.schedule.set(Source::Watchdog, due);
        let requested = self.flag && self.control & WDIE != 0;
        core.interrupts.set(core.model.numbers.watchdog, requested);
    }

    /// WDR.
    pub(super) fn restart(&mut self, core: &mut Core, cycle: u64) {
        self.started = core.clock.time(cycle);
        self.reschedule(core, cycle);
    }

    /// Its time is over.
    pub(super) fn happen(&mut self, core: &mut Core, cycle: u64) -> TimeOut {
        self.started = core.clock.time(cycle);
        // An interrupt that was not entered in time counts as none.
        if self.control & WDIE == 0 || self.control & WDE != 0 && self.flag {
            return TimeOut::Reset;
        }
        self.flag = true;
        self.reschedule(core, cycle);
        TimeOut::Interrupt
    }

    /// Its routine is entered: with WDE set, the next time is a reset.
    pub(super) fn acknowledge(&mut self, core: &mut Core, cycle: u64) {
        self.flag = false;
        if self.control & WDE != 0 {
            self.control &= !WDIE;
        }
        self.reschedule(core, cycle);
    }
}
