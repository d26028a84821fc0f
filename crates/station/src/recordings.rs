//! The folder of recordings, for the page: list, look into, replay, delete.
//!
//! A page names a recording. Its name is compared with the names in the folder and never becomes a path.

use crate::error::ServeError;
use crate::log_file;
use rumbo_log::{Log, Row, RowValue, Summary};
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::SystemTime;

/// Replays served at once; the oldest ends for a new one.
const MOST_REPLAYS: usize = 4;
/// Rows of a recording to compare, thinned out to about as many.
const MOST_ROWS: usize = 3_000;

/// Serves a replay under this name; returns its address, and what ends it when dropped.
pub(crate) type Show = fn(String, Log) -> Result<(String, Box<dyn Send>), ServeError>;

/// The recordings of a folder.
pub(crate) struct Recordings {
    folder: PathBuf,
    show: Show,
    replays: Mutex<Vec<Box<dyn Send>>>,
}

/// A recording in the list.
#[derive(Debug, Serialize)]
pub(crate) struct Entry {
    name: String,
    bytes: u64,
    /// Last written \[s since 1970\].
    written_s: u64,
    /// Being recorded now.
    open: bool,
    /// The rest is missing where the file is not readable as a log.
    readable: bool,
    duration_s: f64,
    started: Option<String>,
    scenario: Option<String>,
    robot: Option<String>,
    seed: Option<u64>,
}

/// A recording as it is compared with another.
#[derive(Debug, Serialize)]
pub(crate) struct Content {
    name: String,
    duration_s: f64,
    /// Metrics that were computed when it was made; `None`: it never happened.
    metrics: BTreeMap<String, Option<f64>>,
    parameters: BTreeMap<String, f32>,
    columns: Vec<&'static str>,
    rows: Vec<Vec<RowValue>>,
}

/// Why a recording could not be shown or deleted.
#[derive(Debug)]
pub(crate) enum RecordingError {
    /// None has this name.
    Unknown,
    /// It is being recorded.
    Open,
    /// It is no log of Rumbo's.
    Foreign,
    /// It cannot be read.
    NotRead(log_file::LogError),
    /// The folder or the file refuses.
    Io(std::io::Error),
    /// No server for the replay.
    NotServed(ServeError),
}

impl fmt::Display for RecordingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unknown => f.write_str("no recording has this name; load the list again"),
            Self::Open => f.write_str("it is being recorded: it can be deleted when it has ended"),
            Self::Foreign => f.write_str("it is no log of Rumbo: delete it by hand"),
            Self::NotRead(error) => error.fmt(f),
            Self::Io(error) => write!(f, "{error}; check the permissions of the folder"),
            Self::NotServed(error) => error.fmt(f),
        }
    }
}

impl From<std::io::Error> for RecordingError {
    fn from(error: std::io::Error) -> Self {
        Self::Io(error)
    }
}

impl fmt::Debug for Recordings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Recordings").field(&self.folder).finish()
    }
}

impl Recordings {
    pub(crate) fn new(folder: PathBuf, show: Show) -> Self {
        Self {
            folder,
            show,
            replays: Mutex::default(),
        }
    }

    pub(crate) fn folder(&self) -> &Path {
        &self.folder
    }

    /// The logs in the folder, the one written last first. A link is none of them.
    fn paths(&self) -> Result<Vec<PathBuf>, RecordingError> {
        let mut found = Vec::new();
        for file in std::fs::read_dir(&self.folder)? {
            let (path, about) = file.and_then(|file| Ok((file.path(), file.metadata()?)))?;
            if about.is_file() && path.extension().is_some_and(|ending| ending == "mcap") {
                found.push((about.modified()?, path));
            }
        }
        found.sort_by(|one, other| other.cmp(one));
        Ok(found.into_iter().map(|(_, path)| path).collect())
    }

    fn find(&self, name: &str) -> Result<PathBuf, RecordingError> {
        let found = self.paths()?.into_iter().find(|path| stem(path) == name);
        found.ok_or(RecordingError::Unknown)
    }

    pub(crate) fn list(&self) -> Result<Vec<Entry>, RecordingError> {
        let entry = |path: PathBuf| {
            let about = std::fs::metadata(&path).ok();
            let written = about.as_ref().and_then(|about| about.modified().ok());
            let since = written.and_then(|at| at.duration_since(SystemTime::UNIX_EPOCH).ok());
            let summary = log_file::summary(&path).unwrap_or_default();
            let open = is_open(&path, &summary);
            let manifest = summary.manifest;
            Entry {
                name: stem(&path),
                bytes: about.map_or(0, |about| about.len()),
                written_s: since.map_or(0, |since| since.as_secs()),
                open,
                readable: manifest.is_some(),
                duration_s: summary.duration_s,
                started: manifest.as_ref().and_then(|log| log.started.clone()),
                scenario: manifest.as_ref().and_then(|log| log.scenario.clone()),
                robot: manifest.as_ref().and_then(|log| log.robot.clone()),
                seed: manifest.as_ref().and_then(|log| log.seed),
            }
        };
        Ok(self.paths()?.into_iter().map(entry).collect())
    }

    pub(crate) fn content(&self, name: &str) -> Result<Content, RecordingError> {
        let path = self.find(name)?;
        let log = log_file::read_signals(&path).map_err(RecordingError::NotRead)?;
        let metrics = log.outcome.iter().flat_map(|outcome| &outcome.metrics);
        let every = log.rows.len().div_ceil(MOST_ROWS).max(1);
        Ok(Content {
            name: name.into(),
            duration_s: log.duration_s(),
            metrics: metrics
                .map(|(name, value)| (name.clone(), value.is_finite().then_some(*value)))
                .collect(),
            parameters: log.parameters(),
            columns: Row::names().collect(),
            rows: log.rows.iter().step_by(every).map(Row::cells).collect(),
        })
    }

    /// Serves a replay; returns its address.
    pub(crate) fn replay(&self, name: &str) -> Result<String, RecordingError> {
        let path = self.find(name)?;
        let log = log_file::read_replay(&path).map_err(RecordingError::NotRead)?;
        let (url, server) = (self.show)(name.into(), log).map_err(RecordingError::NotServed)?;
        let mut replays = self.replays.lock().unwrap_or_else(PoisonError::into_inner);
        if replays.len() == MOST_REPLAYS {
            drop(replays.remove(0));
        }
        replays.push(server);
        Ok(url)
    }

    pub(crate) fn delete(&self, name: &str) -> Result<(), RecordingError> {
        let path = self.find(name)?;
        let summary = log_file::summary(&path).unwrap_or_default();
        if is_open(&path, &summary) {
            return Err(RecordingError::Open);
        }
        if summary.manifest.is_none() {
            return Err(RecordingError::Foreign);
        }
        Ok(std::fs::remove_file(path)?)
    }
}

/// Whether it is being recorded, here or elsewhere.
fn is_open(path: &Path, summary: &Summary) -> bool {
    !summary.complete && log_file::is_claimed(path)
}

/// The name of a recording: that of its file without the ending.
fn stem(path: &Path) -> String {
    path.file_stem()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned()
}
