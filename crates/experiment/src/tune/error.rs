//! Why a search cannot begin, or has ended.

use super::limits;
use crate::files::FileError;
use rumbo_control::params::ParamId;
use thiserror::Error;

/// Why nothing is tuned.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum TuneError {
    /// A parameter is given twice.
    #[error("{0} is given twice; give it once")]
    Twice(String),
    /// A switch or a choice.
    #[error("{}: is a switch or a choice; compare its values with `rumbo compare`", .0.name())]
    NoNumber(ParamId),
    /// The range is not within the parameter's limits.
    #[error("{}: its range must lie within {}..{} {}", .0.name(), limits(*.0)[0], limits(*.0)[1], .0.unit())]
    Range(ParamId),
    /// A list or a count, where a range is needed.
    #[error("{0}: is searched in a range; write {0} or {0}=FROM:TO")]
    Form(String),
    /// Fewer runs than a search needs.
    #[error("a search needs at least {0} runs")]
    Budget(usize),
    /// A scenario without limits, and no aim.
    #[error("scenario {0} has no limits; give an aim, such as `settling_s`")]
    NoAim(String),
    /// The search drives the robot of a seed on which its values are to be checked.
    #[error(
        "seed {0}: the search drives that robot; check on consecutive seeds, or on fewer that are near each other"
    )]
    Seen(u64),
    /// It was ended before it was done.
    #[error("the search was ended")]
    Ended,
}

impl From<TuneError> for FileError {
    fn from(error: TuneError) -> Self {
        Self::Setting(error.to_string())
    }
}
