//! The messages between the two ends, as values. Their bytes: [`crate::codec`].

pub use rumbo_control::mode::MovementLevel;
pub use rumbo_control::mode::waypoints::Waypoint;
use rumbo_control::mode::{ModeId, Movement, Reference, SetpointError};
use rumbo_control::params::ParamError;
use rumbo_control::rig::Rig;
use rumbo_control::{AgedRange, Duty, Fault, Pose, Velocity, Wheels};

/// Version of the binary protocol; raised when a change is not understood by the other end.
pub const PROTOCOL_VERSION: u8 = 3;

/// Oldest command that a robot obeys, by its own clock, if the command [is timed](Command::is_timed) \[ms\].
pub const COMMAND_LIFE_MS: u32 = 2_000;

/// Oldest velocity that a robot drives, by its own clock \[ms\].
pub const VELOCITY_LIFE_MS: u32 = 300;

/// Session of a guest who commands the robot on the station's link, such as a calibration; the station draws another
/// one, since the guest's numbers would be old ones of its own.
pub const GUEST_SESSION: u8 = 0xCA;

/// An instant by the robot's clock.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RobotTime {
    /// Number of the robot's start, wrapping: times of two starts are not comparable.
    pub start: u8,
    /// Time since that start [ms], wrapping after 49.7 days.
    pub ms: u32,
}

impl RobotTime {
    /// Time since an earlier instant \[ms\]; `None` if there was a start in between, or `earlier` is later.
    pub fn since(self, earlier: RobotTime) -> Option<u32> {
        let ms = self.ms.wrapping_sub(earlier.ms);
        (self.start == earlier.start && ms < 0x8000_0000).then_some(ms)
    }

    /// The first instant from this one on with the lower 16 bits that telemetry carries; this one if that lies behind.
    pub fn at_low(self, t_ms: u16) -> RobotTime {
        let ahead_ms = t_ms.wrapping_sub((self.ms & 0xFFFF) as u16);
        let ahead_ms = if ahead_ms < 0x8000 { ahead_ms } else { 0 };
        RobotTime {
            ms: self.ms.wrapping_add(u32::from(ahead_ms)),
            ..self
        }
    }

    /// The newest robot time after a message, given the one before: a status carries it in full, telemetry advances it.
    pub fn after(before: Option<RobotTime>, message: &FromRobot) -> Option<RobotTime> {
        match message {
            FromRobot::Status(status) => Some(status.at),
            FromRobot::Telemetry(telemetry) => before.map(|before| before.at_low(telemetry.t_ms)),
            _ => before,
        }
    }
}

/// From the robot to the station.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FromRobot {
    /// The robot's identity; the answer to [`ToRobot::Hello`] and the first frame after a reset.
    Hello(Hello),
    /// The fast signals, 25 times a second.
    Telemetry(Telemetry),
    /// The slow signals, twice a second.
    Status(StatusReport),
    /// Something happened.
    Event(Event),
    /// The result of a command.
    Ack(Ack),
    /// The mode's heading setpoint [rad], ahead of the telemetry of the same instant; sent in units of 2 pi / 65536
    /// when it has changed, at most 12.5 times a second, and with every status. 0 where the mode has none.
    HeadingRef(f32),
}

/// From the station to the robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ToRobot {
    /// Asks for [`FromRobot::Hello`].
    Hello,
    /// A sign of life.
    Heartbeat,
    /// Applied exactly once, acknowledged as often as it arrives.
    Command {
        /// Chosen at random by the station when it starts; a new session forgets the old one's numbers.
        session: u8,
        /// Consecutive within the session, wrapping.
        number: u16,
        /// What to do.
        command: Command,
        /// The newest robot time that the station had received when the command was issued. Sent only with commands
        /// that [are timed](Command::is_timed); otherwise the default.
        seen: RobotTime,
    },
    /// The velocity of mode 10 from now on; the newest one counts. Neither acknowledged nor repeated: it is refused in
    /// silence by a robot in another mode, when it is older than [`VELOCITY_LIFE_MS`] and when it is out of range. It
    /// arms nothing.
    Velocity {
        /// Sent with 1 mm/s and 1 mrad/s.
        velocity: Velocity,
        /// The newest robot time that the station had received when the velocity was issued.
        seen: RobotTime,
    },
}

/// The robot's identity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hello {
    /// [`PROTOCOL_VERSION`] of the robot.
    pub protocol: u8,
    /// Hash of the parameter table ([`rumbo_control::params`]); a station with another table must not write parameters.
    pub schema: u32,
    /// Hash of the program image; 0 for the native build.
    pub image: u32,
    /// Why it started.
    pub reset: ResetCause,
}

rumbo_control::numbered! {
    /// Why the robot's program started.
    pub enum ResetCause {
        /// Power applied, or the start of a simulation.
        PowerOn = 0,
        /// The reset button or the serial adapter.
        External = 1,
        /// The supply dipped.
        BrownOut = 2,
        /// The watchdog: a tick hung.
        Watchdog = 3,
    }
}

/// The fast signals.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Telemetry {
    /// Robot time of the sample [ms], wrapping; the receiver unwraps it.
    pub t_ms: u16,
    /// State of the mode's machine, 0..=15; names: `rumbo_control::mode::Description::states`.
    pub state: u8,
    /// The wheels may turn.
    pub armed: bool,
    /// A fault is latched; its cause is in [`StatusReport`] and in an [`Event`].
    pub faulted: bool,
    /// PWM applied to the wheels.
    pub duty: Wheels<Duty>,
    /// Where the servo points [rad]; sent with 1 degree.
    pub servo_rad: f32,
    /// Estimated pose; sent with 1 mm and 2 pi / 65536.
    pub pose: Pose,
    /// Wheel speeds [rad/s], the sample of 20 ms before `t_ms` first; sent with 0.02 rad/s.
    pub wheel_rad_s: [Wheels<f32>; 2],
    /// Wheel speed references [rad/s]; 0 when driven open loop; sent with 0.02 rad/s.
    pub wheel_ref_rad_s: Wheels<f32>,
    /// Ranges by `SonarId` number, the front one in the servo's direction; sent with 2.5 mm, ages not sent (0).
    pub ranges: [AgedRange; 3],
}

/// The slow signals.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StatusReport {
    /// The mode selected.
    pub mode: ModeId,
    /// The wheels may turn.
    pub armed: bool,
    /// The latched fault.
    pub fault: Option<Fault>,
    /// Battery [V], where a divider is wired.
    pub battery_v: Option<f32>,
    /// The mode's reference.
    pub reference: Reference,
    /// Frames from the station that failed the CRC, wrapping.
    pub crc_errors: u8,
    /// Telemetry frames dropped because the link was full, wrapping.
    pub dropped: u8,
    /// Control ticks that overran, wrapping.
    pub overruns: u8,
    /// The sonars of the configured rig.
    pub rig: Rig,
    /// Time of these values.
    pub at: RobotTime,
}

/// Something that happened, with the time at which it did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Event {
    /// Robot time [ms], wrapping.
    pub t_ms: u16,
    /// What.
    pub kind: EventKind,
}

/// What happened.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EventKind {
    /// The wheels may turn.
    Armed,
    /// The wheels were released, on command or by a fault.
    Disarmed,
    /// A fault latched.
    Faulted(Fault),
    /// The latched fault was cleared on command.
    Cleared(Fault),
    /// Another mode is active.
    ModeChanged(ModeId),
    /// The mode reached its reference.
    Reached,
    /// The mode found that its goal cannot be reached; the robot waits.
    Unreachable,
    /// The mode has sought a way to its goal for so long \[s\], and found none; the robot waits.
    GaveUp {
        /// Its parameter `mission_give_up_s`.
        after_s: u16,
    },
    /// After HELLO, if parameters have been saved: the source of those in force at the start.
    Recalled(Recalled),
    /// A save of the parameters is complete.
    Saved,
}

rumbo_control::numbered! {
    /// Which of the two saved copies of the parameters the robot started with.
    pub enum Recalled {
        /// The first.
        First = 1,
        /// The second.
        Second = 2,
        /// The first; the second is damaged or of another table.
        FirstAlone = 3,
        /// The second; the first is damaged or of another table.
        SecondAlone = 4,
        /// Neither is good: the defaults.
        Neither = 5,
    }
}

/// A command to the robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Command {
    /// Release the wheels at once and disarm. Pre-empts everything.
    Stop,
    /// Arm and start the mode.
    Arm,
    /// Stop the mode and disarm.
    Disarm,
    /// Clear the latched fault.
    ClearFault,
    /// Select a mode; refused while armed.
    Mode(ModeId),
    /// The mode's reference: distance [m] in modes 1, 2 and 4, speed of both wheels [rad/s] in modes 5 and 6.
    Reference(f32),
    /// The mode's reference for each wheel: speed [rad/s] in mode 5.
    WheelReference(Wheels<f32>),
    /// A basic movement (mode 0).
    Move {
        /// Which one.
        movement: Movement,
        /// How fast the (outer) wheel turns.
        level: MovementLevel,
    },
    /// Set a parameter of the table.
    SetParam {
        /// Its number in [`rumbo_control::params`].
        id: u8,
        /// Its new value, in its unit.
        value: f32,
    },
    /// Ask for a parameter; the acknowledgement carries it.
    GetParam {
        /// Its number in [`rumbo_control::params`].
        id: u8,
    },
    /// Set every parameter to its default.
    ResetParams,
    /// Write the parameters in force to the EEPROM, so that the robot starts with them from now on. Acknowledged at once;
    /// [`EventKind::Saved`] follows when it is done.
    SaveParams,
    /// Make the present pose the origin.
    ResetPose,
    /// Go to a point: around obstacles in mode 8, straight in mode 7. It may arrive at any time.
    Goal {
        /// Forward of the origin [m].
        x_m: f32,
        /// Left of the origin [m].
        y_m: f32,
    },
    /// Follow a lane (mode 8).
    Lane,
    /// Begin a new route (mode 7); [`Command::Waypoint`]s follow.
    Route {
        /// Starts over at the end.
        repeat: bool,
        /// The waypoints are relative to the pose where the robot starts, not to the origin.
        relative: bool,
    },
    /// Append a waypoint to the route (mode 7).
    Waypoint(Waypoint),
}

impl Command {
    /// Changes what the robot drives, now or at its next ON. Such a command carries the robot time at which it was
    /// issued, and is refused when it is older than [`COMMAND_LIFE_MS`]: better lost than late.
    pub fn is_timed(&self) -> bool {
        match self {
            Command::Arm
            | Command::Mode(_)
            | Command::Reference(_)
            | Command::WheelReference(_)
            | Command::Move { .. }
            | Command::SetParam { .. }
            | Command::ResetParams
            | Command::ResetPose
            | Command::Goal { .. }
            | Command::Lane
            | Command::Route { .. }
            | Command::Waypoint(_) => true,
            Command::Stop
            | Command::Disarm
            | Command::ClearFault
            | Command::GetParam { .. }
            | Command::SaveParams => false,
        }
    }
}

/// The result of a command.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ack {
    /// The command's session.
    pub session: u8,
    /// The command's number.
    pub number: u16,
    /// Applied, with the value in force now (0 where there is none), or refused.
    pub result: Result<f32, Refusal>,
}

rumbo_control::numbered! {
    /// Why a command was refused; the robot continues as before.
    pub enum Refusal {
        /// The value is not a finite number.
        NotFinite = 1,
        /// The value is outside the allowed range.
        OutOfRange = 2,
        /// No such parameter.
        UnknownParam = 3,
        /// The mode has no such command.
        NotInThisMode = 4,
        /// Not while armed: disarm first.
        Armed = 5,
        /// A fault is latched: clear it first.
        Faulted = 6,
        /// The sonar the mode needs gives no good reading.
        SonarNotReady = 7,
        /// No heartbeat: the link is not alive.
        NoLink = 8,
        /// The command could not be understood.
        Malformed = 9,
        /// The rig lacks the sonars that the mode needs.
        WrongRig = 10,
        /// The battery is below its lower limit.
        BatteryLow = 11,
        /// The command was issued too long ago, or before the robot's last start.
        TooOld = 12,
        /// The sonar the mode needs works, and sees no wall that the mode can drive by.
        NoWall = 13,
        /// No network lies beside the robot's program.
        NoPolicy = 14,
    }
}

impl From<SetpointError> for Refusal {
    fn from(error: SetpointError) -> Self {
        match error {
            SetpointError::NotFinite => Self::NotFinite,
            SetpointError::OutOfRange => Self::OutOfRange,
            SetpointError::NotInThisMode => Self::NotInThisMode,
        }
    }
}

impl From<ParamError> for Refusal {
    fn from(error: ParamError) -> Self {
        match error {
            ParamError::NotFinite => Self::NotFinite,
            ParamError::OutOfRange => Self::OutOfRange,
        }
    }
}
