//! Where the sonars sit on the robot.

use crate::sonar::SonarId;

/// Where a sonar sits on the robot.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Mount {
    /// Ahead of the wheels' axis.
    pub x_m: f64,
    /// Left of the middle.
    pub y_m: f64,
    /// Where it looks: 0 forward, positive to the left.
    pub angle_rad: f64,
    /// True if the servo turns it.
    pub on_servo: bool,
}

/// The sonars a robot carries.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Mounts {
    /// Left, or the left (or rear left-side) one of a pair.
    pub left: Option<Mount>,
    /// Right, or the right one of a pair.
    pub right: Option<Mount>,
    /// Front.
    pub front: Option<Mount>,
    /// Those with names of their own.
    pub others: [Option<Mount>; SonarId::OTHERS],
}

impl Mounts {
    /// By [`SonarId::index`].
    #[must_use]
    pub fn mounts(&self) -> [Option<Mount>; SonarId::ALL.len()] {
        let mut all = [None; SonarId::ALL.len()];
        let (own, others) = all.split_at_mut(3);
        own.copy_from_slice(&[self.left, self.right, self.front]);
        others.copy_from_slice(&self.others);
        all
    }
}
