//! Why a log cannot be read at all. What is wrong within one that can be, it says itself (`Log::cut`, `Log::notes`).

use std::{fmt, io};

/// Why bytes are no log.
#[derive(Debug)]
pub enum ReadError {
    /// They cannot be had.
    Unreadable(io::Error),
    /// They are something else.
    NoLog,
    /// Its writer was stopped before it had begun.
    NothingYet,
    /// It ends before anything of ours.
    CutOff,
    /// It is a whole log, with nothing of ours in it.
    Foreign,
}

impl fmt::Display for ReadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unreadable(error) => write!(f, "cannot be read ({error})"),
            Self::NoLog => f.write_str(
                "is no MCAP log; give a log of rumbo, or convert a table or a bag with `rumbo import`",
            ),
            Self::NothingYet => f.write_str(
                "ends before its first record: its writer was stopped at once, or it was cut off when it was copied; nothing of it can be read",
            ),
            Self::CutOff => f.write_str(
                "ends before anything of rumbo in it; was it cut off when it was copied, or is it another program's log, which `rumbo import` reads?",
            ),
            Self::Foreign => f.write_str(
                "holds neither a manifest nor signals of rumbo; `rumbo import` makes a log of another program's",
            ),
        }
    }
}

impl std::error::Error for ReadError {}

impl From<io::Error> for ReadError {
    fn from(error: io::Error) -> Self {
        Self::Unreadable(error)
    }
}
