//! Numbers in few bits: saturating, never wrapping, with a special code for non-finite values.

use core::f32::consts::TAU;

use rumbo_control::math::{is_finite, round};

/// Code of a value that is not finite, in a field of 16 bits.
const NOT_FINITE_16: i16 = i16::MIN;

/// `value` in units of `1 / per_unit`, as 16 bits: saturates to +-32,767.
pub(crate) fn to_i16(value: f32, per_unit: f32) -> i16 {
    if !is_finite(value) {
        return NOT_FINITE_16;
    }
    limited(value * per_unit, 32_767)
}

/// Inverse of [`to_i16`]; NaN for the code of a non-finite value.
pub(crate) fn from_i16(code: i16, per_unit: f32) -> f32 {
    if code == NOT_FINITE_16 {
        f32::NAN
    } else {
        f32::from(code) / per_unit
    }
}

/// `value` as the nearest integer within +-`most`.
pub(crate) fn limited(value: f32, most: i16) -> i16 {
    match i16::try_from(round(value)) {
        Ok(code) if code > most => most,
        Ok(code) if code < -most => -most,
        Ok(code) => code,
        Err(_) if value < 0.0 => -most,
        Err(_) => most,
    }
}

/// Code of a value that is not finite, in a field of 12 bits.
const NOT_FINITE_12: i16 = -2_048;

/// `value` in units of `1 / per_unit`, as 12 bits: saturates to +-2,047.
pub(crate) fn to_i12(value: f32, per_unit: f32) -> u16 {
    let code = if is_finite(value) {
        limited(value * per_unit, 2_047)
    } else {
        NOT_FINITE_12
    };
    code.cast_unsigned() & 0xFFF
}

/// Inverse of [`to_i12`], of the low 12 bits; NaN for the code of a non-finite value.
pub(crate) fn from_i12(code: u16, per_unit: f32) -> f32 {
    let signed = (code << 4).cast_signed() >> 4;
    if signed == NOT_FINITE_12 {
        f32::NAN
    } else {
        f32::from(signed) / per_unit
    }
}

/// A finite angle as a fraction of a turn, 2 pi / 65536. An angle wraps by its nature.
pub(crate) fn to_turn(angle_rad: f32) -> u16 {
    (round(angle_rad * (65_536.0 / TAU)) & 0xFFFF) as u16
}

/// Inverse of [`to_turn`], in (-pi, pi].
pub(crate) fn from_turn(code: u16) -> f32 {
    const HALF_TURN: u16 = 0x8000;
    if code == HALF_TURN {
        core::f32::consts::PI
    } else {
        f32::from(code.cast_signed()) * (TAU / 65_536.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_code_never_wraps(value: f32) {
            let sixteen = from_i16(to_i16(value, 1000.0), 1000.0);
            let twelve = from_i12(to_i12(value, 50.0), 50.0);
            for (back, largest, step) in [(sixteen, 32.767, 0.001), (twelve, 40.94, 0.02)] {
                if value.is_finite() {
                    let wanted = value.clamp(-largest, largest);
                    prop_assert!((back - wanted).abs() <= step * 0.501, "{} came back as {}", value, back);
                } else {
                    prop_assert!(back.is_nan());
                }
            }
        }

        #[test]
        fn an_angle_comes_back_within_half_a_step(angle_rad in -core::f32::consts::PI..core::f32::consts::PI) {
            let back = from_turn(to_turn(angle_rad));
            let error = (back - angle_rad).abs();
            prop_assert!(error.min((TAU - error).abs()) <= TAU / 65_536.0 * 0.51);
        }
    }
}
