//! Why a command failed, and the exit status for it.

use rumbo_experiment::files::FileError;
use std::fmt;

/// What ended a command.
#[derive(Debug)]
pub(crate) enum Failure {
    /// A run missed a limit of its scenario; which one has been printed.
    LimitMissed,
    /// Wrong input, or something outside the program is not as needed: what, where and the remedy, in one line.
    Input(String),
    /// The same of several things, a line each.
    Inputs(Vec<String>),
    /// The compiler refused a sketch: its complaints, a line each.
    Rejected(Vec<String>),
    /// Ctrl-C; what was done until then has been printed.
    Interrupted,
    /// The reader of our output has closed it.
    ReaderGone,
}

impl Failure {
    /// A wrong input, from any error.
    pub(crate) fn input(error: impl fmt::Display) -> Self {
        Self::Input(error.to_string())
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::LimitMissed => f.write_str("a limit is missed"),
            Self::Input(text) => f.write_str(text),
            Self::Inputs(lines) | Self::Rejected(lines) => f.write_str(&lines.join("; ")),
            Self::Interrupted => f.write_str("interrupted"),
            Self::ReaderGone => f.write_str("nobody reads the output"),
        }
    }
}

impl std::error::Error for Failure {}

impl From<FileError> for Failure {
    fn from(error: FileError) -> Self {
        match error {
            FileError::Invalid(problems) => {
                Self::Inputs(problems.iter().map(ToString::to_string).collect())
            }
            other => Self::input(other),
        }
    }
}

impl From<std::io::Error> for Failure {
    fn from(error: std::io::Error) -> Self {
        match error.kind() {
            std::io::ErrorKind::BrokenPipe => Self::ReaderGone,
            _ => Self::Input(format!(
                "the output could not be written ({error}); is the disk full?"
            )),
        }
    }
}
