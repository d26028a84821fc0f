//! What commands and answers are called, for people: cm, rpm and % instead of SI.

use crate::anomaly::Anomaly;
use crate::client::NotTaken;
use crate::commands::{Fate, Outcome};
use rumbo_control::Velocity;
use rumbo_control::mode::twist::{MAX_FORWARD_M_S, MAX_YAW_RAD_S};
use rumbo_control::mode::{ModeId, Movement, Reference, ReferenceKind, SetpointError};
use rumbo_control::params::ParamId;
use rumbo_log::parameter;

use rumbo_control::mode::waypoints::{FARTHEST_M, MAX_WAYPOINTS};
use rumbo_wire::message::Waypoint;
use rumbo_wire::{Command, Level, PROTOCOL_VERSION, Refusal};
use std::f32::consts::TAU;

fn rpm(speed_rad_s: f32) -> f32 {
    speed_rad_s * 60.0 / TAU
}

/// The command in words; `mode` gives a reference its unit.
pub(crate) fn command(command: &Command, mode: ModeId) -> String {
    match command {
        Command::Stop => "STOP".into(),
        Command::Arm => "ON".into(),
        Command::Disarm => "OFF".into(),
        Command::ClearFault => "clear the fault".into(),
        Command::Mode(mode) => format!("mode {} {}", *mode as u8, mode.name()),
        Command::Reference(value) => match mode.takes_reference() {
            Some(ReferenceKind::WheelSpeed | ReferenceKind::Speed) => {
                format!("setpoint {:.0} rpm", rpm(*value))
            }
            _ => format!("setpoint {:.1} cm", value * 100.0),
        },
        Command::WheelReference(wheels) => {
            format!(
                "setpoints left {:.0} rpm, right {:.0} rpm",
                rpm(wheels.left),
                rpm(wheels.right)
            )
        }
        Command::Move {
            movement,
            level: Level::Duty(duty),
        } => {
            let movement = movement_words(*movement);
            format!("movement {movement} with {:.0} % PWM", duty * 100.0)
        }
        Command::Move {
            movement,
            level: Level::Speed(speed_rad_s),
        } => {
            let movement = movement_words(*movement);
            format!("movement {movement} at {:.0} rpm", rpm(*speed_rad_s))
        }
        Command::SetParam { id, value } => {
            let kind = ParamId::from_number(*id).map(ParamId::kind);
            match kind.and_then(|kind| kind.name_of(*value)) {
                Some(name) => format!("{} = {name}", parameter_name(*id)),
                None => format!("{} = {value}", parameter_name(*id)),
            }
        }
        Command::GetParam { id } => format!("read {}", parameter_name(*id)),
        Command::ResetParams => "all parameters to their defaults".into(),
        Command::SaveParams => "save the parameters on the robot".into(),
        Command::ResetPose => "the current position is the origin".into(),
        Command::Goal { x_m, y_m } => format!("goal ({x_m:.2}, {y_m:.2}) m"),
        Command::Lane => "follow the lane".into(),
        Command::Route { repeat, .. } => {
            let how = if *repeat { "again and again" } else { "once" };
            format!("a new route, {how}")
        }
        Command::Waypoint(Waypoint { x_m, y_m, .. }) => {
            format!("waypoint ({x_m:.2}, {y_m:.2}) m")
        }
    }
}

/// The velocity in words.
pub(crate) fn velocity(velocity: Velocity) -> String {
    let Velocity {
        forward_m_s,
        yaw_rad_s,
    } = velocity;
    format!("velocity {forward_m_s:.2} m/s, {yaw_rad_s:.2} rad/s")
}

/// Why a velocity is refused.
pub(crate) fn bad_velocity(why: SetpointError) -> String {
    let what = match why {
        SetpointError::NotFinite => "not a number",
        _ => "out of range",
    };
    format!("{what}: up to {MAX_FORWARD_M_S} m/s and {MAX_YAW_RAD_S} rad/s either way")
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

/// How a command ended, in words.
pub(crate) fn outcome(outcome: &Outcome, mode: ModeId) -> String {
    let asked = command(&outcome.command, mode);
    match outcome.fate {
        Fate::Applied(_) => format!("{asked}: acknowledged"),
        Fate::Refused(why) => {
            let why = refusal(why, &outcome.command, mode);
            format!("{asked}: refused, {why}")
        }
        Fate::Superseded => format!("{asked}: given up, STOP or OFF came after it"),
        Fate::Expired => format!("{asked}: given up, the robot did not answer in time"),
        Fate::RobotRestarted => format!("{asked}: given up, the robot started again"),
        Fate::LinkLost => format!("{asked}: given up, the link was lost; it is not sent later"),
    }
}

/// STOP that the robot does not acknowledge, or does not obey.
pub(crate) const STOP_UNCONFIRMED: &str =
    "ALARM: the robot does not confirm STOP; switch off its battery";

/// An alarm about an anomaly.
pub(crate) fn alarm(anomaly: Anomaly) -> String {
    format!("ALARM: {}", anomaly.explanation())
}

/// Why the station did not take a command.
pub(crate) const fn not_taken(why: NotTaken) -> &'static str {
    match why {
        NotTaken::NotConnected => {
            "no robot answers; check that it is on and in reach, then give the order again"
        }
        NotTaken::QueueFull => "too many commands wait for the robot",
    }
}

/// The robot speaks another version of the protocol.
pub(crate) fn other_protocol(protocol: u8) -> String {
    format!(
        "the robot speaks protocol {protocol}, this station {PROTOCOL_VERSION}: flash the robot or update the station"
    )
}

/// Why the robot refused, with what is allowed where that is known here.
pub(crate) fn refusal(why: Refusal, command: &Command, mode: ModeId) -> String {
    match (why, command) {
        (Refusal::OutOfRange, Command::SetParam { id, .. }) => match parameter(*id) {
            Some(entry) if !entry.choices.is_empty() => {
                format!("allowed is one of {}", entry.choices.join(", "))
            }
            Some(entry) => format!("allowed is {} to {} {}", entry.min, entry.max, entry.unit),
            None => "out of range".into(),
        },
        (
            Refusal::OutOfRange,
            Command::Reference(_) | Command::WheelReference(_) | Command::Goal { .. },
        ) => allowed(mode).unwrap_or_else(|| why.explanation().into()),
        (Refusal::OutOfRange, Command::Waypoint(_)) => format!(
            "allowed is -{FARTHEST_M} to {FARTHEST_M} m for each coordinate, and {MAX_WAYPOINTS} waypoints"
        ),
        _ => why.explanation().into(),
    }
}

/// What the mode's reference may be.
fn allowed(mode: ModeId) -> Option<String> {
    let Reference { kind, min, max, .. } = mode.description().reference?;
    Some(match kind {
        ReferenceKind::Distance => {
            format!("allowed is {:.1} to {:.1} cm", min * 100.0, max * 100.0)
        }
        ReferenceKind::WheelSpeed | ReferenceKind::Speed => {
            format!("allowed is {:.0} to {:.0} rpm", rpm(min), rpm(max))
        }
        ReferenceKind::Goal => format!("allowed is {min} to {max} m for each coordinate"),
    })
}

fn parameter_name(id: u8) -> String {
    parameter(id).map_or_else(|| format!("parameter {id}"), |entry| entry.name.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parameter_that_is_a_choice_or_a_switch_is_named_with_its_value() {
        let set = |id: ParamId, value| {
            let command = Command::SetParam {
                id: id as u8,
                value,
            };
            (
                super::command(&command, ModeId::Manual),
                refusal(Refusal::OutOfRange, &command, ModeId::Manual),
            )
        };
        assert_eq!(set(ParamId::Rig, 4.0).0, "rig = final");
        let (said, why) = set(ParamId::MissionResetOrigin, 0.0);
        assert_eq!(said, "mission_reset_origin = no");
        assert_eq!(why, "allowed is one of no, yes");
        assert_eq!(set(ParamId::Rig, 9.0).0, "rig = 9");
        assert_eq!(set(ParamId::Velocity, 0.5).0, "kv = 0.5");
    }

    #[test]
    fn a_value_out_of_range_is_refused_with_what_is_allowed_in_the_mode() {
        let goal = Command::Goal {
            x_m: 90.0,
            y_m: 0.0,
        };
        for (command, mode, allowed) in [
            (
                Command::Reference(9.0),
                ModeId::FrontDistance,
                "5.0 to 200.0 cm",
            ),
            (
                Command::Reference(9.0),
                ModeId::WallFollow,
                "10.0 to 150.0 cm",
            ),
            (
                Command::Reference(99.0),
                ModeId::StraightLine,
                "-191 to 191 rpm",
            ),
            (goal, ModeId::Mission, "-20 to 20 m for each coordinate"),
        ] {
            let said = refusal(Refusal::OutOfRange, &command, mode);
            assert_eq!(said, format!("allowed is {allowed}"));
        }
    }
}
