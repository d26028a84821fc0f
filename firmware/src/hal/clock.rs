//! The clock: timer 1 at 2 MHz, never stopped, never set.
//!
//! Compare A is the tick: exactly 20,000 counts after the previous one, whatever delayed the handler.
//! Compare B, set by the tick, lies 6,000 counts (3 ms) later and writes the outputs; compare C, at the same instant and
//! so right after it, begins a ping, and ends it.

use super::registers::{get, handler, put, timer_1};
use super::shared::{Byte, CriticalSection, Word};
use super::{encoder, outputs, sonar};
use rumbo_control::{OUTPUT_DELAY_US, TICK_US};
use rumbo_robot::latch::{COUNTS_PER_US, Stamp};

/// Counts from tick to tick.
const TICK_COUNTS: u16 = (TICK_US * COUNTS_PER_US) as u16;
/// Counts from the tick to its outputs.
const OUTPUT_COUNTS: u16 = (OUTPUT_DELAY_US * COUNTS_PER_US) as u16;

/// The flag of compare C; written as 1 it is cleared.
const COMPARE_C: u8 = 1 << 3;

/// Ticks since the start, wrapping.
static TICKS: Byte = Byte::new(0);
/// The last tick's instant.
static TICK: Word = Word::new(0);

/// Now. Only for interrupt handlers: the timer's halves are read through a latch that the handlers share.
#[inline(always)]
pub(super) fn now(_: CriticalSection<'_>) -> u16 {
    get!(timer_1().tcnt1)
}

/// Makes compare C interrupt after `counts`, and not before: clears a pending interrupt.
#[inline(always)]
pub(super) fn trigger_again_in(counts: u16, section: CriticalSection<'_>) {
    put!(timer_1().ocr1c, now(section).wrapping_add(counts));
    put!(timer_1().tifr1, COMPARE_C);
}

/// Ticks so far, wrapping.
#[inline(always)]
pub fn ticks() -> u8 {
    TICKS.get()
}

/// The last tick: its number and its instant, read consistently.
pub fn last_tick() -> (u8, Stamp) {
    avr_device::interrupt::free(|section| (TICKS.get(), Stamp(TICK.get(section))))
}

/// Free running, clock / 8; compare A, B and C interrupt.
pub(super) fn start() {
    put!(timer_1().tccr1a, 0);
    put!(timer_1().ocr1a, TICK_COUNTS);
    put!(timer_1().ocr1b, OUTPUT_COUNTS);
    put!(timer_1().ocr1c, OUTPUT_COUNTS);
    put!(timer_1().timsk1, 0b1110);
    put!(timer_1().tccr1b, 0b010);
}

handler! { __vector_17, "TIMER1_COMPA", |section| {
    let tick = get!(timer_1().ocr1a);
    put!(timer_1().ocr1a, tick.wrapping_add(TICK_COUNTS));
    put!(timer_1().ocr1b, tick.wrapping_add(OUTPUT_COUNTS));
    put!(timer_1().ocr1c, tick.wrapping_add(OUTPUT_COUNTS));
    TICK.set(tick, section);
    encoder::latch();
    TICKS.set(TICKS.get().wrapping_add(1));
} }

handler! { __vector_18, "TIMER1_COMPB", |section| {
    outputs::apply(ticks(), section);
} }

handler! { __vector_19, "TIMER1_COMPC", |section| {
    sonar::trigger(section);
} }
