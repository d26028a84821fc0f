//! The basic movements of mode 0.

crate::numbered! {
    /// The basic movements of the report's first section.
    #[derive(Default)]
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
}

/// Level of a basic movement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MovementLevel {
    /// Open loop: fraction of full PWM, 0..=1.
    Duty(f32),
    /// Closed loop: wheel speed [rad/s], 0 to [`super::MAX_WHEEL_RAD_S`].
    Speed(f32),
}
