//! Decimal numbers to and from text, small and without `core::fmt` or `core::num::dec2flt`: those cost tens of
//! kilobytes on the AVR, and the first misprints there.

use rumbo_control::math::{from_u32, is_finite, round};

/// Text being written into a fixed buffer. What does not fit is cut; the longest line does (tested in `text`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Text<const N: usize> {
    bytes: [u8; N],
    len: usize,
}

impl<const N: usize> Text<N> {
    pub(crate) const EMPTY: Self = Self {
        bytes: [0; N],
        len: 0,
    };

    pub(crate) fn bytes(&self) -> &[u8] {
        self.bytes.get(..self.len).unwrap_or(&self.bytes)
    }

    pub(crate) fn push(&mut self, byte: u8) {
        if let Some(slot) = self.bytes.get_mut(self.len) {
            *slot = byte;
            self.len += 1;
        }
    }

    /// An integer.
    pub(crate) fn push_integer(&mut self, value: i32) {
        self.push_decimal(value, 0);
    }

    /// A float with at most two decimals, trailing zeros left out; saturates to +-41943.03. `nan` where not finite.
    pub(crate) fn push_hundredths(&mut self, value: f32) {
        if is_finite(value) {
            self.push_decimal(round(value * 100.0), 2);
        } else {
            for byte in b"nan" {
                self.push(*byte);
            }
        }
    }

    /// `value / 10^decimals`, trailing zeros of its decimals left out.
    fn push_decimal(&mut self, value: i32, mut decimals: u8) {
        if value < 0 {
            self.push(b'-');
        }
        let mut rest = value.unsigned_abs();
        while decimals > 0 && rest.is_multiple_of(10) {
            rest /= 10;
            decimals -= 1;
        }
        // From the last digit on, up to one before the point.
        let mut digits = Text::<12>::EMPTY;
        let mut count = 0;
        while rest > 0 || count <= decimals {
            if count == decimals && count > 0 {
                digits.push(b'.');
            }
            digits.push(b'0' + (rest % 10) as u8);
            rest /= 10;
            count += 1;
        }
        for digit in digits.bytes().iter().rev() {
            self.push(*digit);
        }
    }
}

/// The number in `text`: sign, digits, point, exponent. `None` if it is anything else, or has more than 9 digits
/// before the point, or leaves the range of `f32`. Exact to one rounding for up to 7 digits and 10 decimals.
pub(crate) fn parse(text: &[u8]) -> Option<f32> {
    let (negative, unsigned) = split_sign(text);
    let mut rest = unsigned;
    let mut mantissa: u32 = 0;
    let mut exponent: i16 = 0;
    let mut digits = 0u16;
    let mut after_point = false;
    while let Some((byte, tail)) = rest.split_first() {
        match byte {
            b'0'..=b'9' => {
                digits = digits.saturating_add(1);
                if mantissa < 100_000_000 {
                    mantissa = mantissa * 10 + u32::from(byte - b'0');
                    exponent -= i16::from(after_point);
                } else if !after_point {
                    return None;
                }
            }
            b'.' if !after_point => after_point = true,
            b'e' | b'E' => break,
            _ => return None,
        }
        rest = tail;
    }
    if digits == 0 {
        return None;
    }
    if let Some((_, tail)) = rest.split_first() {
        exponent += parse_exponent(tail)?;
    }
    let value = scale(from_u32(mantissa), exponent);
    is_finite(value).then_some(if negative { -value } else { value })
}

fn split_sign(text: &[u8]) -> (bool, &[u8]) {
    match text.split_first() {
        Some((b'-', rest)) => (true, rest),
        Some((b'+', rest)) => (false, rest),
        _ => (false, text),
    }
}

/// An exponent of at most two digits.
fn parse_exponent(text: &[u8]) -> Option<i16> {
    let (negative, digits) = split_sign(text);
    if digits.is_empty() || digits.len() > 2 {
        return None;
    }
    let mut value = 0;
    for digit in digits {
        if !digit.is_ascii_digit() {
            return None;
        }
        value = value * 10 + i16::from(digit - b'0');
    }
    Some(if negative { -value } else { value })
}

/// `value * 10^exponent`, by powers of ten that `f32` holds exactly.
fn scale(value: f32, exponent: i16) -> f32 {
    let mut scaled = value;
    let mut left = exponent.unsigned_abs();
    while left > 0 {
        let step = left.min(10);
        let mut power = 1.0f32;
        for _ in 0..step {
            power *= 10.0;
        }
        if exponent < 0 {
            scaled /= power
        } else {
            scaled *= power
        }
        left -= step;
    }
    scaled
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use proptest::prelude::*;
    use std::string::String;

    fn hundredths(value: f32) -> String {
        let mut text = Text::<16>::EMPTY;
        text.push_hundredths(value);
        std::str::from_utf8(text.bytes()).unwrap().into()
    }

    /// What the standard library prints with two decimals, without its trailing zeros.
    fn trimmed(value: f32) -> String {
        let text = std::format!("{value:.2}");
        let text = text.trim_end_matches('0').trim_end_matches('.');
        if text == "-0" {
            "0".into()
        } else {
            text.into()
        }
    }

    proptest! {
        #[test]
        fn whole_hundredths_print_as_the_standard_library_prints_them(n in -4_000_000i32..4_000_000) {
            let value = n as f32 / 100.0;
            prop_assert_eq!(hundredths(value), trimmed(value));
        }

        #[test]
        fn a_printed_number_is_within_half_a_hundredth(value in -40_000.0f32..40_000.0) {
            let back: f64 = hundredths(value).parse().unwrap();
            prop_assert!((back - f64::from(value)).abs() <= 0.005 + f64::from(value.abs()) * 2e-7);
        }

        #[test]
        fn integers_print_as_the_standard_library_prints_them(value: i32) {
            let mut text = Text::<16>::EMPTY;
            text.push_integer(value);
            let theirs = std::format!("{value}");
            prop_assert_eq!(text.bytes(), theirs.as_bytes());
        }

        #[test]
        fn seven_digits_are_read_as_the_standard_library_reads_them(n in 0u32..9_999_999, decimals in 0usize..8) {
            let digits = std::format!("{n:08}");
            let (whole, part) = digits.split_at(8 - decimals);
            let text = std::format!("-{whole}.{part}");
            prop_assert_eq!(parse(text.as_bytes()), Some(text.parse().unwrap()));
        }

        #[test]
        fn what_is_read_is_what_was_meant(value in -1e8f32..1e8) {
            for text in [std::format!("{value}"), std::format!("{value:e}")] {
                let back = parse(text.as_bytes()).unwrap();
                prop_assert!((back - value).abs() <= value.abs() * 3e-7, "{} read as {}", text, back);
            }
        }

        #[test]
        fn any_text_is_a_number_or_none(text in "[-+0-9.eE ]{0,12}") {
            // At least as strict as the standard library.
            if let Some(value) = parse(text.as_bytes()) {
                let theirs: f32 = text.parse().unwrap();
                prop_assert!((value - theirs).abs() <= theirs.abs() * 1e-6 + 1e-37);
            }
        }
    }

    #[test]
    fn what_is_no_number_is_refused() {
        for text in [
            "",
            "-",
            ".",
            "1.2.3",
            "nan",
            "inf",
            "1e",
            "1e999",
            "1e99",
            "12345678901",
            "1 2",
            "0x10",
            "--1",
        ] {
            assert_eq!(parse(text.as_bytes()), None, "{text}");
        }
    }

    #[test]
    fn a_number_out_of_reach_saturates() {
        assert_eq!(hundredths(1e30), "41943.03");
        assert_eq!(hundredths(f32::NAN), "nan");
        assert_eq!(hundredths(-0.001), "0");
    }
}
