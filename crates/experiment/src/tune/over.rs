//! What to search over: `front_kp`, or within a range `front_kp=1:20`; and what there is to choose from.

use crate::files::parameters::exact;
use crate::files::{FileError, ScenarioFile, Setup, unknown};
use crate::sweep::Axis;
use rumbo_control::params::{ParamId, ParamKind};
use rumbo_plant::params::Params;

/// What to search over: names, or axes `NAME=FROM:TO`.
#[derive(Clone, Debug, PartialEq)]
pub enum Over {
    /// About the start's value.
    Name(ParamId),
    /// Within a range.
    Range(ParamId, Axis),
}

impl std::str::FromStr for Over {
    type Err = FileError;

    fn from_str(text: &str) -> Result<Self, FileError> {
        let name = text.split_once('=').map_or(text, |(name, _)| name).trim();
        let Some(id) = ParamId::from_name(name) else {
            if Params::limits().iter().any(|limit| limit.key == name) {
                return Err(FileError::Setting(format!(
                    "{name}: is a number of the plant, which no program changes; `rumbo sweep` shows what it does"
                )));
            }
            let known = ParamId::ALL.map(ParamId::name);
            return Err(unknown("parameter of the control core", name, known));
        };
        let range = || text.parse::<Axis>();
        match text.contains('=') {
            false => Ok(Self::Name(id)),
            true => range()
                .map(|axis| Self::Range(id, axis))
                .map_err(|error| FileError::Setting(error.to_string())),
        }
    }
}

impl Over {
    /// The parameter.
    #[must_use]
    pub fn id(&self) -> ParamId {
        match self {
            Self::Name(id) | Self::Range(id, _) => *id,
        }
    }

    /// Refuses a parameter that the scenario's file sets, in vain.
    ///
    /// # Errors
    /// The parameter and the remedy.
    pub fn check(&self, scenario: &ScenarioFile) -> Result<(), FileError> {
        match scenario.parameters.iter().any(|(own, _)| *own == self.id()) {
            true => Err(FileError::Setting(format!(
                "{}: scenario {} sets it itself, whatever a robot file says; take it out of the scenario",
                self.id().name(),
                scenario.name
            ))),
            false => Ok(()),
        }
    }
}

/// Parameters of one subject that can be tuned.
#[derive(Clone, Debug, PartialEq)]
pub struct Tunable {
    /// The subject.
    pub title: &'static str,
    /// The parameters, with their present values.
    pub parameters: Vec<(ParamId, f64)>,
}

/// The parameters to choose from in a setup, those that matter most first: the numbers that its mode uses, without those
/// that its scenario sets itself. `own` is the scenario as its file has it.
///
/// # Errors
/// A setup whose values do not fit together.
pub fn tunable(setup: &Setup, own: &ScenarioFile) -> Result<Vec<Tunable>, FileError> {
    let now = setup.params()?;
    let groups = setup.scenario.mode.description().parameters.iter();
    let groups = groups.map(|group| {
        let numbers = group.parameters.iter();
        let numbers = numbers
            .filter(|id| id.kind() == ParamKind::Number && Over::Name(**id).check(own).is_ok());
        Tunable {
            title: group.title,
            parameters: numbers.map(|id| (*id, exact(now.get(*id)))).collect(),
        }
    });
    Ok(groups
        .filter(|group| !group.parameters.is_empty())
        .collect())
}
