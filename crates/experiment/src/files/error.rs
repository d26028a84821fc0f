//! What is wrong with a file: one line per problem, each naming the file, the line, the key, the value and the remedy.

use rumbo_sim::SimError;
use std::{fmt, io};
use thiserror::Error;

/// One problem in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileProblem {
    /// The file, as the user names it.
    pub file: String,
    /// Line, from 1; 0 for the file as a whole.
    pub line: usize,
    /// What it is about.
    pub about: About,
    /// What is wrong, and what is allowed.
    pub text: String,
}

/// What of a file a problem is about.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum About {
    /// All of it, or a line that is no TOML.
    File,
    /// A table, by its path: `wiring.own`.
    Table(String),
    /// A key, by its path, and its value as it stands there.
    Key(String, String),
    /// A key that is missing, by its path.
    Missing(String),
}

impl fmt::Display for FileProblem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            0 => write!(f, "{}: ", self.file)?,
            line => write!(f, "{}:{line}: ", self.file)?,
        }
        match &self.about {
            About::File => {}
            About::Table(path) => write!(f, "[{path}] ")?,
            About::Key(path, value) => write!(f, "{path} = {value}: ")?,
            About::Missing(path) => write!(f, "{path} is missing: ")?,
        }
        f.write_str(&self.text)
    }
}

/// Why a robot, a world or a scenario cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum FileError {
    /// No built-in file and no setting has this name.
    #[error("unknown {kind} `{name}`; {}", did_you_mean(.near))]
    Unknown {
        /// What was requested: `scenario`, `world`, `robot`, `rig`, ...
        kind: &'static str,
        /// The requested name.
        name: String,
        /// The names that resemble it, best first; all names where none does.
        near: Vec<String>,
    },
    /// The file does not exist or cannot be read.
    #[error("{path}: cannot be read ({reason}); give {wanted}")]
    Unreadable {
        /// Its path.
        path: String,
        /// The system's message.
        reason: String,
        /// The system's number of it.
        code: Option<i32>,
        /// What to give in its place.
        wanted: &'static str,
    },
    /// The file was read and is wrong; at least one problem, in the order of lines.
    #[error("{}", lines(.0))]
    Invalid(Vec<FileProblem>),
    /// A value given from outside the file, such as `--param`, is wrong.
    #[error("{0}")]
    Setting(String),
}

impl FileError {
    /// That of a file which the system does not give.
    pub(crate) fn unreadable(path: String, error: &io::Error, wanted: &'static str) -> Self {
        Self::Unreadable {
            path,
            reason: error.to_string(),
            code: error.raw_os_error(),
            wanted,
        }
    }
}

impl From<SimError> for FileError {
    fn from(error: SimError) -> Self {
        Self::Setting(error.to_string())
    }
}

fn lines(problems: &[FileProblem]) -> String {
    let lines: Vec<String> = problems.iter().map(FileProblem::to_string).collect();
    lines.join("\n")
}

/// `did you mean ...?` in words.
pub(crate) fn did_you_mean(names: &[String]) -> String {
    let quoted: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
    match quoted.split_last() {
        None => "there is none to choose from".into(),
        Some((only, [])) => format!("did you mean {only}?"),
        Some((last, others)) if names.len() <= 3 => {
            format!("did you mean {} or {last}?", others.join(", "))
        }
        Some(_) => format!("known are {}", quoted.join(", ")),
    }
}
