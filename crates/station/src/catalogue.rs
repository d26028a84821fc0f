//! What there is to choose and to set: modes, movements and parameters, as the page and `rumbo list` get them.

use rumbo_control::mode::waypoints::{FARTHEST_M, MAX_WAYPOINTS};
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
#[derive(Clone, Debug, Serialize)]
pub struct ModeEntry {
    /// Its number.
    pub id: u8,
    /// Its name in files and commands.
    pub name: &'static str,
    /// What it does, in a few words.
    pub about: &'static str,
    /// What its reference is, if it takes one.
    pub reference: Option<Reference>,
    /// Takes basic movements.
    pub movements: bool,
    /// Takes a route of at most so many places.
    pub route: Option<usize>,
    /// Follows a lane on command.
    pub lane: bool,
    /// The names of its states, by the number in the telemetry.
    pub states: &'static [&'static str],
    /// The ways between them: from, to, when.
    pub ways: Vec<(u8, u8, &'static str)>,
}

/// A mode's reference.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Reference {
    /// What it is.
    pub kind: ReferenceKind,
    /// Smallest allowed value.
    pub min: f32,
    /// Largest allowed value.
    pub max: f32,
}

/// What a mode's reference is, in SI units.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ReferenceKind {
    /// A distance in metres.
    Distance,
    /// A speed of each wheel in rad/s.
    WheelSpeed,
    /// One speed of both wheels in rad/s.
    Speed,
    /// A place: each coordinate in metres.
    Goal,
}

/// The modes to choose from.
pub fn modes() -> Vec<ModeEntry> {
    ModeId::ALL.into_iter().map(mode_entry).collect()
}

/// What a mode's reference may be.
pub(crate) fn reference(mode: ModeId) -> Option<Reference> {
    match mode {
        ModeId::Manual | ModeId::WallHold => None,
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
            kind: if mode == ModeId::WheelSpeed {
                ReferenceKind::WheelSpeed
            } else {
                ReferenceKind::Speed
            },
            min: -MAX_WHEEL_RAD_S,
            max: MAX_WHEEL_RAD_S,
        }),
        ModeId::Waypoints | ModeId::Mission => Some(Reference {
            kind: ReferenceKind::Goal,
            min: -FARTHEST_M,
            max: FARTHEST_M,
        }),
    }
}

fn about(mode: ModeId) -> &'static str {
    match mode {
        ModeId::Manual => "basic movements, open loop or by speed",
        ModeId::FrontDistance => "stop at a distance from the wall ahead",
        ModeId::FrontAlign => "stop square to the wall ahead, at a distance from it",
        ModeId::WallHold => "follow a wall at the distance at which the robot starts",
        ModeId::WallFollow => "follow a wall at a commanded distance",
        ModeId::WheelSpeed => "each wheel at a commanded speed",
        ModeId::StraightLine => "straight on at a commanded speed",
        ModeId::Waypoints => "visit the places of a route in turn, such as a square of 1 m",
        ModeId::Mission => "reach a goal around obstacles, or follow a lane of boxes",
    }
}

fn mode_entry(mode: ModeId) -> ModeEntry {
    ModeEntry {
        id: mode as u8,
        name: mode.name(),
        about: about(mode),
        reference: reference(mode),
        movements: mode == ModeId::Manual,
        route: (mode == ModeId::Waypoints).then_some(MAX_WAYPOINTS),
        lane: mode == ModeId::Mission,
        states: mode.state_names(),
        ways: mode
            .transitions()
            .iter()
            .map(|way| (way.from, way.to, way.when))
            .collect(),
    }
}
