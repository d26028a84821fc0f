//! Descriptions of the modes, for selecting, plotting and checking them: one constant [`Description`] beside each mode.
//!
//! The firmware uses only the number, the rigs and the range of the reference, as constants. The whole description
//! exists on hosts (`ModeId::description`, feature `names`): page, command line, docs and metrics derive from it.

use super::reference::ReferenceDescription;
use crate::params::ParamId;
use crate::rig::Rigs;

/// The description of a mode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Description {
    /// Its number in the report, on the link and in files.
    pub number: u8,
    /// Its name in files, commands and the dashboard.
    pub name: &'static str,
    /// What it does, in a few words.
    pub about: &'static str,
    /// Its states, by the number in telemetry, and what leads from one to another.
    pub states: &'static [StateDescription],
    /// The state in which its reference is not in force yet: the value is stale.
    pub idle: Option<u8>,
    /// What its reference is, if it has one.
    pub reference: Option<ReferenceDescription>,
    /// It has a heading setpoint, which is sent to the station.
    pub heading: bool,
    /// Its other inputs.
    pub takes: Option<Takes>,
    /// The rigs with the sonars it needs.
    pub rigs: Rigs,
    /// The parameters it uses, the most important ones first. A parameter of no mode belongs to the robot.
    pub parameters: &'static [ParamGroup],
    /// What its control loops compute, from the outer to the inner ones, as far as signals show it.
    pub laws: &'static [&'static [Law]],
    /// The plots to show, in this order.
    pub plots: &'static [ModePlot],
    /// The metrics of its runs, besides those of every run.
    pub metrics: &'static [MetricGroup],
}

/// A state of a mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StateDescription {
    /// Its name.
    pub name: &'static str,
    /// What the robot does in it.
    pub does: &'static str,
    /// The transitions from it while the robot is armed; a command may lead back to the first state at any time.
    pub ways: &'static [Transition],
}

/// A transition to another state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Transition {
    /// Number of the state that follows.
    pub to: u8,
    /// When, in a few words.
    pub when: &'static str,
}

/// An input of a mode besides its reference.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Takes {
    /// The basic movements.
    Movements,
    /// A route of at most so many waypoints.
    Route(usize),
    /// The command to follow a lane.
    Lane,
    /// Velocities, repeated.
    Velocity,
}

/// Parameters that belong together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ParamGroup {
    /// Their subject.
    pub title: &'static str,
    /// The parameters.
    pub parameters: &'static [ParamId],
}

impl ParamGroup {
    /// A group.
    pub const fn new(title: &'static str, parameters: &'static [ParamId]) -> Self {
        Self { title, parameters }
    }
}

/// An equation of a control law, for people to see with the numbers of an instant. Names are those of parameters and of
/// signals, in SI units; there are `+ - * /`, `min`, `max`, `abs`, `sqrt`, `sign` and `clamp(x, least, most)`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Law {
    /// The signal that it gives, or a name that the equations after it have.
    pub gives: &'static str,
    /// What it adds up.
    pub is: &'static str,
    /// Parameters within the terms that the equation does not spell out.
    pub gains: &'static [ParamId],
    /// The states in which it holds, by number; none: in all.
    pub states: &'static [u8],
}

impl Law {
    /// An equation with all its parameters.
    pub const fn new(gives: &'static str, is: &'static str) -> Self {
        Self {
            gives,
            is,
            gains: &[],
            states: &[],
        }
    }

    /// One that holds in these states only.
    pub const fn only_in(self, states: &'static [u8]) -> Self {
        Self { states, ..self }
    }

    /// One whose terms have these parameters within.
    pub const fn with(self, gains: &'static [ParamId]) -> Self {
        Self { gains, ..self }
    }
}

/// A plot that a mode may show by default; the page decides its curves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ModePlot {
    /// Ranges and the reference of the distance.
    Distance,
    /// Wheel speeds and their references.
    Wheels,
    /// PWM of both wheels.
    Pwm,
    /// Heading and its reference.
    Heading,
    /// Position and goal.
    Position,
}

#[cfg(feature = "names")]
impl ModePlot {
    /// The name in messages to the dashboard.
    pub const fn name(self) -> &'static str {
        match self {
            ModePlot::Distance => "distance",
            ModePlot::Wheels => "wheels",
            ModePlot::Pwm => "PWM",
            ModePlot::Heading => "heading",
            ModePlot::Position => "position",
        }
    }
}

/// Metrics that belong together; `rumbo-experiment` computes them from ground truth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MetricGroup {
    /// Each step of a distance to a wall ahead.
    DistanceSteps,
    /// Each step of the wheels' speed.
    SpeedSteps,
    /// Distance and angle to a wall ahead.
    Alignment,
    /// Distance to a wall on one side.
    Wall,
    /// The path of a basic movement.
    Movement,
    /// The duty at which each wheel starts to turn.
    DeadZones,
    /// Speed over duty.
    StaticCurve,
    /// Drift from a straight line.
    Drift,
    /// Errors along a route.
    Route,
    /// Goals reached, time and path length.
    Goals,
    /// The way through a random world, beside the shortest.
    Journey,
    /// The straights of a lane.
    Lane,
}

/// The PID of each wheel.
pub(super) const SPEED_LOOPS: ParamGroup = ParamGroup::new(
    "speed loops",
    &[
        ParamId::SpeedKpLeft,
        ParamId::SpeedKiLeft,
        ParamId::SpeedKdLeft,
        ParamId::SpeedKpRight,
        ParamId::SpeedKiRight,
        ParamId::SpeedKdRight,
    ],
);
/// Feedforward of the wheels.
pub(super) const FEEDFORWARD: ParamGroup = ParamGroup::new(
    "feedforward",
    &[
        ParamId::StaticLeftForward,
        ParamId::StaticLeftBackward,
        ParamId::StaticRightForward,
        ParamId::StaticRightBackward,
        ParamId::Velocity,
        ParamId::Acceleration,
        ParamId::Kick,
    ],
);
/// How fast the wheels' references may change.
pub(super) const WHEEL_RAMPS: ParamGroup = ParamGroup::new(
    "ramps of the wheels",
    &[ParamId::WheelAccel, ParamId::WheelDecel],
);
/// Way to the goal, and speed by the wheels: names for the equation of [`crate::motion::Line`].
pub(super) const fn way(states: &'static [u8]) -> [Law; 2] {
    [
        Law::new(
            "left_m",
            "sqrt((goal_x_m - x_m) * (goal_x_m - x_m) + (goal_y_m - y_m) * (goal_y_m - y_m))",
        )
        .only_in(states),
        Law::new(
            "speed_m_s",
            "max(0, left_rad_s * radius_left_m + right_rad_s * radius_right_m) / 2",
        )
        .only_in(states),
    ]
}

/// The yaw rate of [`crate::motion::Line`].
pub(super) const fn steering(states: &'static [u8]) -> Law {
    Law::new(
        "yaw_ref_rad_s",
        "clamp(line_heading_kp * heading_error_rad, \
         -1.2 * abs(forward_ref_m_s) / base_m, 1.2 * abs(forward_ref_m_s) / base_m)",
    )
    .with(&[ParamId::LineCross])
    .only_in(states)
}

/// The yaw rate of [`crate::motion::Turn`].
pub(super) const fn turning(states: &'static [u8]) -> Law {
    Law::new(
        "yaw_ref_rad_s",
        "sign(heading_error_rad) * max(0.06 / base_m, min(turn_rate_rad_s, \
         sqrt(2 * turn_brake_rad_s2 * abs(heading_error_rad))))",
    )
    .with(&[ParamId::SpeedLag])
    .only_in(states)
}

/// From the robot's motion to its wheels ([`crate::odometry`]).
pub(super) const TWIST: &[Law] = &[
    Law::new(
        "left_ref_rad_s",
        "(forward_ref_m_s - yaw_ref_rad_s * base_m / 2) / radius_left_m",
    ),
    Law::new(
        "right_ref_rad_s",
        "(forward_ref_m_s + yaw_ref_rad_s * base_m / 2) / radius_right_m",
    ),
];
/// Of each wheel ([`crate::drive`]).
pub(super) const SPEED: &[Law] = &[
    Law::new(
        "left_pwm",
        "clamp(left_feedforward_pwm + left_p_pwm + left_i_pwm + left_d_pwm, -255, 255)",
    )
    .with(&[
        ParamId::SpeedKpLeft,
        ParamId::SpeedKiLeft,
        ParamId::SpeedKdLeft,
        ParamId::Velocity,
    ]),
    Law::new(
        "right_pwm",
        "clamp(right_feedforward_pwm + right_p_pwm + right_i_pwm + right_d_pwm, -255, 255)",
    )
    .with(&[
        ParamId::SpeedKpRight,
        ParamId::SpeedKiRight,
        ParamId::SpeedKdRight,
        ParamId::Velocity,
    ]),
];
/// Of [`crate::motion::Turn`].
pub(super) const TURNS: ParamGroup = ParamGroup::new(
    "turns on the spot",
    &[
        ParamId::TurnRate,
        ParamId::TurnTolerance,
        ParamId::TurnBrake,
        ParamId::TurnCoast,
    ],
);
/// Of [`crate::motion::Line`].
pub(super) const LINES: ParamGroup = ParamGroup::new(
    "straight lines",
    &[
        ParamId::LineCruise,
        ParamId::LineTolerance,
        ParamId::LineCross,
        ParamId::LineHeading,
        ParamId::LineAccel,
        ParamId::LineBrake,
        ParamId::LineCoast,
        ParamId::SpeedLag,
    ],
);

/// Declares the states of a mode: an enum for the mode's code, and `STATES` for its [`Description`]. Each state: what
/// the robot does in it, its name, and the states that may follow with their conditions. Numbers follow the order.
macro_rules! states {
    (
        $(#[$meta:meta])*
        $vis:vis enum $phase:ident {
            $( #[doc = $does:literal] $( #[$default:ident] )? $state:ident = $name:literal { $( $to:ident: $when:literal ),* $(,)? } )+
        }
    ) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        #[repr(u8)]
        $vis enum $phase { $( #[doc = $does] $( #[$default] )? $state, )+ }

        /// The states, by number.
        pub(super) const STATES: &[$crate::mode::StateDescription] = &[ $(
            $crate::mode::StateDescription {
                name: $name,
                does: $does.trim_ascii(),
                ways: &[ $( $crate::mode::Transition { to: $phase::$to as u8, when: $when } ),* ],
            },
        )+ ];
    };
}
pub(super) use states;
