//! The tick: each 10 ms the encoders' counts are latched, and the main loop wakes.

use super::registers::handler;
use super::shared::{Byte, Word};
use super::{clock, encoder};
use rumbo_robot::latch::Stamp;

/// Ticks since the start, wrapping.
static TICKS: Byte = Byte::new(0);
/// The last tick's instant.
static TICK: Word = Word::new(0);

/// Ticks so far, wrapping.
#[inline(always)]
pub fn ticks() -> u8 {
    TICKS.get()
}

/// The last tick: its number and its instant, read consistently.
pub fn last_tick() -> (u8, Stamp) {
    avr_device::interrupt::free(|section| (TICKS.get(), Stamp(TICK.get(section))))
}

handler! { __vector_17, "TIMER1_COMPA", |section| {
    let tick = clock::tick();
    TICK.set(tick, section);
    encoder::latch();
    TICKS.set(TICKS.get().wrapping_add(1));
} }
