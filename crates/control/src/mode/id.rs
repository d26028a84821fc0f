//! What the modes and the basic movements are called and numbered.

#[cfg(feature = "names")]
use super::{
    front_align, front_distance, manual, mission, straight_line, wall_follow, wall_hold, waypoints,
    wheel_speed,
};

/// The modes of the report, by the number they have there.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum ModeId {
    /// Basic movements, open loop or by speed (memoria 1).
    #[default]
    Manual = 0,
    /// Stop at a distance from a wall (memoria 2.1).
    FrontDistance = 1,
    /// Stop square to a wall at a distance from it (memoria 2.2).
    FrontAlign = 2,
    /// Follow a wall at the distance at which the robot starts (memoria 3.1).
    WallHold = 3,
    /// Follow a wall at a commanded distance (memoria 3.2).
    WallFollow = 4,
    /// Each wheel at a commanded speed (memoria 4.1).
    WheelSpeed = 5,
    /// Straight on, by the difference of distance travelled (memoria 4.2).
    StraightLine = 6,
    /// A route of poses by odometry (memoria 4.3).
    Waypoints = 7,
    /// A goal around obstacles, or a lane of boxes (memoria 5).
    Mission = 8,
}

impl ModeId {
    /// The modes that exist, in the order of their numbers.
    pub const ALL: [ModeId; 9] = [
        ModeId::Manual,
        ModeId::FrontDistance,
        ModeId::FrontAlign,
        ModeId::WallHold,
        ModeId::WallFollow,
        ModeId::WheelSpeed,
        ModeId::StraightLine,
        ModeId::Waypoints,
        ModeId::Mission,
    ];

    /// The mode with this number.
    pub fn from_number(number: u8) -> Option<ModeId> {
        Self::ALL.get(usize::from(number)).copied()
    }

    /// The name used in files, commands and the dashboard.
    #[cfg(feature = "names")]
    pub const fn name(self) -> &'static str {
        match self {
            ModeId::Manual => "manual",
            ModeId::FrontDistance => "front_distance",
            ModeId::FrontAlign => "front_align",
            ModeId::WallHold => "wall_hold",
            ModeId::WallFollow => "wall_follow",
            ModeId::WheelSpeed => "wheel_speed",
            ModeId::StraightLine => "straight_line",
            ModeId::Waypoints => "waypoints",
            ModeId::Mission => "mission",
        }
    }

    /// The names of its states, by the number in the telemetry.
    #[cfg(feature = "names")]
    pub const fn state_names(self) -> &'static [&'static str] {
        match self {
            ModeId::Manual => &manual::STATE_NAMES,
            ModeId::FrontDistance => &front_distance::STATE_NAMES,
            ModeId::FrontAlign => &front_align::STATE_NAMES,
            ModeId::WallHold => &wall_hold::STATE_NAMES,
            ModeId::WallFollow => &wall_follow::STATE_NAMES,
            ModeId::WheelSpeed => &wheel_speed::STATE_NAMES,
            ModeId::StraightLine => &straight_line::STATE_NAMES,
            ModeId::Waypoints => &waypoints::STATE_NAMES,
            ModeId::Mission => &mission::STATE_NAMES,
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

impl Movement {
    /// All movements, by number.
    pub const ALL: [Movement; 13] = [
        Movement::Stop,
        Movement::Forward,
        Movement::Backward,
        Movement::TurnLeft,
        Movement::TurnRight,
        Movement::PivotLeftForward,
        Movement::PivotLeftBackward,
        Movement::PivotRightForward,
        Movement::PivotRightBackward,
        Movement::ArcLeft,
        Movement::ArcRight,
        Movement::ArcLeftBackward,
        Movement::ArcRightBackward,
    ];
}

/// How much of a basic movement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Level {
    /// Open loop: fraction of full PWM, 0..=1.
    Duty(f32),
    /// Closed loop: wheel speed [rad/s], 0 to [`MAX_WHEEL_RAD_S`].
    Speed(f32),
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mode::ActiveMode;

    #[test]
    fn modes_and_movements_are_found_by_their_number() {
        for mode in ModeId::ALL {
            assert_eq!(ModeId::from_number(mode as u8), Some(mode));
            assert_eq!(ActiveMode::new(mode).id(), mode);
        }
        assert_eq!(ModeId::from_number(9), None);
        #[cfg(feature = "names")]
        for mode in ModeId::ALL {
            assert!(mode.state_names().len() <= 16, "telemetry has four bits");
        }
        assert!(
            Movement::ALL
                .iter()
                .enumerate()
                .all(|(number, movement)| *movement as usize == number)
        );
    }
}
