//! Why a search cannot begin, or has ended.

use super::limits;
use crate::files::FileError;
use rumbo_control::params::ParamId;
use std::fmt;

/// Why nothing is tuned.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TuneError {
    /// A parameter is given twice.
    Twice(String),
    /// A switch or a choice.
    NoNumber(ParamId),
    /// The range is not within the parameter's limits.
    Range(ParamId),
    /// A list or a count, where a range is needed.
    Form(String),
    /// Fewer runs than a search needs.
    Budget(usize),
    /// A scenario without limits, and no aim.
    NoAim(String),
    /// The search drives the robot of a seed on which its values are to be checked.
    Seen(u64),
    /// It was ended before it was done.
    Ended,
}

impl fmt::Display for TuneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Twice(name) => write!(f, "{name} is given twice; give it once"),
            Self::NoNumber(id) => write!(
                f,
                "{}: is a switch or a choice; compare its values with `rumbo compare`",
                id.name()
            ),
            Self::Range(id) => write!(
                f,
                "{}: its range must lie within {}..{} {}",
                id.name(),
                limits(*id)[0],
                limits(*id)[1],
                id.unit()
            ),
            Self::Form(name) => write!(
                f,
                "{name}: is searched in a range; write {name} or {name}=FROM:TO"
            ),
            Self::Budget(least) => write!(f, "a search needs at least {least} runs"),
            Self::Seen(seed) => write!(
                f,
                "seed {seed}: the search drives that robot; check on consecutive seeds, or on fewer that are near each other"
            ),
            Self::NoAim(scenario) => write!(
                f,
                "scenario {scenario} has no limits; give an aim, such as `settling_s`"
            ),
            Self::Ended => f.write_str("the search was ended"),
        }
    }
}

impl std::error::Error for TuneError {}

impl From<TuneError> for FileError {
    fn from(error: TuneError) -> Self {
        Self::Setting(error.to_string())
    }
}
