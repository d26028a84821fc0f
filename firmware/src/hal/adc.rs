//! The converter: one conversion a tick, begun at a tick and read at the next one; nothing waits for it.

use super::registers::{converter, get, put};
use super::shared::Byte;

/// On, begin, clock / 128: a conversion takes 0.1 ms.
const BEGIN: u8 = 0b1100_0111;
/// Reference is the supply of 5 V.
const SUPPLY: u8 = 0b0100_0000;
const NONE: u8 = 0xFF;

/// The input of the conversion in progress.
static INPUT: Byte = Byte::new(NONE);

/// Result of the conversion of analogue input `input` (0..=15) begun by the last call, 0..=1023; begins the next one.
/// `None` if that one was of another input, or there was none.
pub fn sample(input: u8) -> Option<u16> {
    let last = (INPUT.get() == input).then(|| get!(converter().adc));
    INPUT.set(input);
    put!(converter().admux, SUPPLY | input & 7);
    put!(converter().adcsrb, input & 8);
    put!(converter().adcsra, BEGIN);
    last
}
