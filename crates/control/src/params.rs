//! The table of parameters: each tunable declared once. Firmware, wire, command line and dashboard derive from it.
//!
//! A parameter is a number on the link, a name in files. Names, units and help exist on the host only (feature
//! `names`).

#[cfg(feature = "names")]
mod kind;
mod mounts;

#[cfg(feature = "names")]
pub use kind::ParamKind;

use crate::math::is_finite;
use crate::odometry::{Geometry, OdometryErrors};
use crate::rig::Rig;
use crate::speed::EDGE_RAD;
use crate::speed_loop::SpeedLoop;
use crate::types::{Side, TICK_S, Wheels};

/// Smallest and largest allowed value, and the one without any override.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParamLimits {
    /// Smallest allowed value.
    pub min: f32,
    /// Largest allowed value.
    pub max: f32,
    /// Value without any override.
    pub default: f32,
}

/// Why a parameter was not set; its value is as before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParamError {
    /// Not a finite number.
    NotFinite,
    /// Outside its limits.
    OutOfRange,
}

/// Declares the table. Each line: help, variant, name, unit, default, limits, and the type where it is no number.
macro_rules! table {
    ($( #[doc = $help:literal] $id:ident = $name:literal, $unit:literal, $default:expr, $min:expr => $max:expr $(, $kind:expr)?; )+) => {
        /// Number of a parameter, as on the link.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[repr(u8)]
        pub enum ParamId { $( #[doc = $help] $id, )+ }

        impl ParamId {
            /// All parameters, in the order of their numbers.
            pub const ALL: [ParamId; COUNT] = [ $( ParamId::$id, )+ ];

            /// The parameter with this number.
            pub const fn from_number(number: u8) -> Option<ParamId> {
                match number { $( number if number == ParamId::$id as u8 => Some(ParamId::$id), )+ _ => None }
            }

            /// Its name in files, commands and the dashboard.
            #[cfg(feature = "names")]
            pub const fn name(self) -> &'static str {
                match self { $( ParamId::$id => $name, )+ }
            }

            /// Its unit; `1` for a pure number.
            #[cfg(feature = "names")]
            pub const fn unit(self) -> &'static str {
                match self { $( ParamId::$id => $unit, )+ }
            }

            /// Its type.
            #[cfg(feature = "names")]
            pub const fn kind(self) -> ParamKind {
                match self { $( ParamId::$id => [$( $kind, )? ParamKind::Number][0], )+ }
            }

            /// What it is, in one line.
            #[cfg(feature = "names")]
            pub fn help(self) -> &'static str {
                match self { $( ParamId::$id => $help.trim_ascii(), )+ }
            }
        }

        /// Smallest and largest value and default of each.
        static LIMITS: [ParamLimits; COUNT] = [ $( ParamLimits { min: $min, max: $max, default: $default }, )+ ];

        /// How many parameters there are.
        pub const COUNT: usize = { let names = [ $( $name, )+ ]; names.len() };

        /// Hash of names, units and limits in their order (FNV-1a): two ends with different tables must not exchange numbers.
        pub const SCHEMA: u32 = {
            let mut hash: u32 = 0x811C_9DC5;
            $(
                hash = fnv(hash, $name.as_bytes());
                hash = fnv(hash, $unit.as_bytes());
                hash = fnv(hash, &f32::to_le_bytes($min));
                hash = fnv(hash, &f32::to_le_bytes($max));
            )+
            hash
        };
    };
}

const fn fnv(mut hash: u32, bytes: &[u8]) -> u32 {
    let mut i = 0;
    while i < bytes.len() {
        hash = (hash ^ bytes[i] as u32).wrapping_mul(0x0100_0193);
        i += 1;
    }
    hash
}

/// Of the Mega.
#[cfg(feature = "names")]
const ANALOGUE_INPUTS: [&str; 16] = [
    "A0", "A1", "A2", "A3", "A4", "A5", "A6", "A7", "A8", "A9", "A10", "A11", "A12", "A13", "A14",
    "A15",
];

table! {
    /// Radius of the left wheel.
    RadiusLeft = "radius_left_m", "m", 0.0325, 0.01 => 0.2;
    /// Radius of the right wheel.
    RadiusRight = "radius_right_m", "m", 0.0325, 0.01 => 0.2;
    /// Distance between the wheels' contact points.
    Base = "base_m", "m", 0.10, 0.03 => 1.0;
    /// Slip of one wheel: standard deviation of its way after 1 m.
    SlipError = "slip_error_m", "m", 0.00038, 0.0 => 0.1;
    /// Standard deviation of the ratio of the radii, relative.
    RatioError = "ratio_error", "1", 0.0041, 0.0 => 0.1;
    /// Standard deviation of radius over base, relative.
    TurnError = "turn_error", "1", 0.0117, 0.0 => 0.1;
    /// Standard deviation of the mean radius, relative.
    ScaleError = "scale_error", "1", 0.002, 0.0 => 0.1;
    /// Which sonars the robot carries, and where.
    Rig = "rig", "1", 4.0, 0.0 => 4.0, ParamKind::Choice(&Rig::NAMES);
    /// Sonars that look ahead: distance ahead of the wheels' axis.
    SonarFrontX = "sonar_front_x_m", "m", 0.13, -0.3 => 0.3;
    /// Sonars that look to a side: distance ahead of the wheels' axis, for a pair of its middle.
    SonarSideX = "sonar_side_x_m", "m", 0.03, -0.3 => 0.3;
    /// Sonars that look to a side: distance from the middle of the robot.
    SonarSideY = "sonar_side_y_m", "m", 0.075, 0.0 => 0.3;
    /// Distance between two sonars that look ahead.
    FrontGap = "front_gap_m", "m", 0.12, 0.02 => 0.5;
    /// Distance between two sonars that look to one side.
    SideGap = "side_gap_m", "m", 0.14, 0.02 => 0.5;
    /// Half angle of a sonar's beam.
    Beam = "sonar_beam_rad", "rad", 0.31, 0.0 => 1.0;
    /// Speed of the servo, to know where it points.
    ServoSpeed = "servo_speed_rad_s", "rad/s", 6.0, 0.5 => 50.0;
    /// Speed of sound.
    SoundSpeed = "sound_speed_m_s", "m/s", 343.4, 300.0 => 380.0;
    /// Duty that balances the left wheel's friction, forward.
    StaticLeftForward = "ks_left_forward", "1", 0.20, 0.0 => 0.8;
    /// Duty that balances the left wheel's friction, backward.
    StaticLeftBackward = "ks_left_backward", "1", 0.20, 0.0 => 0.8;
    /// Duty that balances the right wheel's friction, forward.
    StaticRightForward = "ks_right_forward", "1", 0.20, 0.0 => 0.8;
    /// Duty that balances the right wheel's friction, backward.
    StaticRightBackward = "ks_right_backward", "1", 0.20, 0.0 => 0.8;
    /// Duty per wheel speed.
    Velocity = "kv", "s/rad", 0.018, 0.0 => 0.2;
    /// Duty per wheel acceleration.
    Acceleration = "ka", "s2/rad", 0.012, 0.0 => 0.1;
    /// Duty that a standing wheel gets at first when asked to turn; it grows until edges come.
    Kick = "kick", "1", 0.30, 0.0 => 1.0;
    /// Speed loop of the left wheel, proportional gain.
    SpeedKpLeft = "speed_kp_left", "s/rad", 0.14, 0.0 => 2.0;
    /// Speed loop of the left wheel, integral gain.
    SpeedKiLeft = "speed_ki_left", "1/rad", 0.5, 0.0 => 20.0;
    /// Speed loop of the left wheel, derivative gain.
    SpeedKdLeft = "speed_kd_left", "s2/rad", 0.0, 0.0 => 1.0;
    /// Speed loop of the right wheel, proportional gain.
    SpeedKpRight = "speed_kp_right", "s/rad", 0.14, 0.0 => 2.0;
    /// Speed loop of the right wheel, integral gain.
    SpeedKiRight = "speed_ki_right", "1/rad", 0.5, 0.0 => 20.0;
    /// Speed loop of the right wheel, derivative gain.
    SpeedKdRight = "speed_kd_right", "s2/rad", 0.0, 0.0 => 1.0;
    /// Largest acceleration asked of a wheel.
    WheelAccel = "wheel_accel_rad_s2", "rad/s2", 40.0, 1.0 => 500.0;
    /// Largest deceleration asked of a wheel; beyond about 20 friction alone does not brake it.
    WheelDecel = "wheel_decel_rad_s2", "rad/s2", 20.0, 1.0 => 500.0;
    /// Voltage at which the feedforward was measured; used where the battery's voltage is.
    NominalBattery = "nominal_battery_v", "V", 7.4, 3.0 => 30.0;
    /// Voltage below which the robot does not drive; used where the battery's voltage is measured.
    LowBattery = "low_battery_v", "V", 6.2, 0.0 => 30.0;
    /// Battery's voltage over that at the analogue input; 0: no divider is wired, the voltage is not measured.
    BatteryRatio = "battery_ratio", "1", 0.0, 0.0 => 20.0;
    /// Analogue input that the divider is wired to.
    BatteryInput = "battery_input", "1", 0.0, 0.0 => 15.0, ParamKind::Choice(&ANALOGUE_INPUTS);
    /// Time without a sign of life after which the wheels are released.
    LinkTimeout = "link_timeout_s", "s", 0.4, 0.05 => 0.45;
    /// The same when the robot is addressed in text.
    TextTimeout = "text_timeout_s", "s", 10.0, 0.1 => 3600.0;
    /// Age of a sonar's last good reading beyond which the robot does not drive on it.
    StaleRange = "stale_range_s", "s", 0.5, 0.1 => 2.0;
    /// Time by which the wheels follow a falling speed reference late.
    SpeedLag = "speed_lag_s", "s", 0.1, 0.0 => 1.0;
    /// Turns on the spot: largest yaw rate.
    TurnRate = "turn_rate_rad_s", "rad/s", 3.0, 0.2 => 10.0;
    /// Turns on the spot: planned deceleration.
    TurnBrake = "turn_brake_rad_s2", "rad/s2", 3.5, 0.5 => 60.0;
    /// Turns on the spot: deceleration of the released wheels just before they stand.
    TurnCoast = "turn_coast_rad_s2", "rad/s2", 6.0, 0.5 => 100.0;
    /// Turns on the spot: error that is good enough.
    TurnTolerance = "turn_tolerance_rad", "rad", 0.015, 0.002 => 0.5;
    /// Straight lines: largest speed.
    LineCruise = "line_cruise_m_s", "m/s", 0.45, 0.02 => 0.8;
    /// Straight lines: planned acceleration.
    LineAccel = "line_accel_m_s2", "m/s2", 0.9, 0.05 => 10.0;
    /// Straight lines: planned deceleration.
    LineBrake = "line_brake_m_s2", "m/s2", 0.36, 0.05 => 3.0;
    /// Straight lines: deceleration of the released wheels just before they stand.
    LineCoast = "line_coast_m_s2", "m/s2", 0.5, 0.05 => 5.0;
    /// Straight lines: heading per distance from the line.
    LineCross = "line_cross_kp", "rad/m", 5.0, 0.0 => 50.0;
    /// Straight lines: yaw rate per heading error.
    LineHeading = "line_heading_kp", "1/s", 5.0, 0.0 => 20.0;
    /// Straight lines: way left that is good enough.
    LineTolerance = "line_tolerance_m", "m", 0.004, 0.001 => 0.1;
    /// Pure pursuit: lookahead per speed.
    PursuitTime = "pursuit_lookahead_s", "s", 0.5, 0.05 => 5.0;
    /// Pure pursuit: shortest lookahead.
    PursuitLeast = "pursuit_lookahead_m", "m", 0.12, 0.02 => 2.0;
    /// Pure pursuit: distance between points, of which the one after the nearest is the lookahead, as in the report; 0: by the speed.
    PursuitSpacing = "pursuit_spacing_m", "m", 0.0, 0.0 => 2.0;
    /// Pure pursuit: largest sideways acceleration, which limits the speed in bends.
    PursuitSide = "pursuit_side_m_s2", "m/s2", 0.4, 0.01 => 10.0;
    /// What follows a route: straight lines with turns on the spot between them, or a pure pursuit.
    WaypointTracker = "waypoint_tracker", "1", 0.0, 0.0 => 1.0, ParamKind::Choice(&["straight", "pure_pursuit"]);
    /// Inner wheel's speed over the outer one's in arcs.
    ArcRatio = "arc_ratio", "1", 0.5, 0.0 => 1.0;
    /// Largest approach speed.
    FrontCruise = "front_cruise_m_s", "m/s", 0.5, 0.02 => 0.8;
    /// Deceleration planned on the way to the reference.
    FrontBrake = "front_brake_m_s2", "m/s2", 0.36, 0.05 => 3.0;
    /// Speed per distance near the reference.
    FrontKp = "front_kp", "1/s", 5.0, 0.1 => 20.0;
    /// Distance from the reference within which the wheels are released.
    FrontTolerance = "front_tolerance_m", "m", 0.0015, 0.0005 => 0.05;
    /// Yaw rate per heading error, to drive straight.
    FrontHeading = "front_heading_kp", "1/s", 4.0, 0.0 => 20.0;
    /// Yaw rate per bearing of the wall's normal, on the way to the reference.
    AlignKp = "align_kp", "1/s", 3.0, 0.0 => 20.0;
    /// Angle to the wall that is good enough at rest.
    AlignTolerance = "align_tolerance_rad", "rad", 0.015, 0.002 => 0.2;
    /// How far to the sides of the wall's normal the servo looks to learn its bearing.
    SweepAside = "sweep_aside_rad", "rad", 0.65, 0.35 => 1.0;
    /// Speed along the wall.
    WallCruise = "wall_cruise_m_s", "m/s", 0.16, 0.05 => 0.4;
    /// Speed towards the wall per distance error.
    WallKp = "wall_kp", "1/s", 1.6, 0.0 => 10.0;
    /// Angle to the wall per distance error and time.
    WallKi = "wall_ki", "rad/(m s)", 1.0, 0.0 => 20.0;
    /// Largest angle to the wall on the way to another distance.
    WallHeadingLimit = "wall_heading_limit_rad", "rad", 0.42, 0.1 => 0.55;
    /// Yaw rate per angle error.
    WallHeadingKp = "wall_heading_kp", "1/s", 5.0, 0.0 => 20.0;
    /// Damping: yaw rate subtracted per measured yaw rate.
    WallDamping = "wall_damping", "1", 0.3, 0.0 => 2.0;
    /// Largest yaw rate.
    WallYawLimit = "wall_yaw_limit_rad_s", "rad/s", 1.5, 0.1 => 5.0;
    /// Range of the front sonar at which the robot stops before what stands ahead, where the rig looks ahead.
    WallStop = "wall_stop_m", "m", 0.15, 0.05 => 1.0;
    /// Yaw rate per difference of distance travelled, as a heading.
    StraightKp = "straight_kp", "1/s", 4.0, 0.1 => 20.0;
    /// Heading per offset from the line.
    StraightOffset = "straight_offset_rad_m", "rad/m", 2.0, 0.0 => 20.0;
    /// Slope of the speed when speeding up.
    StraightAccel = "straight_accel_rad_s2", "rad/s2", 20.0, 1.0 => 100.0;
    /// Slope of the speed when slowing down; beyond about 10 friction alone does not follow.
    StraightDecel = "straight_decel_rad_s2", "rad/s2", 8.0, 1.0 => 100.0;
    /// Largest speed on the way to a goal and in a lane.
    MissionCruise = "mission_cruise_m_s", "m/s", 0.40, 0.05 => 0.8;
    /// Largest speed around an obstacle.
    MissionAround = "mission_around_m_s", "m/s", 0.22, 0.05 => 0.6;
    /// Range of the front sonar at which a lane turns.
    LaneSafe = "lane_safe_m", "m", 0.25, 0.15 => 1.0;
    /// Time after which a goal that has not been reached is given up.
    MissionGiveUp = "mission_give_up_s", "s", 150.0, 5.0 => 3600.0;
    /// Each goal reached becomes the origin.
    MissionResetOrigin = "mission_reset_origin", "1", 1.0, 0.0 => 1.0, ParamKind::Switch;
}

impl ParamId {
    /// Its limits and default.
    pub fn limits(self) -> ParamLimits {
        LIMITS[self as usize]
    }

    /// Whether a value is allowed.
    ///
    /// # Errors
    /// The value is not finite or outside the limits.
    pub fn check(self, value: f32) -> Result<(), ParamError> {
        let ParamLimits { min, max, .. } = self.limits();
        if !is_finite(value) {
            Err(ParamError::NotFinite)
        } else if value < min || value > max {
            Err(ParamError::OutOfRange)
        } else {
            Ok(())
        }
    }

    /// The parameter with this name.
    #[cfg(feature = "names")]
    pub fn from_name(name: &str) -> Option<ParamId> {
        Self::ALL.into_iter().find(|id| id.name() == name)
    }
}

/// The values in force. Every value is finite and within its limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Params {
    values: [f32; COUNT],
    // Derived values that every tick would otherwise recompute.
    rig: Rig,
    geometry: Geometry,
    loops: Wheels<SpeedLoop>,
}

impl Default for Params {
    fn default() -> Self {
        let mut params = Self {
            values: [0.0; COUNT],
            rig: Rig::Final,
            geometry: Geometry::new(Wheels::both(1.0), 1.0),
            loops: Wheels::default(),
        };
        params.reset();
        params
    }
}

impl Params {
    /// A parameter's value.
    pub fn get(&self, id: ParamId) -> f32 {
        match self.values.get(id as usize) {
            Some(value) => *value,
            None => 0.0,
        }
    }

    /// Whether a switch is on.
    pub fn is_on(&self, id: ParamId) -> bool {
        self.get(id) > 0.5
    }

    /// Sets a parameter; returns the value in force.
    ///
    /// # Errors
    /// The value is not finite or outside the parameter's limits; it is then as before.
    pub fn set(&mut self, id: ParamId, value: f32) -> Result<f32, ParamError> {
        id.check(value)?;
        self.values[id as usize] = value;
        self.derive();
        Ok(value)
    }

    /// Sets all of them to their defaults.
    pub fn reset(&mut self) {
        for (value, limits) in self.values.iter_mut().zip(&LIMITS) {
            *value = limits.default;
        }
        self.derive();
    }

    fn derive(&mut self) {
        let radius_m = Wheels {
            left: self.get(ParamId::RadiusLeft),
            right: self.get(ParamId::RadiusRight),
        };
        self.geometry = Geometry::new(radius_m, self.get(ParamId::Base));
        self.rig = Rig::nearest(self.get(ParamId::Rig));
        self.derive_loop(Side::Left);
        self.derive_loop(Side::Right);
    }

    /// The lengths for odometry.
    pub fn geometry(&self) -> &Geometry {
        &self.geometry
    }

    /// The rig in force.
    pub fn rig(&self) -> Rig {
        self.rig
    }

    /// How well the lengths for odometry are known.
    pub fn odometry_errors(&self) -> OdometryErrors {
        let geometry = self.geometry();
        OdometryErrors {
            slip_m: self.get(ParamId::SlipError),
            ratio: self.get(ParamId::RatioError),
            turn: self.get(ParamId::TurnError),
            scale: self.get(ParamId::ScaleError),
            base_m: geometry.base_m(),
            edge_m: EDGE_RAD * geometry.mean_radius_m(),
        }
    }

    /// The speed loop of one wheel.
    pub fn speed_loop(&self, side: Side) -> &SpeedLoop {
        &self.loops[side]
    }

    fn derive_loop(&mut self, side: Side) {
        use ParamId as Id;
        let ([forward, backward], [kp, ki, kd]) = match side {
            Side::Left => (
                [Id::StaticLeftForward, Id::StaticLeftBackward],
                [Id::SpeedKpLeft, Id::SpeedKiLeft, Id::SpeedKdLeft],
            ),
            Side::Right => (
                [Id::StaticRightForward, Id::StaticRightBackward],
                [Id::SpeedKpRight, Id::SpeedKiRight, Id::SpeedKdRight],
            ),
        };
        let values = &self.values;
        let get = |id: Id| values[id as usize];
        let SpeedLoop {
            feedforward,
            kick,
            pid,
            accel_rad_s,
            decel_rad_s,
        } = &mut self.loops[side];
        feedforward.static_forward = get(forward);
        feedforward.static_backward = get(backward);
        feedforward.velocity = get(Id::Velocity);
        feedforward.acceleration = get(Id::Acceleration);
        *kick = get(Id::Kick);
        pid.gains.kp = get(kp);
        pid.gains.ki = get(ki);
        pid.gains.kd = get(kd);
        (pid.min, pid.max, pid.tracking_s) = (0.0, 1.0, 0.1);
        *accel_rad_s = get(Id::WheelAccel) * TICK_S;
        *decel_rad_s = get(Id::WheelDecel) * TICK_S;
    }
}

#[cfg(test)]
mod tests;
