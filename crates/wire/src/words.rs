//! Commands in words, for people: cm, rpm and % instead of SI.

use crate::message::{Command, MovementLevel, Waypoint};
use crate::text::RAD_S_PER_RPM;
use core::fmt;
use rumbo_control::mode::{ModeId, Movement, ReferenceKind};
use rumbo_control::params::ParamId;

impl Command {
    /// The commands without a value that a person gives, as pages, links and files name them.
    pub const NAMED: [(&'static str, Command); 8] = [
        ("stop", Command::Stop),
        ("arm", Command::Arm),
        ("disarm", Command::Disarm),
        ("clear_fault", Command::ClearFault),
        ("lane", Command::Lane),
        ("reset_params", Command::ResetParams),
        ("save_params", Command::SaveParams),
        ("reset_pose", Command::ResetPose),
    ];

    /// What a cut-off at the supply of the motors, as an emergency button is, makes of it: STOP and OFF cut (`false`), ON
    /// closes.
    #[must_use]
    pub const fn supplies_motors(&self) -> Option<bool> {
        match self {
            Self::Stop | Self::Disarm => Some(false),
            Self::Arm => Some(true),
            _ => None,
        }
    }

    /// The command in words; `mode` gives a reference its unit.
    #[must_use]
    pub fn in_words(&self, mode: ModeId) -> impl fmt::Display {
        InWords(*self, mode)
    }
}

struct InWords(Command, ModeId);

impl fmt::Display for InWords {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(command, mode) = self;
        match *command {
            Command::Stop => f.write_str("STOP"),
            Command::Arm => f.write_str("ON"),
            Command::Disarm => f.write_str("OFF"),
            Command::ClearFault => f.write_str("clear the fault"),
            Command::Mode(mode) => write!(f, "mode {} {}", mode as u8, mode.name()),
            Command::Reference(value) => match mode.takes_reference() {
                Some(ReferenceKind::WheelSpeed | ReferenceKind::Speed) => {
                    write!(f, "setpoint {:.0} rpm", rpm(value))
                }
                _ => write!(f, "setpoint {:.1} cm", value * 100.0),
            },
            Command::WheelReference(wheels) => {
                let [left, right] = [wheels.left, wheels.right].map(rpm);
                write!(f, "setpoints left {left:.0} rpm, right {right:.0} rpm")
            }
            Command::Move { movement, level } => {
                let movement = movement_words(movement);
                match level {
                    MovementLevel::Duty(duty) => {
                        write!(f, "movement {movement} with {:.0} % PWM", duty * 100.0)
                    }
                    MovementLevel::Speed(speed_rad_s) => {
                        write!(f, "movement {movement} at {:.0} rpm", rpm(speed_rad_s))
                    }
                }
            }
            Command::SetParam { id, value } => {
                let kind = ParamId::from_number(id).map(ParamId::kind);
                match kind.and_then(|kind| kind.name_of(value)) {
                    Some(name) => write!(f, "{} = {name}", Parameter(id)),
                    None => write!(f, "{} = {value}", Parameter(id)),
                }
            }
            Command::GetParam { id } => write!(f, "read {}", Parameter(id)),
            Command::ResetParams => f.write_str("all parameters to their defaults"),
            Command::SaveParams => f.write_str("save the parameters on the robot"),
            Command::ResetPose => f.write_str("the current position is the origin"),
            Command::Goal { x_m, y_m } => write!(f, "goal ({x_m:.2}, {y_m:.2}) m"),
            Command::Lane => f.write_str("follow the lane"),
            Command::Route { repeat, .. } => {
                let how = if repeat { "again and again" } else { "once" };
                write!(f, "a new route, {how}")
            }
            Command::Waypoint(Waypoint { x_m, y_m, .. }) => {
                write!(f, "waypoint ({x_m:.2}, {y_m:.2}) m")
            }
        }
    }
}

/// A parameter's name; of one that is not known its number.
struct Parameter(u8);

impl fmt::Display for Parameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match ParamId::from_number(self.0) {
            Some(id) => f.write_str(id.name()),
            None => write!(f, "parameter {}", self.0),
        }
    }
}

fn rpm(speed_rad_s: f32) -> f32 {
    speed_rad_s / RAD_S_PER_RPM
}

/// A movement by the name of its button.
fn movement_words(movement: Movement) -> &'static str {
    match movement {
        Movement::Stop => "release both wheels",
        Movement::Forward => "forward",
        Movement::Backward => "backward",
        Movement::TurnLeft => "turn left about the centre",
        Movement::TurnRight => "turn right about the centre",
        Movement::PivotLeftForward => "pivot on the left wheel, forward",
        Movement::PivotLeftBackward => "pivot on the left wheel, backward",
        Movement::PivotRightForward => "pivot on the right wheel, forward",
        Movement::PivotRightBackward => "pivot on the right wheel, backward",
        Movement::ArcLeft => "arc left",
        Movement::ArcRight => "arc right",
        Movement::ArcLeftBackward => "arc backward, centre on the left",
        Movement::ArcRightBackward => "arc backward, centre on the right",
    }
}
