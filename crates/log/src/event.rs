//! What happens, as people read it.

use serde::{Deserialize, Serialize};

/// How an event is to be seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Level {
    /// Something went on.
    Info,
    /// Something was achieved or applied.
    Good,
    /// Something was refused or lost.
    Warning,
    /// The robot had to stop.
    Fault,
}

impl Level {
    /// Its name, as in logs.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Info => "info",
            Self::Good => "good",
            Self::Warning => "warning",
            Self::Fault => "fault",
        }
    }
}

/// Something that happened, as people read it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LoggedEvent {
    /// Session time \[s\].
    pub t_s: f64,
    /// How it is to be seen.
    pub level: Level,
    /// What happened, with its cause.
    pub text: String,
}
