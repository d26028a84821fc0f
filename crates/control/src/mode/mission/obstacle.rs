//! The obstacle in the way: connected stored points, and the directions that just pass them.
//!
//! Two points are connected when the robot does not fit between them. From one that blocks the way the search spreads,
//! a few points per tick, and carries each point's bearing along without a wrap: an obstacle that reaches around the
//! robot has its left end beyond +180 degrees or its right end beyond -180.
//!
//! ```text
//! a point at distance d and bearing b blocks the directions b +- asin(R / d)      R: half of what the robot needs
//! ```
//!
//! Their union is one interval, since neighbours are nearer than 2 R: its two ends are the ways around.

use super::echoes::{CAPACITY, Echoes};
use super::place::{Bounds, Place, fractions};
use crate::math::{atan2, from_u32, min, round, sqrt, wrap_angle};
use core::f32::consts::{FRAC_PI_2, PI, TAU};

/// Two points nearer than this are connected [mm].
pub(super) const LINK_MM: u16 = 290;
/// Half of the width that the robot takes for itself when it passes a point [m].
pub(super) const PASS_M: f32 = 0.17;
/// Half of the width of the way to the goal that must be clear [m].
pub(super) const WAY_M: f32 = 0.125;
/// Points searched per tick, and points found.
const PER_TICK: usize = 3;
const JOINED_PER_TICK: u8 = 3;
/// Points farther than this from the robot do not carry the search on [m].
const SPREAD_M: f32 = 1.6;
/// Steps of the bearings that are carried along [rad].
const COARSE_RAD: f32 = TAU / 64.0;

/// One end of an obstacle as the robot sees it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct End {
    /// The direction that just passes it, beyond +-pi where the obstacle reaches around the robot [rad].
    pub pass_rad: f32,
    /// The point passed.
    pub at: Place,
}

/// What stands in the way.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Obstacle {
    /// Its left end.
    pub left: End,
    /// Its right end.
    pub right: End,
    /// Distance to its nearest point [m].
    pub nearest_m: f32,
}

/// A set of points, by their numbers; in bytes, since the AVR shifts long words bit by bit.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Points {
    has: [bool; CAPACITY],
}

impl Points {
    const NONE: Self = Self {
        has: [false; CAPACITY],
    };

    fn has(&self, number: usize) -> bool {
        self.has.get(number).copied().unwrap_or_default()
    }

    fn insert(&mut self, number: usize) {
        if let Some(slot) = self.has.get_mut(number) {
            *slot = true;
        }
    }

    fn is_empty(&self) -> bool {
        !self.has.contains(&true)
    }

    /// The point with the lowest number, which is no longer in the set.
    fn take_first(&mut self) -> Option<usize> {
        let number = self.has.iter().position(|has| *has)?;
        if let Some(slot) = self.has.get_mut(number) {
            *slot = false;
        }
        Some(number)
    }
}

/// The search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Search {
    /// Points that belong to it, and those of them whose neighbours are still to be found.
    member: Points,
    open: Points,
    bearing: [i8; CAPACITY],
    so_far: Obstacle,
}

impl Default for Search {
    #[inline]
    fn default() -> Self {
        Self {
            member: Points::NONE,
            open: Points::NONE,
            bearing: [0; CAPACITY],
            so_far: Obstacle::default(),
        }
    }
}

/// A query along a way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Way {
    /// Where the robot is [m].
    pub x_m: f32,
    /// Where the robot is [m].
    pub y_m: f32,
    /// Which way [rad].
    pub heading_rad: f32,
    /// Sine and cosine of that.
    pub facing: (f32, f32),
    /// How far [m].
    pub length_m: f32,
}

impl Echoes {
    /// The point that blocks a way soonest, and how far along [m]. Where it lies is asked first: most lie elsewhere.
    pub(super) fn blocking(
        &self,
        way: &Way,
        half_width_m: f32,
        among: Among,
    ) -> Option<(usize, f32)> {
        let facing = fractions(way.facing);
        let from = Place::new(way.x_m, way.y_m);
        let half_mm = round(half_width_m * 1_000.0);
        let mut nearest_mm = round(way.length_m * 1_000.0);
        let mut found = None;
        let bounds = Bounds::of(from, &facing, nearest_mm, half_mm);
        for (number, point) in self.points().iter().enumerate() {
            let Some(point) = point.place().filter(|place| bounds.hold(*place)) else {
                continue;
            };
            let (along, across) = point.seen(from, &facing);
            if along > 0
                && along < nearest_mm
                && across.abs() < half_mm
                && among.has(self, number, from)
            {
                nearest_mm = along;
                found = Some(number);
            }
        }
        let along_m = from_u32(nearest_mm.unsigned_abs()) * 1e-3;
        found.map(|number| (number, along_m))
    }

    /// The point nearest to a place, of those of an obstacle or of all, and its distance [m].
    pub(super) fn nearest(&self, x_m: f32, y_m: f32, of: Option<&Search>) -> Option<(usize, f32)> {
        let from = Place::new(x_m, y_m);
        // By the cheap kind of distance first: products are for the few that may be nearer than the nearest so far.
        let mut most_mm = u16::MAX;
        let mut best: Option<(usize, u32)> = None;
        for (number, point) in self.points().iter().enumerate() {
            let Some(place) = point.place() else { continue };
            let about_mm = place.about_mm(from);
            if about_mm > most_mm || of.is_some_and(|search| !search.has(number)) {
                continue;
            }
            let mostly_mm = about_mm.saturating_add(about_mm >> 3).saturating_add(1);
            most_mm = core::cmp::min(most_mm, mostly_mm);
            let square = place.square_mm2(from);
            if best.is_none_or(|(_, least)| square < least) {
                best = Some((number, square));
            }
        }
        let (number, square) = best?;
        Some((number, sqrt(from_u32(square)) * 1e-3))
    }
}

/// Which points count.
#[derive(Clone, Copy)]
pub(super) enum Among<'a> {
    /// All.
    All,
    /// Those that are firm.
    Firm,
    /// Those that are firm and do not belong to an obstacle.
    FirmOthers(&'a Search),
}

impl Among<'_> {
    fn has(self, echoes: &Echoes, number: usize, here: Place) -> bool {
        match self {
            Among::All => true,
            Among::Firm => echoes.is_firm(number, here),
            Among::FirmOthers(search) => !search.has(number) && echoes.is_firm(number, here),
        }
    }
}

impl Search {
    /// Restarts at a point that blocks the way in direction `about_rad`, from which bearings are unwrapped.
    pub(super) fn begin(
        &mut self,
        echoes: &Echoes,
        seed: usize,
        x_m: f32,
        y_m: f32,
        about_rad: f32,
    ) {
        self.member = Points::NONE;
        self.open = Points::NONE;
        self.so_far = Obstacle {
            left: End {
                pass_rad: f32::MIN,
                at: Place::default(),
            },
            right: End {
                pass_rad: f32::MAX,
                at: Place::default(),
            },
            nearest_m: f32::MAX,
        };
        self.join(echoes, seed, x_m, y_m, about_rad);
    }

    /// Adds a point, whose bearing is near `about_rad`.
    pub(super) fn join(
        &mut self,
        echoes: &Echoes,
        number: usize,
        x_m: f32,
        y_m: f32,
        about_rad: f32,
    ) {
        let Some(point) = echoes.get(number) else {
            return;
        };
        if self.member.has(number) {
            return;
        }
        self.member.insert(number);
        let (px_m, py_m) = point.metres();
        let (dx, dy) = (px_m - x_m, py_m - y_m);
        let distance_m = sqrt(dx * dx + dy * dy);
        if distance_m < SPREAD_M {
            self.open.insert(number);
        }
        let bearing_rad = about_rad + wrap_angle(atan2(dy, dx) - about_rad);
        if let Some(slot) = self.bearing.get_mut(number) {
            let coarse = round(bearing_rad * (1.0 / COARSE_RAD));
            *slot = i8::try_from(coarse.clamp(-127, 127)).unwrap_or(0);
        }
        let half_rad = half_angle(distance_m);
        let (left_rad, right_rad) = (bearing_rad + half_rad, bearing_rad - half_rad);
        if left_rad > self.so_far.left.pass_rad {
            self.so_far.left = End {
                pass_rad: left_rad,
                at: point,
            };
        }
        if right_rad < self.so_far.right.pass_rad {
            self.so_far.right = End {
                pass_rad: right_rad,
                at: point,
            };
        }
        self.so_far.nearest_m = min(self.so_far.nearest_m, distance_m);
    }

    /// Continues the search; returns the obstacle when it is complete.
    pub(super) fn step(&mut self, echoes: &Echoes, x_m: f32, y_m: f32) -> Option<Obstacle> {
        let here = Place::new(x_m, y_m);
        let mut joined = 0;
        for _ in 0..PER_TICK {
            let Some(number) = self.open.take_first() else {
                break;
            };
            let Some(centre) = echoes.get(number) else {
                continue;
            };
            let about_rad = f32::from(self.bearing.get(number).copied().unwrap_or(0)) * COARSE_RAD;
            let around = Bounds::around(centre, LINK_MM);
            for (other, point) in echoes.points().iter().enumerate() {
                let Some(place) = point.place().filter(|place| around.hold(*place)) else {
                    continue;
                };
                if self.member.has(other)
                    || !place.is_within(LINK_MM, centre)
                    || !echoes.is_firm(other, here)
                {
                    continue;
                }
                if joined == JOINED_PER_TICK {
                    // Enough for now: this one is searched again.
                    self.open.insert(number);
                    return None;
                }
                self.join(echoes, other, x_m, y_m, about_rad);
                joined += 1;
            }
        }
        (self.open.is_empty() && !self.member.is_empty()).then_some(self.so_far)
    }

    /// Whether a point belongs to the obstacle.
    pub(super) fn has(&self, number: usize) -> bool {
        self.member.has(number)
    }
}

/// Half of the angle that a point at this distance blocks; beyond a right angle where the robot is too near already.
pub(super) fn half_angle(distance_m: f32) -> f32 {
    if distance_m > 2.0 * PASS_M {
        // The arc sine by its series: 6e-5 rad off at most.
        let sine = PASS_M / distance_m;
        let z = sine * sine;
        sine + sine * z * (1.0 / 6.0 + z * (3.0 / 40.0 + z * (15.0 / 336.0)))
    } else if distance_m > PASS_M {
        let along_m = sqrt(distance_m * distance_m - PASS_M * PASS_M);
        atan2(PASS_M, along_m)
    } else {
        min(
            FRAC_PI_2 + 0.8 * (PASS_M - distance_m) / PASS_M * FRAC_PI_2,
            PI,
        )
    }
}
