//! libm's sine and cosine and the quantile of the standard normal, with their bits.

use super::vector::{Bits, M, V, gather, splat};
use crate::noise::{self, CENTRE};
use fearless_simd::prelude::*;

/// The least number whose upper 32 bits are these: libm compares by them.
const fn high(word: u32) -> f64 {
    f64::from_bits((word as u64) << 32)
}

/// A quarter turn in two parts, as libm's `rem_pio2` has it.
const QUARTER: [f64; 2] = [1.570_796_326_734_125_6, 6.077_100_506_506_192e-11];
/// libm's `k_sin`.
const S: [f64; 6] = [
    -0.166_666_666_666_666_32,
    0.008_333_333_333_322_49,
    -0.000_198_412_698_298_579_5,
    2.755_731_370_707_006_8e-6,
    -2.505_076_025_340_686_3e-8,
    1.589_690_995_211_55e-10,
];
/// libm's `k_cos`.
const C: [f64; 6] = [
    0.041_666_666_666_666_6,
    -0.001_388_888_888_887_411,
    2.480_158_728_947_673e-5,
    -2.755_731_435_139_066_3e-7,
    2.087_572_321_298_175e-9,
    -1.135_964_755_778_819_5e-11,
];

/// Sine and cosine. Arguments beyond five eighths of a turn, and those so near a quarter or half turn that libm reduces them
/// more finely, go robot by robot.
#[inline(always)]
pub(super) fn sincos<W: Simd>(simd: W, x: V<W>) -> (V<W>, V<W>) {
    let (one, two) = (splat(simd, 1.0), splat(simd, 2.0));
    let size = x.abs();
    let eighth = size.simd_lt(splat(simd, high(0x3fe9_21fc)));
    let three_eighths = size.simd_lt(splat(simd, high(0x4002_d97d)));
    let size_quarters = eighth.select(splat(simd, 0.0), three_eighths.select(one, two));
    let quarters = size_quarters.copysign(x);
    let z = x - quarters * QUARTER[0];
    let y0 = z - quarters * QUARTER[1];
    let y1 = (z - y0) - quarters * QUARTER[1];

    let (sine, cosine) = (k_sin(simd, y0, y1, eighth), k_cos(simd, y0, y1));
    let (odd, half) = (size_quarters.simd_eq(one), size_quarters.simd_eq(two));
    let (s, c) = (odd.select(cosine, sine), odd.select(sine, cosine));
    let mut s = (half | quarters.simd_eq(-one)).select(-s, s);
    let mut c = (half | quarters.simd_eq(one)).select(-c, c);

    let rare = near(simd, size, 0x3ff9_21fb)
        | near(simd, size, 0x4009_21fb)
        | size.simd_ge(splat(simd, high(0x400f_6a7b)))
        // So small that libm gives the argument itself: -0 stays -0.
        | size.simd_lt(splat(simd, high(0x3e46_a09e)));
    for lane in Bits::of(rare) {
        (s[lane], c[lane]) = libm::sincos(x[lane]);
    }
    (s, c)
}

/// True where the upper 32 bits are these.
#[inline(always)]
fn near<W: Simd>(simd: W, size: V<W>, word: u32) -> M<W> {
    size.simd_ge(splat(simd, high(word))) & size.simd_lt(splat(simd, high(word + 1)))
}

/// `k_sin` of libm: with the second part of the argument, or without where `alone`.
#[inline(always)]
fn k_sin<W: Simd>(simd: W, x: V<W>, y: V<W>, alone: M<W>) -> V<W> {
    let z = x * x;
    let w = z * z;
    let r = (z * (z * S[3] + S[2]) + S[1]) + z * w * (z * S[5] + S[4]);
    let v = z * x;
    let half = splat(simd, 0.5);
    alone.select(
        x + v * (z * r + S[0]),
        x - ((z * (half * y - v * r) - y) - v * S[0]),
    )
}

/// `k_cos` of libm.
#[inline(always)]
fn k_cos<W: Simd>(simd: W, x: V<W>, y: V<W>) -> V<W> {
    let one = splat(simd, 1.0);
    let z = x * x;
    let w = z * z;
    let r = z * (z * (z * C[2] + C[1]) + C[0]) + w * w * (z * (z * C[5] + C[4]) + C[3]);
    let hz = z * 0.5;
    let w = one - hz;
    w + (((one - w) - hz) + (z * r - x * y))
}

/// [`noise::normal_quantile`]; far from the middle robot by robot.
#[inline(always)]
pub(super) fn normal_quantile<W: Simd>(simd: W, p: &[f64; 8]) -> [f64; 8] {
    let q = gather(simd, |lane| p[lane]) - 0.5;
    let x = splat(simd, 0.180_625) - q * q;
    let [numerator, denominator] = &CENTRE;
    let mut z = q * (horner(simd, x, numerator) / horner(simd, x, denominator));
    for lane in Bits::of(q.abs().simd_gt(splat(simd, 0.425))) {
        z[lane] = noise::normal_quantile(p[lane]);
    }
    z.into()
}

#[inline(always)]
fn horner<W: Simd>(simd: W, x: V<W>, c: &[f64; 8]) -> V<W> {
    let mut sum = splat(simd, c[7]);
    for i in [6, 5, 4, 3, 2, 1, 0] {
        sum = sum * x + c[i];
    }
    sum
}
