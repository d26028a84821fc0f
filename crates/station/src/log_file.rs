//! Logs in files.

use rumbo_log::{Log, ReadError, Summary, WriteError};
use std::fmt;
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

/// Reads a log.
///
/// # Errors
/// A file that cannot be read, is no log, or holds nothing known.
pub fn read(path: &Path) -> Result<Log, LogError> {
    open(path).and_then(Log::read).map_err(of(path))
}

/// Reads a log without the raw bytes of its link, for showing.
///
/// # Errors
/// As [`read`].
pub fn read_signals(path: &Path) -> Result<Log, LogError> {
    open(path).and_then(Log::read_signals).map_err(of(path))
}

/// Reads a log to be shown as a replay.
///
/// # Errors
/// As [`read`].
pub fn read_replay(path: &Path) -> Result<Log, LogError> {
    open(path).and_then(Log::read_replay).map_err(of(path))
}

/// What a log is, without reading it.
///
/// # Errors
/// A file that cannot be read, or is no log.
pub fn summary(path: &Path) -> Result<Summary, LogError> {
    open(path).and_then(Summary::read).map_err(of(path))
}

fn open(path: &Path) -> Result<File, ReadError> {
    Ok(File::open(path)?)
}

fn of(path: &Path) -> impl FnOnce(ReadError) -> LogError {
    |error| LogError::new(path, Problem::NotRead(error))
}

/// What is wrong with a log's file.
#[derive(Debug)]
pub struct LogError {
    path: PathBuf,
    problem: Problem,
}

/// What is wrong.
#[derive(Debug)]
pub(crate) enum Problem {
    /// It cannot be read, or is no log.
    NotRead(ReadError),
    /// It cannot be made; the option that names another folder.
    NotMade(io::Error, &'static str),
    /// No thread to write it.
    NoThread(io::Error),
    /// It could not be written to its end.
    NotWritten(WriteError),
    /// The disk did not take all.
    Dropped(u64),
    /// The thread that wrote it panicked.
    Broken,
}

impl LogError {
    pub(crate) fn new(path: &Path, problem: Problem) -> Self {
        let path = path.into();
        Self { path, problem }
    }

    pub(crate) fn not_written(path: &Path, error: WriteError) -> Self {
        Self::new(path, Problem::NotWritten(error))
    }

    /// The same of another file: of the one that this was to become.
    #[must_use]
    pub fn of(self, path: &Path) -> Self {
        Self::new(path, self.problem)
    }
}

impl fmt::Display for LogError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.path.display(), self.problem)
    }
}

impl std::error::Error for LogError {}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotRead(error @ ReadError::Unreadable(_)) => {
                write!(f, "{error}; `rumbo list logs` shows what there is")
            }
            Self::NotRead(error) => error.fmt(f),
            Self::NotMade(error, option) => write!(
                f,
                "cannot be written ({error}); choose another folder {option}"
            ),
            Self::NoThread(error) => write!(f, "no thread to write it ({error})"),
            Self::NotWritten(error) => write!(
                f,
                "recording ended: the log cannot be written ({error}); is the disk full?"
            ),
            Self::Dropped(entries) => write!(
                f,
                "recording: the disk is slow; entries missing in the log: {entries}"
            ),
            Self::Broken => f.write_str("recording ended by a fault of its own; please report it"),
        }
    }
}
