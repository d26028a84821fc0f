//! The servo on OC2B: a pulse of 544 to 2400 us every 20.48 ms, its edges made by timer 2 itself.
//!
//! Timer 2 counts 4 us and wraps every 1.024 ms, shorter than a pulse. So a compare that the pin follows is set up for
//! one edge at a time, by the handler of the half wrap (overflow at count 0, compare A at 128) that lies 64 counts or
//! more before the edge: late or not, the handler never moves an edge.
//!
//! The pulse starts at count 192 of wrap 0. With a length of 136 to 600 counts it ends 328 to 792 counts after that
//! wrap's start.

use super::registers::{change, handler, port_h, put, timer_2};
use super::shared::{Byte, CriticalSection, Word};
use crate::pins;
use core::f32::consts::FRAC_PI_2;
use rumbo_control::ServoAngle;
use rumbo_control::math::{clamp, round};

/// Counts of a pulse that points straight ahead: 1472 us, the middle of Arduino's 544 to 2400 us.
pub(super) const AHEAD_COUNTS: u16 = 1_472 / 4;
/// Half of the range: 90 degrees.
const QUARTER_COUNTS: f32 = (2_400.0 - 544.0) / 4.0 / 2.0;
/// Where the pulse starts, in counts from the start of wrap 0.
const START: u16 = 192;
/// Half wraps of a period: 40 * 0.512 ms.
const HALVES: u8 = 40;
/// Fast edges of the pin: OC2B is set (11) or cleared (10) at a match.
const SET: u8 = 0b0011_0000;
const CLEAR: u8 = 0b0010_0000;

/// Length of the next pulse.
static LENGTH: Word = Word::new(AHEAD_COUNTS);
/// Half wraps since the period began; overflows have even numbers, compares A odd ones.
static HALF: Byte = Byte::new(HALVES - 1);
/// The half wrap that sets the falling edge up.
static FALL_HALF: Byte = Byte::new(0);
/// The count at which the pulse falls.
static FALL_COUNT: Byte = Byte::new(0);

/// Pulse of an angle; positive is to the left, a longer pulse.
pub(super) fn counts(angle: ServoAngle) -> u16 {
    let quarter = clamp(angle.0, -FRAC_PI_2, FRAC_PI_2);
    let offset = round(quarter * (QUARTER_COUNTS / FRAC_PI_2));
    AHEAD_COUNTS.wrapping_add(offset.cast_unsigned() as u16)
}

/// From the next period on.
#[inline(always)]
pub(super) fn point(counts: u16, section: CriticalSection<'_>) {
    LENGTH.set(counts, section);
}

pub(super) fn start() {
    change!(port_h().ddrh, set pins::SERVO.mask(), clear 0);
    put!(timer_2().tccr2a, CLEAR);
    put!(timer_2().ocr2a, 128);
    // Overflow and compare A interrupt.
    put!(timer_2().timsk2, 0b011);
    // Clock / 64.
    put!(timer_2().tccr2b, 0b100);
}

/// Half a wrap of the timer has passed. `odd` is 1 for the second half; it is passed in rather than counted, since of
/// the interrupts pending when the program starts only the last of each kind is left.
#[inline(always)]
fn half(odd: u8, section: CriticalSection<'_>) {
    let half = (HALF.get() & !1) | odd;
    if half == 0 {
        put!(timer_2().ocr2b, (START % 256) as u8);
        put!(timer_2().tccr2a, SET);
        // The fall, in counts from the start of this wrap, is set up by the last half wrap 64 counts before it.
        let fall = START + LENGTH.get(section);
        FALL_HALF.set(((fall - 64) >> 7) as u8);
        FALL_COUNT.set((fall & 0xFF) as u8);
    } else if half == FALL_HALF.get() {
        put!(timer_2().ocr2b, FALL_COUNT.get());
        put!(timer_2().tccr2a, CLEAR);
    }
    HALF.set(if half + 1 == HALVES { 0 } else { half + 1 });
}

handler! { __vector_15, "TIMER2_OVF", |section| {
    half(0, section);
} }

handler! { __vector_13, "TIMER2_COMPA", |section| {
    half(1, section);
} }
