//! Places on the floor in integers: millimetres in 16 bits, directions in 16,384ths.
//!
//! The memory's points are asked for far more often than they are put down, and most of the time the answer is no. So
//! the first question is always one of comparisons of 16 bits, which the AVR does in a twentieth of the time of a
//! product of floats: does the point lie within [`Bounds`]?

use crate::math::round;

/// A place on the floor [mm].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Place {
    /// Along x.
    pub x_mm: i16,
    /// Along y.
    pub y_mm: i16,
}

impl Place {
    /// From metres; saturates at 32 m.
    pub(super) fn new(x_m: f32, y_m: f32) -> Self {
        Self {
            x_mm: to_i16(1_000.0 * x_m),
            y_mm: to_i16(1_000.0 * y_m),
        }
    }

    /// In metres.
    pub(super) fn metres(self) -> (f32, f32) {
        (f32::from(self.x_mm) * 1e-3, f32::from(self.y_mm) * 1e-3)
    }

    /// From `from` to here [mm]; saturates.
    #[inline]
    pub(super) fn from(self, from: Place) -> (i16, i16) {
        (
            self.x_mm.saturating_sub(from.x_mm),
            self.y_mm.saturating_sub(from.y_mm),
        )
    }

    /// Whether the distance is less than `limit_mm`. Most are not by one coordinate alone.
    #[inline]
    pub(super) fn is_within(self, limit_mm: u16, of: Place) -> bool {
        let (x, y) = self.from(of);
        let (x, y) = (x.unsigned_abs(), y.unsigned_abs());
        x < limit_mm && y < limit_mm && square(x) + square(y) < square(limit_mm)
    }

    /// Square of the distance [mm^2].
    pub(super) fn square_mm2(self, to: Place) -> u32 {
        let (x, y) = self.from(to);
        square(x.unsigned_abs()) + square(y.unsigned_abs())
    }

    /// About the distance, and up to an eighth more, without a product [mm].
    #[inline]
    pub(super) fn about_mm(self, to: Place) -> u16 {
        let (x, y) = self.from(to);
        let (x, y) = (x.unsigned_abs(), y.unsigned_abs());
        if x > y { x + (y >> 1) } else { y + (x >> 1) }
    }

    /// How far along a direction, and how far to the left of it, seen from `from` [mm]. The direction as [`fractions`].
    pub(super) fn seen(self, from: Place, &(sin, cos): &(i16, i16)) -> (i32, i32) {
        /// Of a coordinate and a fraction: with the sum of another one it fits into 32 bits.
        fn product(one: i16, other: i16) -> i32 {
            i32::from(one) * i32::from(other)
        }
        let (x, y) = self.from(from);
        (
            (product(x, cos) + product(y, sin)) >> 14,
            (product(y, cos) - product(x, sin)) >> 14,
        )
    }

    /// The same place where `from` is the origin and x points in a direction.
    pub(super) fn as_seen(self, from: Place, facing: &(i16, i16)) -> Self {
        let (along, left) = self.seen(from, facing);
        Self {
            x_mm: saturated(along),
            y_mm: saturated(left),
        }
    }
}

/// Of differences of places it is at most 2^30: two of them fit.
fn square(x: u16) -> u32 {
    u32::from(x) * u32::from(x)
}

/// Sine and cosine in 16,384ths, for products of integers.
pub(super) fn fractions((sin, cos): (f32, f32)) -> (i16, i16) {
    (to_i16(sin * 16_384.0), to_i16(cos * 16_384.0))
}

fn to_i16(value: f32) -> i16 {
    saturated(round(value))
}

fn saturated(value: i32) -> i16 {
    i16::try_from(value.clamp(-32_000, 32_000)).unwrap_or(0)
}

/// The upright rectangle around a strip of floor: nothing outside of it lies in the strip.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    low: Place,
    high: Place,
}

impl Bounds {
    /// Of the strip from a place on, `length_mm` in a direction, `aside_mm` to both sides.
    pub(super) fn of(from: Place, &(sin, cos): &(i16, i16), length_mm: i32, aside_mm: i32) -> Self {
        /// What rounding may add.
        const SPARE_MM: i32 = 2;
        let span = |from: i16, along: i32| {
            let (from, to) = (i32::from(from), i32::from(from) + along);
            let aside_mm = aside_mm + SPARE_MM;
            (
                saturated(from.min(to) - aside_mm),
                saturated(from.max(to) + aside_mm),
            )
        };
        let (left, right) = span(from.x_mm, (length_mm * i32::from(cos)) >> 14);
        let (near, far) = span(from.y_mm, (length_mm * i32::from(sin)) >> 14);
        Self {
            low: Place {
                x_mm: left,
                y_mm: near,
            },
            high: Place {
                x_mm: right,
                y_mm: far,
            },
        }
    }

    /// Of a circle.
    pub(super) fn around(centre: Place, radius_mm: u16) -> Self {
        let by = i16::try_from(radius_mm).unwrap_or(i16::MAX);
        Self {
            low: Place {
                x_mm: centre.x_mm.saturating_sub(by),
                y_mm: centre.y_mm.saturating_sub(by),
            },
            high: Place {
                x_mm: centre.x_mm.saturating_add(by),
                y_mm: centre.y_mm.saturating_add(by),
            },
        }
    }

    /// Whether a place lies in it.
    #[inline]
    pub(super) fn hold(&self, place: Place) -> bool {
        place.x_mm >= self.low.x_mm
            && place.x_mm <= self.high.x_mm
            && place.y_mm >= self.low.y_mm
            && place.y_mm <= self.high.y_mm
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::sin_cos;
    use proptest::prelude::*;

    #[test]
    fn places_64_metres_apart_are_far_and_do_not_overflow() {
        let (here, there) = (Place::new(-40.0, -40.0), Place::new(40.0, 40.0));
        assert!(!there.is_within(32_000, here) && !here.is_within(32_000, there));
        assert!(here.square_mm2(there) > 1 << 30 && here.about_mm(there) > 32_000);
    }

    proptest! {
        #[test]
        fn what_lies_in_a_strip_lies_within_its_bounds(
            heading_rad in -3.2f32..3.2, x_m in -3.0f32..3.0, y_m in -3.0f32..3.0, length_mm in 0i32..2_500, aside_mm in 0i32..900
        ) {
            let facing = fractions(sin_cos(heading_rad));
            let (from, point) = (Place::new(0.3, -0.2), Place::new(x_m, y_m));
            let (along, across) = point.seen(from, &facing);
            let inside = along > 0 && along < length_mm && across.abs() < aside_mm;
            prop_assert!(!inside || Bounds::of(from, &facing, length_mm, aside_mm).hold(point));
        }

        #[test]
        fn the_cheap_distance_is_at_most_an_eighth_too_long(x_m in -30.0f32..30.0, y_m in -30.0f32..30.0) {
            let (point, origin) = (Place::new(x_m, y_m), Place::default());
            let (about, exact) = (f64::from(point.about_mm(origin)), f64::from(point.square_mm2(origin)).sqrt());
            prop_assert!(about + 1.0 > exact && about <= exact * 1.125, "{about} {exact}");
        }
    }
}
