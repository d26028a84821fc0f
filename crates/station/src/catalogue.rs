//! What there is to choose and to set: modes, movements and parameters, as the page gets them.

use rumbo_control::mode::{
    MAX_DISTANCE_M, MAX_WALL_M, MAX_WHEEL_RAD_S, MIN_DISTANCE_M, MIN_WALL_M, ModeId,
};
use rumbo_control::params::{Limits, ParamId};
use serde::Serialize;

/// A parameter of the table, with its value as far as it is known.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct ParameterState {
    #[serde(flatten)]
    pub(crate) entry: Entry,
    /// The value the robot acknowledged.
    pub(crate) value: Option<f32>,
    /// A new value is on its way.
    pub(crate) pending: bool,
    /// Why the last write failed.
    pub(crate) refused: Option<String>,
}

/// What the table says of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct Entry {
    pub(crate) id: u8,
    pub(crate) name: &'static str,
    pub(crate) unit: &'static str,
    pub(crate) min: f32,
    pub(crate) max: f32,
    pub(crate) default: f32,
    /// The mode it belongs to; `None` for all.
    pub(crate) mode: Option<u8>,
    pub(crate) description: &'static str,
}

/// The whole table, in the order of the numbers.
pub(crate) fn table() -> impl Iterator<Item = Entry> {
    ParamId::ALL.into_iter().map(describe)
}

/// The parameter with this number.
pub(crate) fn entry(id: u8) -> Option<Entry> {
    ParamId::from_number(id).map(describe)
}

fn describe(id: ParamId) -> Entry {
    let Limits { min, max, default } = id.limits();
    Entry {
        id: id as u8,
        name: id.name(),
        // People write a pure number without a unit.
        unit: if id.unit() == "1" { "" } else { id.unit() },
        min,
        max,
        default,
        mode: id.mode().map(|mode| mode as u8),
        description: id.help(),
    }
}

/// A mode to choose.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct ModeEntry {
    id: u8,
    name: &'static str,
    /// What its reference is, if it takes one.
    reference: Option<Reference>,
    /// Takes basic movements.
    movements: bool,
    states: &'static [&'static str],
}

/// A mode's reference.
#[derive(Clone, Copy, Debug, Serialize)]
struct Reference {
    kind: ReferenceKind,
    min: f32,
    max: f32,
}

/// What a mode's reference is, in SI units.
#[derive(Clone, Copy, Debug, Serialize)]
#[serde(rename_all = "snake_case")]
enum ReferenceKind {
    /// A distance in metres.
    Distance,
    /// A speed of each wheel in rad/s.
    WheelSpeed,
}

/// The modes to choose from.
pub(crate) fn modes() -> Vec<ModeEntry> {
    ModeId::ALL.into_iter().map(mode_entry).collect()
}

fn mode_entry(mode: ModeId) -> ModeEntry {
    ModeEntry {
        id: mode as u8,
        name: mode.name(),
        reference: match mode {
            ModeId::Manual | ModeId::WallHold | ModeId::Waypoints | ModeId::Mission => None,
            ModeId::WallFollow => Some(Reference {
                kind: ReferenceKind::Distance,
                min: MIN_WALL_M,
                max: MAX_WALL_M,
            }),
            ModeId::FrontDistance | ModeId::FrontAlign => Some(Reference {
                kind: ReferenceKind::Distance,
                min: MIN_DISTANCE_M,
                max: MAX_DISTANCE_M,
            }),
            ModeId::WheelSpeed | ModeId::StraightLine => Some(Reference {
                kind: ReferenceKind::WheelSpeed,
                min: -MAX_WHEEL_RAD_S,
                max: MAX_WHEEL_RAD_S,
            }),
        },
        movements: mode == ModeId::Manual,
        states: mode.state_names(),
    }
}
