//! libm's sine and cosine and the quantile of the standard normal, with their bits.

use super::vector::{Bits, M, V, splat};
use crate::noise::{self, CENTRE, SIDE};
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

/// libm's `log`: the natural logarithm of 2 in two parts, and the coefficients.
const LN_2: [f64; 2] = [0.693_147_180_369_123_8, 1.908_214_929_270_587_7e-10];
const L: [f64; 7] = [
    0.666_666_666_666_673_5,
    0.399_999_999_994_094_2,
    0.285_714_287_436_623_9,
    0.222_221_984_321_497_84,
    0.181_835_721_616_180_5,
    0.153_138_376_992_093_73,
    0.147_981_986_051_165_86,
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

/// [`noise::normal_quantile`]; beyond one in 7e10 robot by robot.
#[inline(always)]
pub(super) fn normal_quantile<W: Simd>(simd: W, p: V<W>) -> V<W> {
    let q = p - 0.5;
    let mut z = q * ratio(simd, splat(simd, 0.180_625) - q * q, &CENTRE);
    let beside = q.abs().simd_gt(splat(simd, 0.425));
    if !Bits::of(beside).none() {
        let below = q.simd_lt(splat(simd, 0.0));
        let r = (-log(simd, below.select(p, splat(simd, 1.0) - p))).sqrt();
        let size = ratio(simd, r - 1.6, &SIDE);
        z = beside.select(below.select(-size, size), z);
        for lane in Bits(Bits::of(beside).0 & !Bits::of(r.simd_le(splat(simd, 5.0))).0) {
            z[lane] = noise::normal_quantile(p[lane]);
        }
    }
    z
}

/// libm's logarithm of a normal number below 1.
#[inline(always)]
fn log<W: Simd>(simd: W, x: V<W>) -> V<W> {
    /// What centres the fraction on 1, in the bits of the exponent: libm's 0x3ff00000 - 0x3fe6a09e.
    const CENTRED: u64 = 0x0009_5f62 << 32;
    /// 2^52, whose lowest bits count units.
    const UNITS: f64 = 4_503_599_627_370_496.0;
    let bits = x.to_bits() + CENTRED;
    let k = V::from_bits((bits >> 52) | UNITS.to_bits()) - UNITS - 1_023.0;
    let f = V::from_bits((bits & 0x000f_ffff_ffff_ffff) + (0x3fe6_a09e << 32)) - 1.0;
    let hfsq = f * 0.5 * f;
    let s = f / (splat(simd, 2.0) + f);
    let z = s * s;
    let w = z * z;
    let t1 = w * (w * (w * L[5] + L[3]) + L[1]);
    let t2 = z * (w * (w * (w * L[6] + L[4]) + L[2]) + L[0]);
    let r = t2 + t1;
    s * (hfsq + r) + k * LN_2[1] - hfsq + f + k * LN_2[0]
}

#[inline(always)]
fn ratio<W: Simd>(simd: W, x: V<W>, [numerator, denominator]: &[[f64; 8]; 2]) -> V<W> {
    horner(simd, x, numerator) / horner(simd, x, denominator)
}

#[inline(always)]
fn horner<W: Simd>(simd: W, x: V<W>, c: &[f64; 8]) -> V<W> {
    let mut sum = splat(simd, c[7]);
    for i in [6, 5, 4, 3, 2, 1, 0] {
        sum = sum * x + c[i];
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::LANES;
    use crate::lanes::vector::gather;
    use fearless_simd::Level;

    /// Calls `with` with so many groups of uniform numbers.
    fn groups(count: u64, mut with: impl FnMut([f64; LANES])) {
        let noise = noise::Noise::new(3, 0);
        for step in 0..count {
            with(std::array::from_fn(|lane| noise.uniform(lane as u32, step)));
        }
    }

    fn bits(values: [f64; LANES]) -> [u64; LANES] {
        values.map(f64::to_bits)
    }

    #[test]
    fn sines_and_cosines_are_those_of_libm() {
        let Some(simd) = Level::new().as_avx2() else {
            return;
        };
        let check = |x: [f64; LANES]| {
            let (s, c) = sincos(simd, gather(simd, |lane| x[lane]));
            assert_eq!(bits(s.into()), bits(x.map(libm::sin)), "sin {x:?}");
            assert_eq!(bits(c.into()), bits(x.map(libm::cos)), "cos {x:?}");
        };
        groups(50_000, |u| check(u.map(|u| 9.0 * u - 4.5)));
        // Where libm goes another way, and on both sides of it.
        let places = [
            0x3fe9_21fc,
            0x3ff9_21fb,
            0x4002_d97d,
            0x4009_21fb,
            0x400f_6a7b,
        ];
        for place in places.map(high) {
            groups(2_000, |u| {
                check(u.map(|u| place * (1.0 + 1e-6 * (u - 0.5))))
            });
            groups(2_000, |u| {
                check(u.map(|u| -place * (1.0 + 1e-12 * (u - 0.5))))
            });
        }
        check([0.0, -0.0, 1e-9, -1e-9, 1e-300, 6.5, -100.0, 1e7]);
    }

    #[test]
    fn quantiles_are_those_of_one_by_one() {
        let Some(simd) = Level::new().as_avx2() else {
            return;
        };
        let check = |p: [f64; LANES]| {
            let z = normal_quantile(simd, gather(simd, |lane| p[lane]));
            let expected = p.map(noise::normal_quantile);
            assert_eq!(bits(z.into()), bits(expected), "{p:?}");
        };
        groups(50_000, &check);
        groups(10_000, |u| check(u.map(|u| 0.08 * u)));
        groups(10_000, |u| check(u.map(|u| 1.0 - 0.08 * u * u * u)));
        groups(10_000, |u| check(u.map(|u| libm::pow(u, 20.0) + 1e-16)));
        let half_a_step = 0.5_f64.powi(54);
        check([
            0.5,
            0.075,
            0.925,
            half_a_step,
            1e-11,
            1.4e-11,
            1.0 - half_a_step,
            0.0749,
        ]);
    }
}
