//! Which wheel or sonar a signal is of.

use rumbo_control::Wheels;

/// A wheel or a sonar, by its index in arrays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Channel {
    Left = 0,
    Right = 1,
    Front = 2,
}

impl Channel {
    /// A wheel's value of two.
    pub(crate) fn of(self, wheels: Wheels<f32>) -> f32 {
        if self == Self::Left {
            wheels.left
        } else {
            wheels.right
        }
    }
}
