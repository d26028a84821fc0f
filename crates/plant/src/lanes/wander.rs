//! Floor and slip along the way, in lanes: see [`crate::drivetrain`].

use super::vector::{Bits, V, gather, splat};
use super::{LANES, Lane, math};
use crate::drivetrain::wander::{KNOT_SD, Wander};
use crate::noise::source;
use fearless_simd::prelude::*;

/// A disturbance of one wheel of each robot.
pub(super) struct Wanders<S: Simd> {
    source: u32,
    knot: [u64; LANES],
    phase: V<S>,
    from: V<S>,
    to: V<S>,
}

impl<S: Simd> Wanders<S> {
    #[inline(always)]
    pub(super) fn gather(simd: S, source: u32, of: impl Fn(usize) -> Wander) -> Self {
        Self {
            source: source::DRIVETRAIN + source,
            knot: [of(0), of(1), of(2), of(3), of(4), of(5), of(6), of(7)].map(|one| one.knot),
            phase: gather(simd, |lane| of(lane).phase),
            from: gather(simd, |lane| of(lane).from),
            to: gather(simd, |lane| of(lane).to),
        }
    }

    #[inline(always)]
    pub(super) fn scatter(&self, lane: usize, one: &mut Wander) {
        one.knot = self.knot[lane];
        one.phase = self.phase[lane];
        one.from = self.from[lane];
        one.to = self.to[lane];
    }

    /// The values here.
    #[inline(always)]
    pub(super) fn value(&self) -> V<S> {
        self.from + (self.to - self.from) * self.phase
    }

    /// Goes on by so many knots; the new knots are drawn by [`draw`].
    #[inline(always)]
    pub(super) fn advance(&mut self, knots: V<S>) {
        self.phase += knots;
    }
}

/// Draws the knots that these have come to, all at once.
#[inline(always)]
pub(super) fn draw<S: Simd>(simd: S, group: &[Lane<'_>; LANES], mut wanders: [&mut Wanders<S>; 4]) {
    loop {
        let (mut used, mut places, mut p) = (0, [(0, 0); 4 * LANES], [0.5; 4 * LANES]);
        for (number, wander) in wanders.iter_mut().enumerate() {
            let over = wander.phase.simd_ge(splat(simd, 1.0));
            let lanes = Bits::of(over);
            if lanes.none() {
                continue;
            }
            wander.phase = over.select(wander.phase - 1.0, wander.phase);
            wander.from = over.select(wander.to, wander.from);
            for lane in lanes {
                wander.knot[lane] += 1;
                let noise = &group[lane].0.drivetrain.noise;
                places[used] = (number, lane);
                p[used] = noise.probability(wander.source, wander.knot[lane]);
                used += 1;
            }
        }
        if used == 0 {
            return;
        }
        let (places, p) = (places.as_chunks::<LANES>().0, p.as_chunks::<LANES>().0);
        for (places, p) in places.iter().zip(p).take(used.div_ceil(LANES)) {
            let z = math::normal_quantile(simd, p);
            for ((number, lane), z) in places.iter().zip(z).take(used.min(LANES)) {
                wanders[*number].to[*lane] = KNOT_SD * z;
            }
            used -= used.min(LANES);
        }
    }
}
