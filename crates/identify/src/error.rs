//! What can go wrong between a log and its parameters.

use crate::row::LONGEST_MS;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Why a run could not be identified. Each message names the place and the remedy.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum IdentifyError {
    /// A file cannot be read or is no CSV.
    #[error("{path}: {cause}")]
    Read {
        /// The file.
        path: PathBuf,
        /// The cause in the words of the system or the CSV reader.
        cause: String,
    },
    /// The columns are not those of a mode that records PWM.
    #[error(
        "{path}: no columns dt_ms, pwm_a, pwm_b with speeds or distances in `{found}`; give a log of modes 1 to 7, \
         or that of another program as `rumbo import` makes it"
    )]
    Header {
        /// The file.
        path: PathBuf,
        /// Its header.
        found: String,
    },
    /// A cell of a log is not what it should be.
    #[error("{path}, line {line}, column {column}: `{value}`, allowed is {allowed}")]
    Value {
        /// The file.
        path: PathBuf,
        /// Line, the header being 1.
        line: u64,
        /// Name of the column.
        column: String,
        /// What the cell holds.
        value: String,
        /// What is allowed.
        allowed: &'static str,
    },
    /// A row of a log of ranges is not what it should be.
    #[error("{path}, line {line}: {cause}")]
    Row {
        /// The file.
        path: PathBuf,
        /// Line, the header being 1.
        line: u64,
        /// What is wrong with it.
        cause: String,
    },
    /// No log shows speeds or a distance ahead.
    #[error(
        "no log shows wheel speeds (modes 5 to 7) or a wall ahead (modes 1, 2); add one that does"
    )]
    NothingToFit,
    /// There is one log only, and it is to be left out.
    #[error("there is one log only; add others to fit it without")]
    NothingLeft,
    /// No common plant explains these logs.
    #[error(
        "{one} and {other} contradict each other: no common robot explains both (the errors of the first are \
         {ratio:.2} times those of a fit of its own); give the logs of one robot with one wiring"
    )]
    Contradiction {
        /// The one that the common fit explains worst.
        one: String,
        /// The one that contradicts it most.
        other: String,
        /// How much larger its errors are than under a fit of its own.
        ratio: f64,
    },
    /// The optimiser failed.
    #[error("the fit did not converge: {0}")]
    Optimiser(String),
    /// Somebody wanted it to end.
    #[error("interrupted")]
    Interrupted,
}

impl IdentifyError {
    /// A file that cannot be used as a whole.
    pub(crate) fn read(path: &Path, cause: impl ToString) -> Self {
        Self::Read {
            path: path.into(),
            cause: cause.to_string(),
        }
    }

    /// A run longer than is compared.
    pub(crate) fn too_long(path: &Path) -> Self {
        let most = LONGEST_MS / 1_000;
        let remedy = "the most that is compared; cut it into shorter runs";
        Self::read(path, format!("lasts longer than {most} s, {remedy}"))
    }
}
