//! Logs of headless runs, in files.

use crate::log_file::LogError;
use crate::recorder;
use rumbo_log::{Burst, LogWriter, Manifest};
use rumbo_session::headless::{self, RunRecords};
use std::fs::File;
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

/// Writes the log of a run, in place of what was there.
///
/// # Errors
/// If the file cannot be written.
pub fn record_run(path: &Path, manifest: &Manifest, run: RunRecords<'_>) -> Result<(), LogError> {
    write(path, recorder::file_at(path)?, |file| {
        headless::record_run(file, manifest, run)
    })
}

/// Writes the log of a run into the folder of sessions, under a name like theirs, and says which. What could not be
/// completed is not left there.
///
/// # Errors
/// If the file cannot be written.
pub fn record_run_in(
    folder: &Path,
    manifest: &Manifest,
    run: RunRecords<'_>,
) -> Result<PathBuf, LogError> {
    let (path, file) = recorder::file_in(folder, manifest)?;
    let written = write(&path, file, |file| {
        headless::record_run(file, manifest, run)
    });
    if written.is_err() {
        // That error is the one to report.
        let _ = std::fs::remove_file(&path);
    }
    written.map(|()| path)
}

/// Begins the log of a session in this folder, under a name made of its manifest, and says which.
///
/// # Errors
/// If the file cannot be made.
pub fn begin_log(
    folder: &Path,
    manifest: &Manifest,
) -> Result<(PathBuf, LogWriter<BufWriter<File>>), LogError> {
    let (path, file) = recorder::file_in(folder, manifest)?;
    match LogWriter::new(BufWriter::new(file), manifest) {
        Ok(log) => Ok((path, log)),
        Err(error) => Err(LogError::not_written(&path, error)),
    }
}

/// Writes the log of what a robot of the original program and its terminal have said to each other.
///
/// # Errors
/// If the file cannot be written.
pub fn record_text(path: &Path, manifest: &Manifest, link: &[Burst]) -> Result<(), LogError> {
    write(path, recorder::file_at(path)?, |file| {
        headless::record_text(file, manifest, link)
    })
}

type Buffered = BufWriter<File>;

fn write(
    path: &Path,
    file: File,
    record: impl FnOnce(Buffered) -> io::Result<Buffered>,
) -> Result<(), LogError> {
    match record(BufWriter::new(file)) {
        Ok(_) => Ok(()),
        Err(error) => Err(LogError::not_written(path, error)),
    }
}
