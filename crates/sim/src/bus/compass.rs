//! The field of the Earth as a chip on the robot measures it, with the errors of data sheets, not identified from recordings:
//! those of the QMC5883L (QST, 13-52-04) and of the HMC5883L (Honeywell, 900405).
//!
//! | what | is | source |
//! |---|---|---|
//! | field | 25 uT towards north, 40 uT down | a place at middle latitudes |
//! | noise | 0.2 uT, a reading | both, 2 mG |
//! | offset | up to 1 uT, drawn by the seed | QMC5883L, 10 mG |
//! | scale | up to 5 %, drawn by the seed | HMC5883L |
//!
//! Iron of the robot that turns with it adds what the robot file says; currents of its motors add nothing.

use crate::source;
use rumbo_plant::noise::Noise;

/// Noise sources of a sensor.
const SOURCES: u32 = 3;
/// The steps of the noise that draw offset and scale; measurements have their time.
const OFFSET: u64 = u64::MAX;
const SCALE: u64 = u64::MAX - 1;
const NORTHWARD_UT: f64 = 25.0;
const DOWNWARD_UT: f64 = 40.0;
const NOISE_UT: f64 = 0.2;
const OFFSETS_UT: f64 = 1.0;
const SCALES: f64 = 0.05;

/// The three bridges of a chip.
#[derive(Clone, Debug)]
pub(super) struct Compass {
    source: u32,
    /// Where x, y and z point: 1 forward, 2 left, 3 up; negative the opposite.
    axes: [i8; 3],
    /// What iron of the robot adds, forward and left \[uT\].
    iron_ut: [f64; 2],
    /// What it measured last, forward and left \[uT\].
    level_ut: Option<[f64; 2]>,
}

impl Compass {
    /// That of the sensor of this number.
    pub(super) fn new(number: u32, axes: [i8; 3], iron_ut: [f64; 2]) -> Self {
        Self {
            source: source::COMPASSES + SOURCES * number,
            axes,
            iron_ut,
            level_ut: None,
        }
    }

    /// A reading \[uT\], x, y and z, where north is so far to the left of ahead \[rad\]; `noisy` is the noise, 1 that of the data
    /// sheets.
    pub(super) fn measure(
        &mut self,
        north_rad: f64,
        now_us: u64,
        noise: &Noise,
        noisy: f64,
    ) -> [f64; 3] {
        let (sin, cos) = libm::sincos(north_rad);
        let [forward_ut, left_ut] = self.iron_ut;
        let field = [
            NORTHWARD_UT * cos + forward_ut,
            NORTHWARD_UT * sin + left_ut,
            -DOWNWARD_UT,
        ];
        let mut level = [0.0; 3];
        let mut measured = [0.0; 3];
        for (index, axis) in self.axes.into_iter().enumerate() {
            let source = self.source + index as u32;
            let drawn = |step, tolerated: f64| {
                tolerated * (noise.normal(source, step) / 3.0).clamp(-1.0, 1.0)
            };
            let (way, sign) = (
                usize::from(axis.unsigned_abs() - 1) % 3,
                f64::from(axis.signum()),
            );
            measured[index] = sign * field[way] * (1.0 + drawn(SCALE, SCALES))
                + drawn(OFFSET, OFFSETS_UT)
                + noisy * NOISE_UT * noise.normal(source, now_us);
            level[way] = sign * measured[index];
        }
        self.level_ut = Some([level[0], level[1]]);
        measured
    }

    /// Where it points by what it measured last, clockwise from magnetic north, up to a turn \[rad\]. Not a number before.
    pub(super) fn azimuth_rad(&self) -> f64 {
        self.level_ut.map_or(f64::NAN, |[forward, left]| {
            let azimuth = libm::atan2(left, forward);
            azimuth
                + if azimuth < 0.0 {
                    std::f64::consts::TAU
                } else {
                    0.0
                }
        })
    }
}
