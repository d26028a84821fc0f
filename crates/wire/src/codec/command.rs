//! Commands to bytes and back.

use crate::bytes::{Reader, Writer};
use crate::malformed::Malformed;
use crate::message::*;
use rumbo_control::Wheels;
use rumbo_control::mode::{ModeId, Movement, MovementLevel};

/// `level` as a byte for the kind and the value.
const LEVEL_DUTY: u8 = 0;
const LEVEL_SPEED: u8 = 1;

pub(super) fn put_command(to: &mut Writer, command: &Command) {
    match command {
        Command::Stop => to.put([1]),
        Command::Arm => to.put([2]),
        Command::Disarm => to.put([3]),
        Command::ClearFault => to.put([4]),
        Command::Mode(mode) => to.put([5, *mode as u8]),
        Command::Reference(value) => to.put([6]).put(value.to_le_bytes()),
        Command::WheelReference(wheels) => to
            .put([7])
            .put(wheels.left.to_le_bytes())
            .put(wheels.right.to_le_bytes()),
        Command::Move { movement, level } => {
            let (which, value) = match level {
                MovementLevel::Duty(value) => (LEVEL_DUTY, value),
                MovementLevel::Speed(value) => (LEVEL_SPEED, value),
            };
            to.put([8, *movement as u8, which]).put(value.to_le_bytes())
        }
        Command::SetParam { id, value } => to.put([9, *id]).put(value.to_le_bytes()),
        Command::GetParam { id } => to.put([10, *id]),
        Command::ResetParams => to.put([11]),
        Command::ResetPose => to.put([12]),
        Command::Goal { x_m, y_m } => to.put([13]).put(x_m.to_le_bytes()).put(y_m.to_le_bytes()),
        Command::Lane => to.put([14]),
        Command::Route { repeat, relative } => {
            to.put([15, u8::from(*repeat) | u8::from(*relative) << 1])
        }
        Command::Waypoint(Waypoint {
            x_m,
            y_m,
            heading_rad,
        }) => {
            to.put([16])
                .put(x_m.to_le_bytes())
                .put(y_m.to_le_bytes())
                .put([u8::from(heading_rad.is_some())]);
            to.put(heading_rad.unwrap_or(0.0).to_le_bytes())
        }
        Command::SaveParams => to.put([17]),
    };
}

pub(super) fn command(from: &mut Reader) -> Result<Command, Malformed> {
    Ok(match from.u8() {
        1 => Command::Stop,
        2 => Command::Arm,
        3 => Command::Disarm,
        4 => Command::ClearFault,
        5 => Command::Mode(mode(from)?),
        6 => Command::Reference(from.f32()),
        7 => Command::WheelReference(Wheels {
            left: from.f32(),
            right: from.f32(),
        }),
        8 => Command::Move {
            movement: Movement::from_number(from.u8()).ok_or(from.wrong())?,
            level: match from.u8() {
                LEVEL_DUTY => MovementLevel::Duty(from.f32()),
                LEVEL_SPEED => MovementLevel::Speed(from.f32()),
                _ => return Err(from.wrong()),
            },
        },
        9 => Command::SetParam {
            id: from.u8(),
            value: from.f32(),
        },
        10 => Command::GetParam { id: from.u8() },
        11 => Command::ResetParams,
        12 => Command::ResetPose,
        13 => Command::Goal {
            x_m: from.f32(),
            y_m: from.f32(),
        },
        14 => Command::Lane,
        15 => {
            let flags = from.u8();
            Command::Route {
                repeat: flags & 1 != 0,
                relative: flags & 2 != 0,
            }
        }
        16 => {
            let (x_m, y_m) = (from.f32(), from.f32());
            let has_heading = from.u8() != 0;
            let heading_rad = from.f32();
            Command::Waypoint(Waypoint {
                x_m,
                y_m,
                heading_rad: has_heading.then_some(heading_rad),
            })
        }
        17 => Command::SaveParams,
        _ => return Err(from.wrong()),
    })
}

pub(super) fn mode(from: &mut Reader) -> Result<ModeId, Malformed> {
    ModeId::from_number(from.u8()).ok_or(from.wrong())
}
