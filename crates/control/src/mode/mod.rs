//! The modes: what the robot does, one file each.

/// The modes of the report, by the number they have there.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum ModeId {
    /// Basic movements, open loop or by speed (memoria 1).
    #[default]
    Manual = 0,
    /// Stop at a distance from a wall (memoria 2.1).
    FrontDistance = 1,
    /// Each wheel at a commanded speed (memoria 4.1).
    WheelSpeed = 5,
}

impl ModeId {
    /// The modes that exist, in the order of their numbers.
    pub const ALL: [ModeId; 3] = [ModeId::Manual, ModeId::FrontDistance, ModeId::WheelSpeed];

    /// The mode with this number.
    pub fn from_number(number: u8) -> Option<ModeId> {
        Self::ALL.into_iter().find(|mode| *mode as u8 == number)
    }

    /// The name used in files, commands and the dashboard.
    #[cfg(feature = "names")]
    pub const fn name(self) -> &'static str {
        match self {
            ModeId::Manual => "manual",
            ModeId::FrontDistance => "front_distance",
            ModeId::WheelSpeed => "wheel_speed",
        }
    }
}

/// The basic movements of the report's first section.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum Movement {
    /// Both wheels released.
    #[default]
    Stop = 0,
    /// Both wheels forward.
    Forward = 1,
    /// Both wheels backward.
    Backward = 2,
    /// About the centre, counter-clockwise.
    TurnLeft = 3,
    /// About the centre, clockwise.
    TurnRight = 4,
    /// About the standing left wheel: the right wheel forward (counter-clockwise).
    PivotLeftForward = 5,
    /// About the standing left wheel: the right wheel backward (clockwise).
    PivotLeftBackward = 6,
    /// About the standing right wheel: the left wheel forward (clockwise).
    PivotRightForward = 7,
    /// About the standing right wheel: the left wheel backward (counter-clockwise).
    PivotRightBackward = 8,
    /// Forward along an arc to the left.
    ArcLeft = 9,
    /// Forward along an arc to the right.
    ArcRight = 10,
    /// Backward along an arc, the centre on the left.
    ArcLeftBackward = 11,
    /// Backward along an arc, the centre on the right.
    ArcRightBackward = 12,
}
