//! Vectors of one number of each robot.

use super::LANES;
use fearless_simd::prelude::*;
use fearless_simd::{f64x8, mask64x8};

/// A number of each robot.
pub(super) type V<S> = f64x8<S>;
/// A truth of each robot.
pub(super) type M<S> = mask64x8<S>;

/// The same number for all.
#[inline(always)]
pub(super) fn splat<S: Simd>(simd: S, value: f64) -> V<S> {
    V::simd_from(simd, value)
}

/// A number of each robot.
#[inline(always)]
pub(super) fn gather<S: Simd>(simd: S, of: impl Fn(usize) -> f64) -> V<S> {
    V::simd_from(
        simd,
        [of(0), of(1), of(2), of(3), of(4), of(5), of(6), of(7)],
    )
}

/// The numbers of those lanes whose bit is set, from the first on.
#[derive(Clone, Copy, Default)]
pub(super) struct Bits(pub(super) u64);

impl Bits {
    /// The lanes of a mask.
    #[inline(always)]
    pub(super) fn of<S: Simd>(mask: M<S>) -> Self {
        Self(mask.to_bitmask())
    }

    /// No lane.
    #[inline(always)]
    pub(super) fn none(self) -> bool {
        self.0 == 0
    }

    #[inline(always)]
    pub(super) fn has(self, lane: usize) -> bool {
        self.0 >> lane & 1 != 0
    }
}

impl Iterator for Bits {
    type Item = usize;

    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        // Below LANES always: it spares the checks of bounds.
        let lane = self.0.trailing_zeros() as usize;
        self.0 &= self.0.wrapping_sub(1);
        (lane < LANES).then_some(lane)
    }
}
