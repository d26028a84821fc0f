//! Logs in files.
//!
//! A log that is being written is locked by its writer until that ends, however it ends: so [`mend`] knows which logs
//! without an end nobody writes any more.

use rumbo_log::{Log, ReadError, Summary};
#[cfg(not(windows))]
use std::fs::TryLockError;
use std::fs::{File, Metadata};
use std::io::{self, BufReader, BufWriter, ErrorKind, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use thiserror::Error;

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

/// Gives a log that its writer could not complete, because it was killed, the end that it lacks: written beside it, and
/// then moved there. Says whether it did; a log that is whole, still being written, damaged otherwise or not to be
/// written stays as it is.
#[must_use]
pub fn mend(path: &Path) -> bool {
    try_mend(path).is_ok_and(|mended| mended)
}

fn try_mend(path: &Path) -> io::Result<bool> {
    // A link leads to the file that is to be replaced.
    let path = std::fs::canonicalize(path)?;
    let about = regular(&path)?;
    if about.permissions().readonly() || ends_as_one(&path)? {
        return Ok(false);
    }
    let Some(file) = unclaimed(&path)? else {
        return Ok(false);
    };
    let mut part = path.clone().into_os_string();
    part.push(format!(".{}.part", std::process::id()));
    let made = File::create_new(&part).and_then(|into| {
        let Some(into) = rumbo_log::mend(BufReader::new(&file), BufWriter::new(into))? else {
            return Ok(false);
        };
        let into = into.into_inner()?;
        into.set_permissions(about.permissions())?;
        // Its age is that of what was recorded.
        into.set_modified(about.modified()?)?;
        into.sync_all()?;
        std::fs::rename(&part, &path)?;
        Ok(true)
    });
    if !matches!(made, Ok(true)) {
        // It may not have been made.
        let _ = std::fs::remove_file(&part);
    }
    made
}

/// Whether a file ends as a whole log ends, which is quick to see.
fn ends_as_one(path: &Path) -> io::Result<bool> {
    let mut end = Vec::new();
    let mut file = File::open(path)?;
    let length = file.metadata()?.len();
    file.seek(SeekFrom::Start(length.saturating_sub(8)))?;
    file.read_to_end(&mut end)?;
    Ok(length < 8 || end == rumbo_log::MAGIC)
}

/// Says of a new log that it is being written, for as long as it is open.
pub(crate) fn claim(file: File) -> File {
    // Where a disk has no locks, `unclaimed` gets none either, and all logs are let be.
    #[cfg(not(windows))]
    let _ = file.try_lock();
    file
}

/// Whether somebody writes a log.
pub(crate) fn is_claimed(path: &Path) -> bool {
    !matches!(unclaimed(path), Ok(Some(_)))
}

/// A log that nobody writes, opened so that nobody else mends it.
#[cfg(not(windows))]
fn unclaimed(path: &Path) -> io::Result<Option<File>> {
    let file = File::open(path)?;
    match file.try_lock() {
        Ok(()) => Ok(Some(file)),
        Err(TryLockError::WouldBlock) => Ok(None),
        Err(TryLockError::Error(error)) => Err(error),
    }
}

/// The same where a lock would keep others from reading: what somebody writes cannot be opened for oneself.
#[cfg(windows)]
fn unclaimed(path: &Path) -> io::Result<Option<File>> {
    use std::os::windows::fs::OpenOptionsExt;
    /// FILE_SHARE_READ and FILE_SHARE_DELETE.
    const NOBODY_WRITES: u32 = 1 | 4;
    /// ERROR_SHARING_VIOLATION.
    const SHARED: i32 = 32;
    let mut options = File::options();
    match options.read(true).share_mode(NOBODY_WRITES).open(path) {
        Ok(file) => Ok(Some(file)),
        Err(error) if error.raw_os_error() == Some(SHARED) => Ok(None),
        Err(error) => Err(error),
    }
}

fn open(path: &Path) -> Result<File, ReadError> {
    regular(path)?;
    Ok(File::open(path)?)
}

/// What is known of a file. Pipes, sockets and devices are refused: to open one may wait for ever.
fn regular(path: &Path) -> io::Result<Metadata> {
    let about = std::fs::metadata(path)?;
    match about.is_file() {
        true => Ok(about),
        false => Err(io::Error::new(
            ErrorKind::InvalidInput,
            "a folder, a pipe or a device, not a file",
        )),
    }
}

fn of(path: &Path) -> impl FnOnce(ReadError) -> LogError {
    |error| LogError::new(path, Problem::NotRead(error))
}

/// What is wrong with a log's file.
#[derive(Debug, Error)]
#[error("{path}: {problem}")]
pub struct LogError {
    path: PathBuf,
    problem: Problem,
}

/// What is wrong.
#[derive(Debug, Error)]
pub(crate) enum Problem {
    /// It cannot be read, or is no log.
    #[error("{0}{hint}", hint = hint(.0))]
    NotRead(ReadError),
    /// It cannot be made; the option that names another folder.
    #[error("cannot be written ({0}); choose another folder {1}")]
    NotMade(io::Error, &'static str),
    /// No thread to write it.
    #[error("no thread to write it ({0})")]
    NoThread(io::Error),
    /// It could not be written to its end.
    #[error("recording ended: the log cannot be written ({0}); is the disk full?")]
    NotWritten(io::Error),
    /// The disk did not take all.
    #[error("recording: the disk is slow; entries missing in the log: {0}")]
    Dropped(u64),
    /// The thread that wrote it panicked.
    #[error("recording ended by a fault of its own; please report it")]
    Broken,
}

fn hint(error: &ReadError) -> &'static str {
    match error {
        ReadError::Unreadable(_) => "; `rumbo list logs` shows what there is",
        _ => "",
    }
}

impl LogError {
    pub(crate) fn new(path: &Path, problem: Problem) -> Self {
        let path = path.into();
        Self { path, problem }
    }

    pub(crate) fn not_written(path: &Path, error: io::Error) -> Self {
        Self::new(path, Problem::NotWritten(error))
    }

    /// The same of another file: of the one that this was to become.
    #[must_use]
    pub fn of(self, path: &Path) -> Self {
        Self::new(path, self.problem)
    }
}
