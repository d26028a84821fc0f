//! Disturbances that change along the way: the floor's friction, the wheels' slip.

use crate::noise::Noise;

/// A slowly changing quantity of mean 0 and standard deviation 1: straight lines between random knots, met as the
/// wheel goes on in either direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Wander {
    pub(crate) knot: u64,
    pub(crate) phase: f64,
    pub(crate) from: f64,
    pub(crate) to: f64,
}

/// The mean square of a line between two independent unit knots is 2/3.
pub(crate) const KNOT_SD: f64 = 1.224_744_871_391_589;

impl Wander {
    /// Starts at a random place.
    pub(super) fn start(noise: &Noise, source: u32) -> Self {
        let knot = |step| KNOT_SD * noise.normal(source, step);
        Self {
            knot: 2,
            phase: noise.uniform(source, 0),
            from: knot(1),
            to: knot(2),
        }
    }

    /// The value here.
    pub(super) fn value(&self) -> f64 {
        self.from + (self.to - self.from) * self.phase
    }

    /// Goes on by this many knots.
    pub(super) fn advance(&mut self, knots: f64, noise: &Noise, source: u32) {
        self.phase += knots;
        while self.phase >= 1.0 {
            self.phase -= 1.0;
            self.knot += 1;
            self.from = self.to;
            self.to = KNOT_SD * noise.normal(source, self.knot);
        }
    }
}
