//! What can go wrong between a log and its parameters.

use std::fmt;
use std::path::PathBuf;
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
    /// A log of ranges cannot be used.
    #[error(transparent)]
    Sonar(SonarLogError),
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

/// A log of ranges that cannot be used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SonarLogError {
    pub(crate) path: PathBuf,
    /// 1-based; 0 if the file as a whole is meant.
    pub(crate) line: u64,
    pub(crate) cause: String,
}

impl fmt::Display for SonarLogError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.path.display())?;
        if self.line > 0 {
            write!(f, ", line {}", self.line)?;
        }
        write!(f, ": {}", self.cause)
    }
}

impl std::error::Error for SonarLogError {}
