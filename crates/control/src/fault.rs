//! Faults, which latch until they are cleared.

crate::numbered! {
    /// Why a mode or the supervisor refuses to drive. Faults latch until they are cleared on purpose.
    pub enum Fault {
        /// No sign of life from the other end of the link.
        LinkLost = 1,
        /// The sonar the mode needs is silent or gives impossible values.
        SonarFaulty = 2,
        /// The sonar's last good reading is too old to drive on.
        SonarStale = 3,
        /// The wall the mode regulates on is out of reach.
        WallLost = 4,
        /// The left wheel is driven and its encoder gives no edges: held, or its sensor is cut.
        LeftEncoderSilent = 5,
        /// The right wheel is driven and its encoder gives no edges: held, or its sensor is cut.
        RightEncoderSilent = 6,
        /// The battery is below its lower limit.
        BatteryLow = 7,
        /// A non-finite value reached the core.
        NotFinite = 8,
        /// A control tick took longer than its period.
        Overrun = 9,
        /// Something stands in the way of a mode that does not go around it, or holds both wheels.
        Blocked = 10,
        /// The left encoder's edges are not those of a turning wheel, or too few for its duty.
        LeftEncoderImplausible = 11,
        /// The right encoder's edges are not those of a turning wheel, or too few for its duty.
        RightEncoderImplausible = 12,
    }
}

impl Fault {
    /// What it means and what to do, for people.
    #[cfg(feature = "names")]
    pub const fn explanation(self) -> &'static str {
        match self {
            Fault::LinkLost => {
                "link lost: no heartbeat arrived in time; check the connection, then clear and arm again"
            }
            Fault::SonarFaulty => {
                "sonar faulty: its echo line is silent or stuck, or its readings jump; check its wiring, and see that it faces no corner, gap or slanted box"
            }
            Fault::SonarStale => {
                "sonar stale: no good reading for too long; is something absorbing the echo?"
            }
            Fault::WallLost => {
                "wall lost: a sonar that the mode needs hears none; face the robot to a wall"
            }
            Fault::LeftEncoderSilent => {
                "left encoder silent: something holds the left wheel, or its encoder is cut off; free the wheel, then see the wires of the encoder"
            }
            Fault::RightEncoderSilent => {
                "right encoder silent: something holds the right wheel, or its encoder is cut off; free the wheel, then see the wires of the encoder"
            }
            Fault::BatteryLow => "battery low: charge it",
            Fault::NotFinite => "a value was not a finite number; reset the parameters",
            Fault::Overrun => "a control tick took too long",
            Fault::Blocked => {
                "blocked: the robot met something, or something is in its way or holds both wheels; clear the way or turn the robot, then clear the fault and arm again"
            }
            Fault::LeftEncoderImplausible => {
                "left encoder implausible: the robot met something, or something drags at the left wheel; if neither, its encoder loses edges or picks up noise: see its wires, its ground, and the gap between sensor and magnet"
            }
            Fault::RightEncoderImplausible => {
                "right encoder implausible: the robot met something, or something drags at the right wheel; if neither, its encoder loses edges or picks up noise: see its wires, its ground, and the gap between sensor and magnet"
            }
        }
    }
}

#[cfg(feature = "names")]
impl core::fmt::Display for Fault {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(self.explanation())
    }
}
