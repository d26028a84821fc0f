//! The clock: timer 1 at 2 MHz, never stopped, never set.
//!
//! Compare A is the [tick](super::tick): exactly 20,000 counts after the previous one, whatever delayed the handler.
//! Compare B, set by the tick, lies 6,000 counts (3 ms) later and writes the [outputs](super::outputs); compare C, at the
//! same instant and so right after it, begins a [ping](super::sonar), and ends it.

use super::registers::{get, put, timer_1};
use super::shared::CriticalSection;
use rumbo_control::{OUTPUT_DELAY_US, TICK_US};
use rumbo_robot::latch::COUNTS_PER_US;

/// Counts from tick to tick.
const TICK_COUNTS: u16 = (TICK_US * COUNTS_PER_US) as u16;
/// Counts from the tick to its outputs.
const OUTPUT_COUNTS: u16 = (OUTPUT_DELAY_US * COUNTS_PER_US) as u16;

/// The flag of compare C; written as 1 it is cleared.
const COMPARE_C: u8 = 1 << 3;

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

/// Free running, clock / 8; compare A, B and C interrupt.
pub(super) fn start() {
    put!(timer_1().tccr1a, 0);
    put!(timer_1().ocr1a, TICK_COUNTS);
    put!(timer_1().ocr1b, OUTPUT_COUNTS);
    put!(timer_1().ocr1c, OUTPUT_COUNTS);
    put!(timer_1().timsk1, 0b1110);
    put!(timer_1().tccr1b, 0b010);
}

/// At a tick: its instant. Sets the next one and the outputs of this one.
#[inline(always)]
pub(super) fn tick() -> u16 {
    let tick = get!(timer_1().ocr1a);
    put!(timer_1().ocr1a, tick.wrapping_add(TICK_COUNTS));
    put!(timer_1().ocr1b, tick.wrapping_add(OUTPUT_COUNTS));
    put!(timer_1().ocr1c, tick.wrapping_add(OUTPUT_COUNTS));
    tick
}
