//! The recording of the page's run: kept in memory, written as a log when it is saved.

use rumbo_log::{Entry, LogWriter, Manifest, Row};
use std::io::{self, Cursor};
use std::sync::Arc;

/// Room for recordings in memory \[bytes\]: some hours of driving of one robot.
pub(crate) const ROOM: usize = 200 << 20;
/// About what an entry takes besides its bytes or rows \[bytes\].
const ENTRY: usize = 500;

/// Entries that are written without a look at the clock.
pub(crate) const SOME: usize = 20;

/// What has happened since the run began.
pub(crate) struct Recording {
    pub(crate) manifest: Manifest,
    /// Time of day when the run began \[ms since 1970\].
    pub(crate) began_ms: f64,
    entries: Vec<Arc<Entry>>,
    bytes: usize,
    room: usize,
}

impl Recording {
    pub(crate) fn new(manifest: Manifest, began_ms: f64, room: usize) -> Self {
        Self {
            room,
            manifest,
            began_ms,
            entries: Vec::new(),
            bytes: 0,
        }
    }

    /// Keeps an entry, while there is room; false when it has just run out.
    pub(crate) fn keep(&mut self, entry: &Arc<Entry>) -> bool {
        if self.bytes >= self.room {
            return true;
        }
        self.bytes += ENTRY + size_of_content(entry);
        self.entries.push(Arc::clone(entry));
        self.bytes < self.room
    }

    /// The run up to this time of the target in one number; `None` where not all of it is kept.
    pub(crate) fn hash(&self, until_us: u64) -> Option<String> {
        let entries = self.entries.iter().map(AsRef::as_ref);
        (self.bytes < self.room)
            .then(|| format!("{:016x}", rumbo_lab::recorded_hash(entries, until_us)))
    }

    /// The name of a file for it, and the file; `started` is when the run began, as in a manifest.
    pub(crate) fn log(&self, started: String) -> io::Result<(String, Vec<u8>)> {
        let mut saving = self.save(started)?;
        while !saving.advance(self, SOME)? {}
        saving.finish()
    }

    /// Begins to write it as a file, a piece at a time.
    pub(crate) fn save(&self, started: String) -> io::Result<Saving> {
        let manifest = Manifest {
            started: Some(started),
            ..self.manifest.clone()
        };
        Ok(Saving {
            log: LogWriter::new(Cursor::new(Vec::new()), &manifest)?,
            name: format!("{}.mcap", manifest.stem()),
            written: 0,
            until: self.entries.len(),
        })
    }
}

/// A file of a recording that is being written.
pub(crate) struct Saving {
    log: LogWriter<Cursor<Vec<u8>>>,
    name: String,
    written: usize,
    /// What comes after it began is not in it.
    until: usize,
}

impl Saving {
    /// Writes some entries more of the recording that it is of; returns whether those were the last.
    pub(crate) fn advance(&mut self, recording: &Recording, some: usize) -> io::Result<bool> {
        let until = self.until.min(self.written + some);
        for entry in &recording.entries[self.written..until] {
            self.log.record(entry)?;
        }
        self.written = until;
        Ok(until == self.until)
    }

    /// The name of a file for it, and the file.
    pub(crate) fn finish(self) -> io::Result<(String, Vec<u8>)> {
        Ok((self.name, self.log.finish()?.into_inner()))
    }
}

fn size_of_content(entry: &Entry) -> usize {
    match entry {
        Entry::Burst(burst) => burst.bytes.len(),
        Entry::Said(said) => said.bytes.len(),
        Entry::Rows(rows) => rows.len() * size_of::<Row>(),
        Entry::Readings(readings) => readings.len() * ENTRY,
        _ => 0,
    }
}
