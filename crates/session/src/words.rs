//! What commands and answers are called, for people: cm, rpm and % instead of SI.

use crate::anomaly::Anomaly;
use crate::client::NotTaken;
use crate::commands::{CommandOutcome, Fate};
use rumbo_control::Velocity;
use rumbo_control::mode::twist::{MAX_FORWARD_M_S, MAX_YAW_RAD_S};
use rumbo_control::mode::{ModeId, ReferenceDescription, ReferenceKind, SetpointError};
use rumbo_log::parameter;

use rumbo_control::mode::waypoints::{FARTHEST_M, MAX_WAYPOINTS};
use rumbo_wire::text::RAD_S_PER_RPM;
use rumbo_wire::{Command, PROTOCOL_VERSION, Refusal};

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

/// How a command ended, in words.
pub(crate) fn outcome(outcome: &CommandOutcome, mode: ModeId) -> String {
    let asked = outcome.command.in_words(mode);
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

/// STOP or OFF, where the supply of the motors can be cut.
pub(crate) const MOTORS_CUT: &str =
    "{}: the motors have no supply, whatever the program does; ON gives it back";

/// ON after that.
pub(crate) const MOTORS_SUPPLIED: &str =
    "ON: the motors have their supply again; the program was told, too";

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
    let ReferenceDescription { kind, min, max, .. } = mode.description().reference?;
    Some(match kind {
        ReferenceKind::Distance => {
            format!("allowed is {:.1} to {:.1} cm", min * 100.0, max * 100.0)
        }
        ReferenceKind::WheelSpeed | ReferenceKind::Speed => {
            let [min, max] = [min, max].map(|speed_rad_s| speed_rad_s / RAD_S_PER_RPM);
            format!("allowed is {min:.0} to {max:.0} rpm")
        }
        ReferenceKind::Goal => format!("allowed is {min} to {max} m for each coordinate"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rumbo_control::params::ParamId;

    #[test]
    fn a_parameter_that_is_a_choice_or_a_switch_is_named_with_its_value() {
        let set = |id: ParamId, value| {
            let command = Command::SetParam {
                id: id as u8,
                value,
            };
            (
                command.in_words(ModeId::Manual).to_string(),
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
