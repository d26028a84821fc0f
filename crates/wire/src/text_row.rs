//! The rows of telemetry of the original's text protocol; the robot writes them with [`Line`](crate::text::TextLine).

use rumbo_control::Wheels;

/// The row of modes 1 to 4.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DistanceRow {
    /// Time since the row before [ms].
    pub dt_ms: u32,
    /// The left (or first) sonar's range [cm].
    pub left_cm: f32,
    /// The right (or second) sonar's range [cm].
    pub right_cm: f32,
    /// The distance to keep [cm].
    pub reference_cm: f32,
    /// Number of the mode.
    pub mode: u8,
    /// Signed PWM, -255..=255.
    pub pwm: Wheels<i16>,
}

/// The row of modes 5 and 6; ours also in mode 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SpeedRow {
    /// Time since the row before [ms].
    pub dt_ms: u32,
    /// Wheel speeds [rpm].
    pub wheel_rpm: Wheels<f32>,
    /// Speed reference of motor A, the right wheel [rpm]; the original has one for both.
    pub reference_rpm: f32,
    /// Number of the mode.
    pub mode: u8,
    /// Signed PWM, -255..=255.
    pub pwm: Wheels<i16>,
}

/// The row of mode 7.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WaypointsRow {
    /// Time since the row before [ms].
    pub dt_ms: u32,
    /// Wheel speeds [rpm].
    pub wheel_rpm: Wheels<f32>,
    /// Wheel speed references [rpm].
    pub reference_rpm: Wheels<f32>,
    /// Forward of the origin [m].
    pub x_m: f32,
    /// Left of the origin [m].
    pub y_m: f32,
    /// Heading, counter-clockwise [deg].
    pub heading_deg: f32,
    /// Signed PWM, -255..=255.
    pub pwm: Wheels<i16>,
}

/// The row of mode 8.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MissionRow {
    /// Time since the row before [ms].
    pub dt_ms: u32,
    /// Wheel speed references [rpm].
    pub reference_rpm: Wheels<f32>,
    /// Heading setpoint [deg].
    pub heading_reference_deg: f32,
    /// The goal, forward of the origin [m].
    pub goal_x_m: f32,
    /// The goal, left of the origin [m].
    pub goal_y_m: f32,
    /// Forward of the origin [m].
    pub x_m: f32,
    /// Left of the origin [m].
    pub y_m: f32,
    /// Heading, counter-clockwise [deg].
    pub heading_deg: f32,
    /// State of the mode's machine.
    pub state: u8,
    /// The right sonar's range [cm].
    pub right_cm: f32,
    /// The left sonar's range [cm].
    pub left_cm: f32,
    /// The front sonar's range [cm].
    pub front_cm: f32,
}

/// A row of telemetry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TextRow {
    /// Modes 1 to 4.
    Distance(DistanceRow),
    /// Modes 5 and 6 (and 0).
    Speed(SpeedRow),
    /// Mode 7.
    Waypoints(WaypointsRow),
    /// Mode 8.
    Mission(MissionRow),
}

/// Which columns a row has; [`crate::csv`] names them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RowKind {
    /// Modes 1 to 4.
    Distance,
    /// Modes 5 and 6 (and 0).
    Speed,
    /// Mode 7.
    Waypoints,
    /// Mode 8.
    Mission,
}

impl TextRow {
    /// Which columns it has.
    pub fn kind(&self) -> RowKind {
        match self {
            TextRow::Distance(_) => RowKind::Distance,
            TextRow::Speed(_) => RowKind::Speed,
            TextRow::Waypoints(_) => RowKind::Waypoints,
            TextRow::Mission(_) => RowKind::Mission,
        }
    }
}
