//! Floor and slip along the way, in lanes: see [`crate::drivetrain`].
//!
//! The knots that come next are drawn for all robots when the first of them comes to one that is not drawn yet.

use super::vector::{Bits, M, V, gather, splat};
use super::{LANES, Lane, math};
use crate::drivetrain::wander::{KNOT_SD, Wander};
use crate::noise::source;
use fearless_simd::prelude::*;

/// A disturbance of one wheel of each robot.
pub(super) struct Wanders<S: Simd> {
    source: u32,
    phase: V<S>,
    from: V<S>,
    to: V<S>,
    /// The knot after `to`, where it is drawn.
    next: V<S>,
    drawn: Bits,
    /// The number of `to` at the start, and how many have been passed since.
    knot: [u64; LANES],
    passed: V<S>,
}

impl<S: Simd> Wanders<S> {
    #[inline(always)]
    pub(super) fn gather(simd: S, source: u32, of: impl Fn(usize) -> Wander) -> Self {
        let zero = splat(simd, 0.0);
        let mut knot = [0; LANES];
        for (lane, knot) in knot.iter_mut().enumerate() {
            *knot = of(lane).knot;
        }
        Self {
            source: source::DRIVETRAIN + source,
            phase: gather(simd, |lane| of(lane).phase),
            from: gather(simd, |lane| of(lane).from),
            to: gather(simd, |lane| of(lane).to),
            next: zero,
            drawn: Bits(0),
            knot,
            passed: zero,
        }
    }

    #[inline(always)]
    pub(super) fn scatter(&self, lane: usize, one: &mut Wander) {
        one.knot = self.knot(lane);
        one.phase = self.phase[lane];
        one.from = self.from[lane];
        one.to = self.to[lane];
    }

    #[inline(always)]
    fn knot(&self, lane: usize) -> u64 {
        self.knot[lane] + self.passed[lane] as u64
    }

    /// The values here.
    #[inline(always)]
    pub(super) fn value(&self) -> V<S> {
        self.from + (self.to - self.from) * self.phase
    }

    /// Goes on by so many knots; [`pass`] follows.
    #[inline(always)]
    pub(super) fn advance(&mut self, knots: V<S>) {
        self.phase += knots;
    }

    /// Where it has come to the next knot.
    #[inline(always)]
    fn over(&self, simd: S) -> M<S> {
        self.phase.simd_ge(splat(simd, 1.0))
    }

    #[inline(always)]
    fn draw(&mut self, simd: S, group: &[Lane<'_>; LANES]) {
        let p = gather(simd, |lane| {
            let noise = &group[lane].0.drivetrain.noise;
            noise.probability(self.source, self.knot(lane) + 1)
        });
        self.next = math::normal_quantile(simd, p) * KNOT_SD;
        self.drawn = Bits(0xff);
    }

    #[inline(always)]
    fn pass(&mut self, simd: S, over: M<S>) {
        self.phase = over.select(self.phase - 1.0, self.phase);
        self.from = over.select(self.to, self.from);
        self.to = over.select(self.next, self.to);
        self.passed += over.select(splat(simd, 1.0), splat(simd, 0.0));
        self.drawn.0 &= !Bits::of(over).0;
    }
}

/// Goes past the knots that these have come to. Both wheels draw at the same time: neither waits for the other.
#[inline(always)]
pub(super) fn pass<S: Simd>(
    simd: S,
    group: &[Lane<'_>; LANES],
    left: &mut Wanders<S>,
    right: &mut Wanders<S>,
) {
    loop {
        let over = [left.over(simd), right.over(simd)];
        let lanes = [Bits::of(over[0]).0, Bits::of(over[1]).0];
        if lanes[0] | lanes[1] == 0 {
            return;
        }
        if lanes[0] & !left.drawn.0 | lanes[1] & !right.drawn.0 != 0 {
            left.draw(simd, group);
            right.draw(simd, group);
        }
        left.pass(simd, over[0]);
        right.pass(simd, over[1]);
    }
}
