//! Commands of the original text protocol, in the units of the core.

use rumbo_control::mode::{ModeId, Reference, ReferenceKind};
use rumbo_control::params::ParamId;
use rumbo_control::{Duty, Side};
use rumbo_wire::text::{CM_PER_M, RAD_S_PER_RPM, TextCommand};
use rumbo_wire::{Command, Refusal};

/// Duty per rad/s in a gain of one PWM count per rpm.
const GAIN_PER_PWM_PER_RPM: f32 = 1.0 / (255.0 * RAD_S_PER_RPM);
const _: () = assert!(Duty::MAX == 255);

/// What a line requests.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Translated {
    /// The same as this command.
    Command(Command),
    /// These parameters at once.
    Params([(ParamId, f32); 3]),
}

/// Translates a line; the meaning of `REF` depends on the mode, and `REF A` keeps the left wheel's `reference`.
///
/// # Errors
/// The mode has no such command, or there is no such mode.
pub(crate) fn translate(
    command: TextCommand,
    mode: ModeId,
    reference: Reference,
) -> Result<Translated, Refusal> {
    let command = match command {
        TextCommand::On => Command::Arm,
        TextCommand::Off => Command::Disarm,
        TextCommand::Save => Command::SaveParams,
        TextCommand::Reset => Command::ResetParams,
        TextCommand::Reference(value) => match mode.takes_reference() {
            Some(ReferenceKind::Distance) => Command::Reference(value / CM_PER_M),
            Some(ReferenceKind::WheelSpeed | ReferenceKind::Speed) => {
                Command::Reference(value * RAD_S_PER_RPM)
            }
            Some(ReferenceKind::Goal) | None => return Err(Refusal::NotInThisMode),
        },
        TextCommand::WheelReference(side, rpm) => {
            let Reference::Wheels(mut wheels) = reference else {
                return Err(Refusal::NotInThisMode);
            };
            wheels[side] = rpm * RAD_S_PER_RPM;
            Command::WheelReference(wheels)
        }
        TextCommand::Goal { x_m, y_m } => Command::Goal { x_m, y_m },
        TextCommand::Mode(number) => {
            Command::Mode(ModeId::from_number(number).ok_or(Refusal::OutOfRange)?)
        }
        TextCommand::Gains { side, kp, ki, kd } => {
            let [kp_id, ki_id, kd_id] = match side {
                Side::Left => [
                    ParamId::SpeedKpLeft,
                    ParamId::SpeedKiLeft,
                    ParamId::SpeedKdLeft,
                ],
                Side::Right => [
                    ParamId::SpeedKpRight,
                    ParamId::SpeedKiRight,
                    ParamId::SpeedKdRight,
                ],
            };
            let gain = |id, value| (id, value * GAIN_PER_PWM_PER_RPM);
            return Ok(Translated::Params([
                gain(kp_id, kp),
                gain(ki_id, ki),
                gain(kd_id, kd),
            ]));
        }
    };
    Ok(Translated::Command(command))
}
