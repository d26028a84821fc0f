//! The table of parameters, as pages and logs have it.

use rumbo_control::params::{ParamId, ParamLimits};
use serde::Serialize;

/// A parameter of the table, with its value as far as it is known.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ParameterState {
    /// What the table says of it.
    #[serde(flatten)]
    pub entry: Parameter,
    /// The value the robot acknowledged.
    pub value: Option<f32>,
    /// A new value is on its way.
    pub pending: bool,
    /// Why the last write failed.
    pub refused: Option<String>,
}

/// What the table says of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Parameter {
    /// Its number.
    pub id: u8,
    /// Its name.
    pub name: &'static str,
    /// Its unit; empty for a pure number.
    pub unit: &'static str,
    /// Least value.
    pub min: f32,
    /// Greatest value.
    pub max: f32,
    /// Its value on a new robot.
    pub default: f32,
    /// `number`, `switch` or `choice`.
    #[serde(rename = "type")]
    pub kind: &'static str,
    /// Names of the values 0, 1, ... of a switch or a choice.
    pub choices: &'static [&'static str],
    /// It belongs to the robot, whatever its mode; otherwise to modes, which list it.
    pub of_robot: bool,
    /// What it does.
    pub description: &'static str,
}

/// The whole table, in the order of the numbers.
pub fn parameters() -> impl Iterator<Item = Parameter> {
    ParamId::ALL.into_iter().map(describe)
}

/// The parameter with this number.
#[must_use]
pub fn parameter(id: u8) -> Option<Parameter> {
    ParamId::from_number(id).map(describe)
}

fn describe(id: ParamId) -> Parameter {
    let ParamLimits { min, max, default } = id.limits();
    Parameter {
        id: id as u8,
        name: id.name(),
        // People write a pure number without a unit.
        unit: if id.unit() == "1" { "" } else { id.unit() },
        min,
        max,
        default,
        kind: id.kind().name(),
        choices: id.kind().names(),
        of_robot: id.modes().next().is_none(),
        description: id.help(),
    }
}
