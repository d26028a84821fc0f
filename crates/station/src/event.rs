//! What happens and is said, as people read it.

use serde::Serialize;

/// In place of a USART's number: the link to a real robot that speaks text.
pub(crate) const LINK_CONSOLE: u8 = 255;

/// What a USART of an emulated chip said, or a robot that speaks text.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct ConsoleText {
    pub(crate) usart: u8,
    pub(crate) text: String,
}

/// How an event is to be seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Level {
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
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Info => "info",
            Self::Good => "good",
            Self::Warning => "warning",
            Self::Fault => "fault",
        }
    }
}

/// Something that happened, as people read it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct LoggedEvent {
    /// Session time \[s\].
    pub(crate) t_s: f64,
    pub(crate) level: Level,
    /// What happened, with its cause.
    pub(crate) text: String,
}
