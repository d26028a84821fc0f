//! The Bluetooth module's receiver: what it decodes from a byte that the chip sends at some rate.
//!
//! The module receives at the link's baud rate. A sender within [`TOLERANCE`] is received correctly; at any other rate
//! the module samples the line at its own times, as any UART does, and passes on the result.

/// Largest error of the sender's rate with which the tenth bit is still sampled within itself.
const TOLERANCE: f64 = 0.045;

/// Whether what is sent at `baud` arrives as it was sent.
pub(super) fn understands(baud: f64, own_baud: f64) -> bool {
    (baud / own_baud - 1.0).abs() <= TOLERANCE
}

/// The byte received at `own_baud` when `byte` is sent at `baud`; `None` if the start bit is too short to be one.
pub(super) fn decode(byte: u8, baud: f64, own_baud: f64) -> Option<u8> {
    if understands(baud, own_baud) {
        return Some(byte);
    }
    let ratio = baud / own_baud;
    // The sender's line: start bit, data from the lowest, then idle.
    let level = |own_bits: f64| match (own_bits * ratio) as u64 {
        0 => false,
        bit @ 1..=8 => byte >> (bit - 1) & 1 != 0,
        _ => true,
    };
    if level(0.5) {
        return None;
    }
    let bits = (0..8).map(|bit| u8::from(level(f64::from(bit) + 1.5)) << bit);
    Some(bits.fold(0, |all, bit| all | bit))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sender_near_the_rate_is_understood_and_others_are_garbage() {
        // 9600 baud on an AVR is 9615.4.
        assert_eq!(decode(0x5A, 9_615.4, 9_600.0), Some(0x5A));
        assert_eq!(decode(0x5A, 115_200.0, 9_600.0), Some(0xFF));
        // Twice as fast: every second bit.
        assert_eq!(decode(0b0101_0101, 19_200.0, 9_600.0), None);
        assert_eq!(decode(0b1010_1010, 19_200.0, 9_600.0), Some(0b1111_1000));
        // Half as fast: each bit twice.
        assert_eq!(decode(0b0000_1101, 4_800.0, 9_600.0), Some(0b1110_0110));
    }
}
