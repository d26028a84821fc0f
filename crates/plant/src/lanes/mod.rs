//! Eight plants stepped together, a lane of a vector register each: the same bits as one by one, sooner.
//!
//! [`crate::plant`] is the reference, and what runs where the processor has neither AVX2 nor AVX-512. A group advances here
//! when its robots stand on the floor and are at the same place within a millisecond; their times may differ by whole ones.
//!
//! | file | what goes in lanes | what goes robot by robot |
//! |---|---|---|
//! | `drivetrain` | currents, battery, friction, wheel speeds | a braking bridge, a wheel that stops or stands |
//! | `wander` | floor and slip along the way, draws of their knots | the hash of a draw, draws far out |
//! | `body` | pose, speeds, clearance | a body near an obstacle |
//! | `group` | which lanes have events | the events: edges, echoes; the servo |
//! | `math` | sine and cosine, the normal's quantile | arguments near multiples of a quarter turn |
//!
//! Every operation of a lane is that of the scalar source, in its order: no fused multiply-add, true division, libm's
//! polynomials. `tests/plant/lanes.rs` compares both bit for bit. Everything is `#[inline(always)]`: a function that is
//! not inlined is compiled without the wide instructions, and costs six times. So does a closure over vectors that goes
//! through `array::map`.

#[cfg(target_arch = "x86_64")]
mod body;
#[cfg(target_arch = "x86_64")]
mod drivetrain;
#[cfg(target_arch = "x86_64")]
mod group;
#[cfg(target_arch = "x86_64")]
mod math;
#[cfg(target_arch = "x86_64")]
mod vector;
#[cfg(target_arch = "x86_64")]
mod wander;

use crate::event::Event;
use crate::plant::{Plant, State};
#[cfg(target_arch = "x86_64")]
use fearless_simd::{Avx2, Avx512, Level, Simd};

/// Robots of a group.
pub const LANES: usize = 8;

/// One robot of a group: its plant, and its state.
pub type Lane<'a> = (&'a Plant, &'a mut State);

/// The instructions to step groups with.
#[derive(Clone, Copy, Debug)]
pub struct Lanes(Kind);

#[derive(Clone, Copy, Debug)]
enum Kind {
    Scalar,
    #[cfg(target_arch = "x86_64")]
    Avx2(Avx2),
    #[cfg(target_arch = "x86_64")]
    Avx512(Avx512),
}

impl Lanes {
    /// Robot by robot, as [`Plant::advance`] does.
    pub const SCALAR: Self = Self(Kind::Scalar);

    /// All that this processor has, the widest last.
    #[must_use]
    pub fn all() -> Vec<Self> {
        [Self::SCALAR].into_iter().chain(vectors()).collect()
    }

    /// The widest that this processor has.
    #[must_use]
    pub fn widest() -> Self {
        vectors().last().unwrap_or(Self::SCALAR)
    }

    /// Their name: `scalar`, `AVX2` or `AVX-512`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self.0 {
            Kind::Scalar => "scalar",
            #[cfg(target_arch = "x86_64")]
            Kind::Avx2(_) => "AVX2",
            #[cfg(target_arch = "x86_64")]
            Kind::Avx512(_) => "AVX-512",
        }
    }

    /// Passes `for_us` for each robot, as [`Plant::advance`] would, and reports its events, in the order of time for each,
    /// with its number in the group.
    pub fn advance(
        self,
        group: &mut [Lane<'_>; LANES],
        for_us: u64,
        events: &mut impl FnMut(usize, Event),
    ) {
        match self.0 {
            #[cfg(target_arch = "x86_64")]
            Kind::Avx2(simd) if group::are_alike(group) => {
                simd.vectorize(
                    #[inline(always)]
                    || group::advance(simd, group, for_us, events),
                );
            }
            #[cfg(target_arch = "x86_64")]
            Kind::Avx512(simd) if group::are_alike(group) => {
                simd.vectorize(
                    #[inline(always)]
                    || group::advance(simd, group, for_us, events),
                );
            }
            _ => {
                for (index, (plant, state)) in group.iter_mut().enumerate() {
                    let until_us = state.now_us + for_us;
                    plant.advance(state, until_us, &mut |event| events(index, event));
                }
            }
        }
    }
}

/// Those of vector registers, the widest last.
#[cfg(target_arch = "x86_64")]
fn vectors() -> impl Iterator<Item = Lanes> {
    let level = Level::new();
    let avx2 = level.as_avx2().map(Kind::Avx2);
    let avx512 = level.as_avx512().map(Kind::Avx512);
    avx2.into_iter().chain(avx512).map(Lanes)
}

#[cfg(not(target_arch = "x86_64"))]
fn vectors() -> impl Iterator<Item = Lanes> {
    core::iter::empty()
}
