//! Random numbers of a seed, one after the other.

use rumbo_plant::noise::{Noise, source};

/// A sequence that depends on the seed alone, not on anything else that the seed draws.
pub(crate) struct Dice {
    noise: Noise,
    step: u64,
}

impl Dice {
    pub(crate) const fn new(seed: u64) -> Self {
        Self {
            noise: Noise::new(seed, 0),
            step: 0,
        }
    }

    /// Uniform between two values.
    pub(crate) fn within(&mut self, from: f64, to: f64) -> f64 {
        self.step += 1;
        from + (to - from) * self.noise.uniform(source::WORLD, self.step)
    }

    /// Uniform among the whole numbers from one to another, both included.
    pub(super) fn whole(&mut self, from: f64, to: f64) -> usize {
        self.within(from, to + 1.0).floor() as usize
    }

    /// True with a probability.
    pub(crate) fn chance(&mut self, probability: f64) -> bool {
        self.within(0.0, 1.0) < probability
    }

    /// Any direction [rad].
    pub(super) fn angle_rad(&mut self) -> f64 {
        self.within(-std::f64::consts::PI, std::f64::consts::PI)
    }
}
