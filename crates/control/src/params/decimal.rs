//! The numbers of the table of parameters, kept in two bytes each.

use crate::math::round;

/// A decimal number of few digits in two bytes: `mantissa * 8 + places` for `mantissa / 10^places`.
#[derive(Clone, Copy)]
pub(super) struct Decimal(i16);

impl Decimal {
    /// A number that has at most four digits, which is seen to when the table is compiled.
    pub(super) const fn of(value: f32) -> Self {
        let (mut places, mut power) = (0, 1.0);
        loop {
            let mantissa = round(value * power);
            if mantissa as f32 / power == value {
                assert!(mantissa.unsigned_abs() < 4_096, "too many digits");
                return Self(mantissa as i16 * 8 + places);
            }
            places += 1;
            power *= 10.0;
            assert!(places < 8, "too many decimals");
        }
    }

    /// The number, with the bits that it has in the source: both whole numbers are exact, and what divides them rounds once.
    pub(super) fn value(self) -> f32 {
        let mut power = 1.0;
        for _ in 0..self.0 & 7 {
            power *= 10.0;
        }
        f32::from(self.0 >> 3) / power
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_comes_back_with_the_bits_of_its_literal() {
        for literal in [0.0, 0.000_38, 0.0117, -0.3, 0.55, 343.4, 3_600.0] {
            assert_eq!(Decimal::of(literal).value().to_bits(), literal.to_bits());
        }
    }
}
