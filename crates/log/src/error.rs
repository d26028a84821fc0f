//! Why a log cannot be read at all. What is wrong within one that can be, it says itself (`Log::cut`, `Log::notes`).

use std::io;
use thiserror::Error;

/// Why bytes are no log.
#[derive(Debug, Error)]
pub enum ReadError {
    /// They cannot be had.
    #[error("cannot be read ({0})")]
    Unreadable(io::Error),
    /// They are something else.
    #[error("is no MCAP log; give a log of rumbo, or convert a table or a bag with `rumbo import`")]
    NoLog,
    /// Its writer was stopped before it had begun.
    #[error(
        "ends before its first record: its writer was stopped at once, or it was cut off when it was copied; \
         nothing of it can be read"
    )]
    NothingYet,
    /// It ends before anything of ours.
    #[error(
        "ends before anything of rumbo in it; was it cut off when it was copied, or is it another program's log, \
         which `rumbo import` reads?"
    )]
    CutOff,
    /// It is a whole log, with nothing of ours in it.
    #[error(
        "holds neither a manifest nor signals of rumbo; `rumbo import` makes a log of another program's"
    )]
    Foreign,
}

impl From<io::Error> for ReadError {
    fn from(error: io::Error) -> Self {
        Self::Unreadable(error)
    }
}
