//! The core's own mathematics: the same bits on every machine.
//!
//! Only `+ - * /` and a correctly rounded square root are used; the trigonometric functions are polynomials in
//! `f32` (coefficients: Cephes, S. Moshier). Within +-4 pi their error is below 1e-6. Conversions between floats and
//! integers go through the bits, since a bare `as` is not trusted on every target.

use core::f32::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};

/// 1.5 * 2^23: adding it to a float of magnitude below 2^22 rounds that float to the nearest integer, ties to even,
/// and leaves the integer in the low bits.
const ROUNDER: f32 = 12_582_912.0;
/// Bits of [`ROUNDER`].
const ROUNDER_BITS: i32 = 0x4B40_0000;
/// The bit of a float's sign.
const SIGN: u32 = 0x8000_0000;
/// Largest magnitude that [`ROUNDER`] rounds.
const ROUND_LIMIT: f32 = 4_194_303.0;

/// The larger of two finite numbers.
pub const fn max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// The smaller of two finite numbers.
pub const fn min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// `x` limited to `low..=high`.
pub const fn clamp(x: f32, low: f32, high: f32) -> f32 {
    if x < low {
        low
    } else if x > high {
        high
    } else {
        x
    }
}

/// Magnitude.
pub const fn abs(x: f32) -> f32 {
    // By its bits: of minus zero the sign stays, as it would with a comparison.
    if x.to_bits() > SIGN { -x } else { x }
}

/// Whether a number is finite: neither infinite nor NaN.
pub const fn is_finite(x: f32) -> bool {
    // By its exponent, in the upper half of its bits.
    const EXPONENT: u16 = 0x7F80;
    (x.to_bits() >> 16) as u16 & EXPONENT != EXPONENT
}

/// Square root, correctly rounded; 0 for anything that is not positive.
///
/// On the AVR that of its C library; elsewhere, since `core` has none, of more digits than a float has. No root of a float
/// lies nearer than 2^-51 of it to the middle between two floats, and there is one correct rounding: the bits are the same.
pub fn sqrt(x: f32) -> f32 {
    if x.is_nan() || x <= 0.0 {
        return 0.0;
    }
    if x.is_infinite() {
        return x;
    }
    positive_sqrt(x)
}

#[cfg(target_arch = "avr")]
fn positive_sqrt(x: f32) -> f32 {
    core::f32::math::sqrt(x)
}

#[cfg(not(target_arch = "avr"))]
fn positive_sqrt(x: f32) -> f32 {
    let x = f64::from(x);
    // Newton's steps for one over the root, from a thirtieth of it: 1e-3, 4e-6, 3e-11, and all but the last bits.
    let mut inverse = f64::from_bits(0x5FE6_EB50_C7B5_37A9 - (x.to_bits() >> 1));
    for _ in 0..4 {
        inverse *= 1.5 - 0.5 * x * inverse * inverse;
    }
    (x * inverse) as f32
}

/// The nearest integer, ties to even; saturates at +-4 194 303, and 0 for what is not a number.
pub const fn round(x: f32) -> i32 {
    if x.is_nan() {
        return 0;
    }
    from_rounder(limited(x) + ROUNDER)
}

/// `x` limited to what [`ROUNDER`] rounds; by its bits, which costs the AVR a twentieth of two comparisons.
const fn limited(x: f32) -> f32 {
    if x.to_bits() & !SIGN <= ROUND_LIMIT.to_bits() {
        x
    } else {
        clamp(x, -ROUND_LIMIT, ROUND_LIMIT)
    }
}

/// The integer in the low bits of a sum with [`ROUNDER`].
const fn from_rounder(sum: f32) -> i32 {
    sum.to_bits().cast_signed() - ROUNDER_BITS
}

/// An integer as a float, rounded once. Exact below 2^24.
pub fn from_u32(x: u32) -> f32 {
    let [a, b, c, d] = x.to_le_bytes();
    let (low, high) = (u16::from_le_bytes([a, b]), u16::from_le_bytes([c, d]));
    if high == 0 {
        return f32::from(low);
    }
    f32::from(high) * 65_536.0 + f32::from(low)
}

/// `x` less its nearest multiple of the period; exact to rounding for up to some thousand periods.
const fn reduce(x: f32, inverse: f32, parts: [f32; 2]) -> (f32, i32) {
    let scaled = x * inverse;
    let sum = limited(scaled) + ROUNDER;
    let turns = if scaled.is_nan() {
        0
    } else {
        from_rounder(sum)
    };
    let count = sum - ROUNDER;
    ((x - count * parts[0]) - count * parts[1], turns)
}

/// pi / 2 in two parts, the first one short enough that its products with integers below 8,192 are exact.
const HALF_PI: [f32; 2] = [1.570_312_5, 4.838_268e-4];
/// 2 pi in two parts.
const TWO_PI: [f32; 2] = [4.0 * HALF_PI[0], 4.0 * HALF_PI[1]];

/// An angle as its equal in (-pi, pi] [rad]; 0 for what is not finite.
pub fn wrap_angle(angle_rad: f32) -> f32 {
    // By its bits, as for `abs`: -pi alone is not in the range that its magnitude is in.
    let bits = angle_rad.to_bits();
    if bits <= PI.to_bits() || bits & !SIGN < PI.to_bits() {
        return angle_rad;
    }
    if !is_finite(angle_rad) {
        return 0.0;
    }
    let (wrapped, _) = reduce(angle_rad, 1.0 / TAU, TWO_PI);
    if wrapped <= -PI {
        wrapped + TAU
    } else {
        min(wrapped, PI)
    }
}

/// Sine and cosine of an angle [rad].
pub const fn sin_cos(angle_rad: f32) -> (f32, f32) {
    let (x, quadrant) = if angle_rad.to_bits() & !SIGN <= FRAC_PI_4.to_bits() {
        (angle_rad, 0)
    } else {
        reduce(angle_rad, 1.0 / FRAC_PI_2, HALF_PI)
    };
    let z = x * x;
    let sin = ((-1.951_529_6e-4 * z + 8.332_161e-3) * z - 1.666_665_5e-1) * z * x + x;
    let cos = ((2.443_315_7e-5 * z - 1.388_731_6e-3) * z + 4.166_664_6e-2) * z * z - 0.5 * z + 1.0;
    match quadrant & 3 {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

/// Largest angle of [`rotate`] [rad]: its series' truncation error is below 4e-8, half of the last bit of a cosine.
const ROTATE_RAD: f32 = 0.03;

/// Sine and cosine of an angle that differs from a known one by `by_rad`. `known` are sine and cosine of the known
/// angle, `angle_rad` is the new one. Takes a third of the time of [`sin_cos`] for a small difference; errors
/// accumulate, so [`sin_cos`] should replace it now and then.
pub fn rotate(known: (f32, f32), by_rad: f32, angle_rad: f32) -> (f32, f32) {
    if abs(by_rad) > ROTATE_RAD {
        return sin_cos(angle_rad);
    }
    let (sin, cos) = known;
    let square = by_rad * by_rad;
    let (by_sin, by_cos) = (by_rad - by_rad * square * (1.0 / 6.0), 1.0 - 0.5 * square);
    (sin * by_cos + cos * by_sin, cos * by_cos - sin * by_sin)
}

/// sin(x) / x, for the chord of an arc.
pub fn sinc(x_rad: f32) -> f32 {
    if abs(x_rad) < 0.01 {
        1.0 - x_rad * x_rad * (1.0 / 6.0)
    } else {
        sin_cos(x_rad).0 / x_rad
    }
}

/// Angle of the point (x, y) from the x axis, in (-pi, pi] [rad]; 0 for the origin.
pub fn atan2(y: f32, x: f32) -> f32 {
    let steep = abs(y) > abs(x);
    let (far, near) = if steep {
        (abs(y), abs(x))
    } else {
        (abs(x), abs(y))
    };
    if far <= 0.0 {
        return 0.0;
    }
    let mut angle = atan_of_fraction(near / far);
    if steep {
        angle = FRAC_PI_2 - angle;
    }
    if x < 0.0 {
        angle = PI - angle;
    }
    if y < 0.0 { -angle } else { angle }
}

/// Arc tangent of a number in 0..=1.
fn atan_of_fraction(x: f32) -> f32 {
    const TAN_PI_8: f32 = 0.414_213_57;
    let (x, offset) = if x > TAN_PI_8 {
        ((x - 1.0) / (x + 1.0), FRAC_PI_4)
    } else {
        (x, 0.0)
    };
    let z = x * x;
    let odd =
        (((8.053_744_5e-2 * z - 1.387_768_6e-1) * z + 1.997_771_1e-1) * z - 3.333_295e-1) * z * x
            + x;
    offset + odd
}

#[cfg(test)]
mod tests;
