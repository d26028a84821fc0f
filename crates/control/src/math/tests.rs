//! The polynomials against `f64`.

extern crate std;
use super::*;
use proptest::prelude::*;
use std::f64::consts;

/// Evenly spaced floats from `low` to `high`, and some that are not.
fn samples(low: f32, high: f32) -> impl Iterator<Item = f32> {
    (0..=400_000u32).map(move |i| low + (high - low) * (from_u32(i) / 400_000.0))
}

#[test]
fn the_square_root_is_rounded_as_the_machine_rounds_it() {
    let mut bits = 1u32;
    for _ in 0..1_000_000 {
        // Numbers of every magnitude, subnormal ones too: the low bits of a generator by Knuth.
        bits = bits.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let x = f32::from_bits(bits & 0x7FFF_FFFF);
        if x.is_finite() {
            assert_eq!(sqrt(x).to_bits(), x.sqrt().to_bits(), "{x}");
        }
    }
    // All fractions, with an even exponent and an odd one: the other exponents change neither root nor rounding.
    for bits in f32::to_bits(1.0)..f32::to_bits(4.0) {
        let x = f32::from_bits(bits);
        assert_eq!(sqrt(x).to_bits(), x.sqrt().to_bits(), "{x}");
    }
    for x in [0.0, -0.0, -1.0, f32::NAN] {
        assert_eq!(sqrt(x), 0.0);
    }
    assert_eq!(
        sqrt(f32::MIN_POSITIVE / 8.0),
        (f32::MIN_POSITIVE / 8.0).sqrt()
    );
    assert_eq!(sqrt(f32::INFINITY), f32::INFINITY);
}

#[test]
fn sine_and_cosine_err_by_less_than_a_millionth_over_four_pi() {
    for x in samples(-4.0 * PI, 4.0 * PI) {
        let (sin, cos) = sin_cos(x);
        let (true_sin, true_cos) = f64::from(x).sin_cos();
        assert!((f64::from(sin) - true_sin).abs() < 1e-6, "sin {x}");
        assert!((f64::from(cos) - true_cos).abs() < 1e-6, "cos {x}");
    }
}

#[test]
fn the_arc_tangent_errs_by_less_than_a_millionth_all_around() {
    for angle in samples(-PI, PI) {
        for radius in [1e-3, 1.0, 2.5e3] {
            let (y, x) = (angle.sin() * radius, angle.cos() * radius);
            let error = f64::from(atan2(y, x)) - f64::from(y).atan2(f64::from(x));
            assert!(
                error.abs() < 1e-6 || (error.abs() - consts::TAU).abs() < 1e-6,
                "atan2 {y} {x}"
            );
        }
    }
    assert_eq!(atan2(0.0, 0.0), 0.0);
    assert_eq!(atan2(0.0, -1.0), PI);
}

#[test]
fn sine_and_cosine_turned_on_by_small_angles_keep_to_the_angle_for_a_second() {
    for start in [-3.0f32, -0.7, 0.0, 1.57, 2.5] {
        for by in [-ROTATE_RAD, -0.011, 1e-4, 0.02, ROTATE_RAD, 0.04] {
            let (mut angle, mut known) = (start, sin_cos(start));
            for tick in 1..=100u32 {
                angle = wrap_angle(angle + by);
                known = rotate(known, by, angle);
                let (true_sin, true_cos) = f64::from(angle).sin_cos();
                // Rounding of the angle itself and of the two products, tick by tick.
                let most = 1e-6 + 3e-7 * f64::from(tick);
                assert!(
                    (f64::from(known.0) - true_sin).abs() < most,
                    "{start} {by} {tick}"
                );
                assert!(
                    (f64::from(known.1) - true_cos).abs() < most,
                    "{start} {by} {tick}"
                );
            }
        }
    }
}

#[test]
fn wrapped_angles_are_the_same_angle_within_one_turn() {
    for x in samples(-4.0 * PI, 4.0 * PI) {
        let wrapped = wrap_angle(x);
        assert!(wrapped > -PI && wrapped <= PI, "{x} -> {wrapped}");
        let turns = (f64::from(x) - f64::from(wrapped)) / consts::TAU;
        assert!(
            (turns - turns.round()).abs() * consts::TAU < 1e-6,
            "{x} -> {wrapped}"
        );
    }
    assert_eq!(wrap_angle(-PI), PI);
    assert_eq!(wrap_angle(f32::NAN), 0.0);
    assert_eq!(wrap_angle(f32::INFINITY), 0.0);
}

proptest! {
    #[test]
    fn rounding_agrees_with_the_platform(x in -4.0e6f32..4.0e6) {
        prop_assert_eq!(f64::from(round(x)), f64::from(x).round_ties_even());
    }

    #[test]
    fn rounding_saturates_and_never_fails(bits: u32) {
        let x = f32::from_bits(bits);
        prop_assert!(round(x).abs() <= 4_194_303);
    }

    #[test]
    fn integers_convert_as_the_platform_does(x: u32) {
        #[allow(clippy::cast_precision_loss, reason = "the platform's rounding is the reference")]
        let platform = x as f32;
        prop_assert_eq!(from_u32(x), platform);
    }
}
