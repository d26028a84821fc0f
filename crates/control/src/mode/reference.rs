//! References: what a mode is to reach or hold, as a value, and what that is in each mode.

use super::{SetpointError, within};
use crate::types::Wheels;

/// The reference in force, of the kind that the mode has; zeros where it is not known yet.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Reference {
    /// The mode has none.
    #[default]
    None,
    /// The distance to keep [m].
    Distance(f32),
    /// The speed of each wheel [rad/s].
    Wheels(Wheels<f32>),
    /// The position to go to [m].
    Goal {
        /// Its x.
        x_m: f32,
        /// Its y.
        y_m: f32,
    },
}

impl Reference {
    /// Of these numbers, in the order of [`Reference::numbers`].
    pub const fn new(kind: Option<ReferenceKind>, [first, second]: [f32; 2]) -> Self {
        match kind {
            None => Self::None,
            Some(ReferenceKind::Distance) => Self::Distance(first),
            Some(ReferenceKind::WheelSpeed | ReferenceKind::Speed) => Self::Wheels(Wheels {
                left: first,
                right: second,
            }),
            Some(ReferenceKind::Goal) => Self::Goal {
                x_m: first,
                y_m: second,
            },
        }
    }

    /// As the link and logs have it: a distance twice, left and right wheel, or x and y; zeros where there is none.
    pub const fn numbers(self) -> [f32; 2] {
        match self {
            Self::None => [0.0; 2],
            Self::Distance(distance_m) => [distance_m; 2],
            Self::Wheels(Wheels { left, right }) => [left, right],
            Self::Goal { x_m, y_m } => [x_m, y_m],
        }
    }
}

/// What the reference of a mode is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReferenceDescription {
    /// Its kind.
    pub kind: ReferenceKind,
    /// Smallest allowed value.
    pub min: f32,
    /// Largest allowed value.
    pub max: f32,
    /// The value to offer first.
    pub offered: f32,
    /// A command sets it; otherwise the mode determines it.
    pub commanded: bool,
}

impl ReferenceDescription {
    /// One that a command sets.
    pub const fn commanded(kind: ReferenceKind, min: f32, max: f32, offered: f32) -> Self {
        Self {
            kind,
            min,
            max,
            offered,
            commanded: true,
        }
    }

    /// Whether a value is allowed.
    ///
    /// # Errors
    /// It is not finite or out of range.
    #[inline]
    pub fn check(&self, value: f32) -> Result<(), SetpointError> {
        within(value, self.min, self.max)
    }
}

/// What a reference is, in SI units.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReferenceKind {
    /// A distance in metres.
    Distance,
    /// A speed of each wheel in rad/s.
    WheelSpeed,
    /// One speed of both wheels in rad/s.
    Speed,
    /// A position: each coordinate in metres.
    Goal,
}

#[cfg(feature = "names")]
impl ReferenceKind {
    /// The name in messages to the dashboard.
    pub const fn name(self) -> &'static str {
        match self {
            ReferenceKind::Distance => "distance",
            ReferenceKind::WheelSpeed => "wheel_speed",
            ReferenceKind::Speed => "speed",
            ReferenceKind::Goal => "goal",
        }
    }
}
