//! Random numbers without state: each is a hash of (seed, robot, source, step).
//!
//! A draw depends on its key only, never on what was drawn before or on which thread asks, so a run repeats bit
//! for bit and a batch of robots may be simulated in any order. Keys of independent things must differ in `source`;
//! [`source`] lists who owns which. The mixer is the finaliser of SplitMix64 (Steele, Lea, Flood 2014), applied twice.

use libm::{log, sqrt};

/// Who owns which sources. A source is a base below plus an index within the owner's hundred.
pub mod source {
    /// Drivetrain: floor, slip, friction.
    pub const DRIVETRAIN: u32 = 100;
    /// Encoder: spacing of the poles.
    pub const ENCODER: u32 = 200;
    /// Sonar readings; each sonar takes a block of ten.
    pub const SONAR: u32 = 300;
    /// Serial link; each direction takes a block of ten.
    pub const LINK: u32 = 400;
    /// Random worlds.
    pub const WORLD: u32 = 500;
    /// Points of a sweep; one for each parameter that varies, at most 256.
    pub const SWEEP: u32 = 600;
    /// The spread of parameters from seed to seed; open upwards.
    pub const DRAW: u32 = 1000;
}

/// A keyed family of random numbers. Two values with the same seed and robot are the same family.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Noise {
    key: u64,
}

impl Noise {
    /// The family of one robot in the run of one seed.
    #[must_use]
    pub const fn new(seed: u64, robot: u32) -> Self {
        Self {
            key: mix(mix(seed.wrapping_add(0x9e37_79b9_7f4a_7c15))
                .wrapping_add((robot as u64).wrapping_mul(0xd1b5_4a32_d192_ed03))),
        }
    }

    /// 64 random bits.
    #[must_use]
    pub const fn bits(&self, source: u32, step: u64) -> u64 {
        let inner = mix(self
            .key
            .wrapping_add(step.wrapping_mul(0x9e37_79b9_7f4a_7c15)));
        mix(inner ^ (source as u64 + 1).wrapping_mul(0xa076_1d64_78bd_642f))
    }

    /// Uniform in [0, 1), in steps of 2^-53.
    #[must_use]
    pub fn uniform(&self, source: u32, step: u64) -> f64 {
        unit(self.bits(source, step))
    }

    /// True with the given probability (never for 0, always for 1). Inline: most probabilities are 0.
    #[must_use]
    #[inline]
    pub fn chance(&self, source: u32, step: u64, probability: f64) -> bool {
        probability > 0.0 && self.uniform(source, step) < probability
    }

    /// Standard normal: mean 0, standard deviation 1.
    #[must_use]
    pub fn normal(&self, source: u32, step: u64) -> f64 {
        normal_quantile(self.probability(source, step))
    }

    /// The probability whose quantile is [`Noise::normal`].
    pub(crate) fn probability(&self, source: u32, step: u64) -> f64 {
        // Half a step keeps it inside (0, 1): the largest value is about 8.2 standard deviations.
        unit(self.bits(source, step)) + 0.5 * TWO_POW_MINUS_53
    }
}

const TWO_POW_MINUS_53: f64 = 1.0 / (1_u64 << 53) as f64;

fn unit(bits: u64) -> f64 {
    (bits >> 11) as f64 * TWO_POW_MINUS_53
}

const fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// A numerator and a denominator, coefficients from the constant term up.
type Ratio = [[f64; 8]; 2];

/// AS 241, up to 0.425 from the middle, over 0.180625 less the square of that.
#[allow(clippy::excessive_precision)]
pub(crate) const CENTRE: Ratio = [
    [
        3.387_132_872_796_366_6,
        133.141_667_891_784_38,
        1_971.590_950_306_551_3,
        13_731.693_765_509_46,
        45_921.953_931_549_87,
        67_265.770_927_008_7,
        33_430.575_583_588_13,
        2_509.080_928_730_122_7,
    ],
    [
        1.0,
        42.313_330_701_600_91,
        687.187_007_492_057_91,
        5_394.196_021_424_751_1,
        21_213.794_301_586_597,
        39_307.895_800_092_71,
        28_729.085_735_721_943,
        5_226.495_278_852_545_5,
    ],
];

/// AS 241, for `r` up to 5, over `r` - 1.6.
#[allow(clippy::excessive_precision)]
pub(crate) const SIDE: Ratio = [
    [
        1.423_437_110_749_683_5,
        4.630_337_846_156_545_3,
        5.769_497_221_460_691,
        3.647_848_324_763_204_5,
        1.270_458_252_452_368_4,
        0.241_780_725_177_450_6,
        0.022_723_844_989_269_184,
        7.745_450_142_783_414e-4,
    ],
    [
        1.0,
        2.053_191_626_637_759,
        1.676_384_830_183_803_8,
        0.689_767_334_985_1,
        0.148_103_976_427_480_08,
        0.015_198_666_563_616_457,
        5.475_938_084_995_345e-4,
        1.050_750_071_644_416_9e-9,
    ],
];

/// AS 241, beyond, over `r` - 5.
#[allow(clippy::excessive_precision)]
pub(crate) const TAIL: Ratio = [
    [
        6.657_904_643_501_103_8,
        5.463_784_911_164_114_4,
        1.784_826_539_917_291_3,
        0.296_560_571_828_504_87,
        0.026_532_189_526_576_124,
        0.001_242_660_947_388_078_4,
        2.711_555_568_743_487_6e-5,
        2.010_334_399_292_288_1e-7,
    ],
    [
        1.0,
        0.599_832_206_555_887_94,
        0.136_929_880_922_735_8,
        0.014_875_361_290_850_615,
        7.868_691_311_456_132_6e-4,
        1.846_318_317_510_054_7e-5,
        1.421_511_758_316_446e-7,
        2.044_263_103_389_939_8e-15,
    ],
];

/// Quantile of the standard normal for `p` in (0, 1): algorithm AS 241 of Wichura (1988), relative error 1e-16.
pub(crate) fn normal_quantile(p: f64) -> f64 {
    let q = p - 0.5;
    if (-0.425..=0.425).contains(&q) {
        return q * ratio(0.180625 - q * q, &CENTRE);
    }
    let r = sqrt(-log(if q < 0.0 { p } else { 1.0 - p }));
    let magnitude = if r <= 5.0 {
        ratio(r - 1.6, &SIDE)
    } else {
        ratio(r - 5.0, &TAIL)
    };
    if q < 0.0 { -magnitude } else { magnitude }
}

fn ratio(x: f64, [numerator, denominator]: &Ratio) -> f64 {
    let horner = |c: &[f64; 8]| c.iter().rev().fold(0.0, |sum, c| sum * x + c);
    horner(numerator) / horner(denominator)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mean_and_sd(values: impl Iterator<Item = f64>) -> (f64, f64) {
        let (mut n, mut sum, mut squares) = (0.0, 0.0, 0.0);
        for v in values {
            n += 1.0;
            sum += v;
            squares += v * v;
        }
        let mean = sum / n;
        (mean, (squares / n - mean * mean).sqrt())
    }

    #[test]
    fn uniforms_fill_the_unit_interval_evenly() {
        let noise = Noise::new(1, 0);
        let (mean, sd) = mean_and_sd((0..100_000).map(|step| noise.uniform(7, step)));
        assert!((mean - 0.5).abs() < 0.004, "{mean}");
        assert!((sd - 1.0 / 12.0_f64.sqrt()).abs() < 0.004, "{sd}");
        assert!((0..100_000).all(|step| (0.0..1.0).contains(&noise.uniform(7, step))));
    }

    #[test]
    fn normals_have_mean_0_and_sd_1_and_the_right_tails() {
        let noise = Noise::new(2, 0);
        let (mean, sd) = mean_and_sd((0..200_000).map(|step| noise.normal(7, step)));
        assert!(mean.abs() < 0.01, "{mean}");
        assert!((sd - 1.0).abs() < 0.01, "{sd}");
        let beyond_2 = (0..200_000)
            .filter(|&step| noise.normal(7, step).abs() > 2.0)
            .count();
        assert!(
            (8_600..9_600).contains(&beyond_2),
            "4.55 % of 200,000 expected: {beyond_2}"
        );
    }

    #[test]
    fn the_quantile_matches_the_tables() {
        for (p, z) in [
            (0.5, 0.0),
            (0.975, 1.959_963_984_540_054),
            (0.001, -3.090_232_306_167_814),
            (1e-12, -7.034_483_825_301_131),
        ] {
            assert!((normal_quantile(p) - z).abs() < 1e-9, "{p}");
        }
    }

    #[test]
    fn seeds_robots_sources_and_steps_are_uncorrelated() {
        let pairs: [(Noise, u32, Noise, u32, u64); 4] = [
            (Noise::new(1, 0), 1, Noise::new(2, 0), 1, 0),
            (Noise::new(1, 0), 1, Noise::new(1, 1), 1, 0),
            (Noise::new(1, 0), 1, Noise::new(1, 0), 2, 0),
            (Noise::new(1, 0), 1, Noise::new(1, 0), 1, 1),
        ];
        for (a, source_a, b, source_b, shift) in pairs {
            let n = 50_000;
            let sum: f64 = (0..n)
                .map(|step| a.normal(source_a, step) * b.normal(source_b, step + shift))
                .sum();
            assert!(
                (sum / n as f64).abs() < 0.02,
                "correlation {}",
                sum / n as f64
            );
        }
    }

    #[test]
    fn the_bits_never_change() {
        // Recorded runs are repeated from their seed: a change here breaks every one of them.
        assert_eq!(Noise::new(1, 0).bits(0, 0), 10179854770463581852);
        assert_eq!(Noise::new(42, 3).bits(300, 17), 7219079295222708880);
    }
}
