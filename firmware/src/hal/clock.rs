//! The clock: timer 1 at 2 MHz, never stopped, never set.
//!
//! Compare A is the tick: each one lies exactly 20,000 counts after the one before, whatever delayed the handler.
//! Compare B, set by the tick, lies 6,000 counts (3 ms) later and writes the outputs.

use core::sync::atomic::{AtomicU8, AtomicU16, Ordering::Relaxed};

use super::registers::{get, put, timer_1};
use super::{encoder, outputs, sonar};
use rumbo_control::{OUTPUT_DELAY_US, TICK_US};

/// Counts of timer 1 per microsecond.
const COUNTS_PER_US: u32 = 2;
/// Counts from tick to tick.
const TICK_COUNTS: u16 = (TICK_US * COUNTS_PER_US) as u16;
/// Counts from the tick to its outputs.
const OUTPUT_COUNTS: u16 = (OUTPUT_DELAY_US * COUNTS_PER_US) as u16;

/// A reading of timer 1 [0.5 us]; differences are right below 32.768 ms.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stamp(pub u16);

impl Stamp {
    /// Time from `earlier` to `self` [0.5 us].
    pub fn since(self, earlier: Stamp) -> u16 {
        self.0.wrapping_sub(earlier.0)
    }
}

/// A stamp that an interrupt writes.
#[derive(Debug)]
pub struct SharedStamp(AtomicU16);

impl SharedStamp {
    /// At zero.
    pub const fn new() -> Self {
        Self(AtomicU16::new(0))
    }

    /// Reads it whole.
    pub fn get(&self) -> Stamp {
        Stamp(self.0.load(Relaxed))
    }

    /// Writes it whole.
    pub fn set(&self, stamp: Stamp) {
        self.0.store(stamp.0, Relaxed);
    }
}

/// Ticks since the start, wrapping.
static TICKS: AtomicU8 = AtomicU8::new(0);
/// The last tick's instant.
static TICK: SharedStamp = SharedStamp::new();

/// Now. Only for interrupt handlers: the timer's halves are read through a latch that the handlers share.
#[inline(always)]
pub(super) fn now() -> Stamp {
    Stamp(get!(timer_1().tcnt1()))
}

/// Interrupts after `counts`, by compare C.
#[inline(always)]
pub(super) fn end_of_trigger_in(counts: u16) {
    put!(timer_1().ocr1c(), now().0.wrapping_add(counts));
    // Bit 3: an old match does not count.
    put!(timer_1().tifr1(), 1 << 3);
}

/// Ticks so far, wrapping.
pub fn ticks() -> u8 {
    TICKS.load(Relaxed)
}

/// The instant of the last tick.
pub fn tick_stamp() -> Stamp {
    TICK.get()
}

/// Free running, clock / 8; compare A, B and C interrupt.
pub(super) fn start() {
    put!(timer_1().tccr1a(), 0);
    put!(timer_1().ocr1a(), TICK_COUNTS);
    put!(timer_1().ocr1b(), OUTPUT_COUNTS);
    put!(timer_1().timsk1(), 0b1110);
    put!(timer_1().tccr1b(), 0b010);
}

#[avr_device::interrupt(atmega2560)]
fn TIMER1_COMPA() {
    let tick = get!(timer_1().ocr1a());
    put!(timer_1().ocr1a(), tick.wrapping_add(TICK_COUNTS));
    put!(timer_1().ocr1b(), tick.wrapping_add(OUTPUT_COUNTS));
    TICK.set(Stamp(tick));
    encoder::latch();
    outputs::tick();
    TICKS.store(TICKS.load(Relaxed).wrapping_add(1), Relaxed);
}

#[avr_device::interrupt(atmega2560)]
fn TIMER1_COMPB() {
    outputs::apply();
}

#[avr_device::interrupt(atmega2560)]
fn TIMER1_COMPC() {
    sonar::end_trigger();
}
