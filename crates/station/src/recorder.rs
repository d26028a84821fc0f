//! Records a session: entries are queued for a thread, so that nothing waits for the disk.
//!
//! Entries that a slow disk cannot keep up with are dropped and counted; a disk that fails ends the recording. Both are
//! reported ([`Recorder::trouble`]), and the session continues.

use crate::log_file::{LogError, Problem, claim};
use rumbo_log::{Bound, Entry, LogKind, LogWriter, Manifest};
use std::fs::File;
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, TrySendError, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant, SystemTime};

/// Entries reach the file within this time: half of what may be missing after a crash.
pub(crate) const FLUSH: Duration = Duration::from_millis(400);
/// Longest queue of entries: several seconds of a session in real time.
const QUEUE: usize = 4_096;

/// Where runs are recorded.
#[derive(Clone, Debug)]
pub struct RecordingSetting {
    /// The folder for their logs; created if it does not exist.
    pub folder: PathBuf,
}

/// What went wrong so far, reported once.
type Trouble = Arc<Mutex<Option<Problem>>>;

/// Records one run. Dropping it completes the log.
#[derive(Debug)]
pub(crate) struct Recorder {
    path: PathBuf,
    /// `None` only while it is dropped.
    entries: Option<SyncSender<Arc<Entry>>>,
    trouble: Trouble,
    thread: Option<JoinHandle<()>>,
    dropped: u64,
    /// For a real robot, so that a flood on its link does not fill the disk.
    bound: Option<Bound>,
}

impl Recorder {
    /// A new log in a folder, named after its manifest.
    pub(crate) fn in_folder(folder: &Path, manifest: &Manifest) -> Result<Self, LogError> {
        let (path, file) = file_in(folder, manifest)?;
        Self::start(path, file, manifest)
    }

    fn start(path: PathBuf, file: File, manifest: &Manifest) -> Result<Self, LogError> {
        let (sender, entries) = sync_channel(QUEUE);
        let trouble = Trouble::default();
        let bound = (manifest.kind == LogKind::Robot).then(Bound::default);
        let (manifest, reported) = (manifest.clone(), Arc::clone(&trouble));
        let thread = std::thread::Builder::new()
            .name("recorder".into())
            .spawn(move || {
                if let Err(error) = write(file, &manifest, &entries) {
                    report(&reported, Problem::NotWritten(error));
                }
            })
            .map_err(|error| LogError::new(&path, Problem::NoThread(error)))?;
        Ok(Self {
            path,
            entries: Some(sender),
            trouble,
            thread: Some(thread),
            dropped: 0,
            bound,
        })
    }

    /// The log's file.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Queues an entry.
    pub(crate) fn record(&mut self, entry: impl Into<Arc<Entry>>) {
        let entry = entry.into();
        if let Some(bound) = &mut self.bound {
            let (admitted, note) = bound.judge(&entry);
            if let Some(note) = note {
                self.queue(Arc::new(note));
            }
            if !admitted {
                return;
            }
        }
        self.queue(entry);
    }

    fn queue(&mut self, entry: Arc<Entry>) {
        let Some(entries) = &self.entries else {
            return;
        };
        match entries.try_send(entry) {
            Ok(()) if self.dropped > 0 => {
                let dropped = std::mem::take(&mut self.dropped);
                report(&self.trouble, Problem::Dropped(dropped));
            }
            Ok(()) | Err(TrySendError::Disconnected(_)) => {}
            Err(TrySendError::Full(_)) => self.dropped += 1,
        }
    }

    /// What has gone wrong since the last call.
    pub(crate) fn trouble(&self) -> Option<Problem> {
        self.trouble
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .take()
    }

    /// No more comes: its thread completes the log while others complete theirs.
    pub(crate) fn end(&mut self) {
        if let Some(note) = self.bound.as_mut().and_then(|bound| bound.pass_to(0)) {
            self.queue(Arc::new(note));
        }
        drop(self.entries.take());
    }

    fn close(&mut self) {
        self.end();
        if let Some(thread) = self.thread.take()
            && thread.join().is_err()
        {
            report(&self.trouble, Problem::Broken);
        }
    }
}

impl Drop for Recorder {
    fn drop(&mut self) {
        self.close();
    }
}

/// A new file in a folder, named after a manifest.
pub(crate) fn file_in(folder: &Path, manifest: &Manifest) -> Result<(PathBuf, File), LogError> {
    let failed = |path: &Path, error: io::Error| {
        LogError::new(path, Problem::NotMade(error, "for logs with --out"))
    };
    std::fs::create_dir_all(folder).map_err(|error| failed(folder, error))?;
    let stem = manifest.stem();
    let mut number = 1;
    loop {
        let name = match number {
            1 => format!("{stem}.mcap"),
            _ => format!("{stem}-{number}.mcap"),
        };
        let path = folder.join(name);
        match File::create_new(&path) {
            Ok(file) => return Ok((path, claim(file))),
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => number += 1,
            Err(error) => return Err(failed(&path, error)),
        }
    }
}

/// A file of this name; an existing one is replaced.
pub(crate) fn file_at(path: &Path) -> Result<File, LogError> {
    File::create(path).map_err(|error| LogError::new(path, Problem::NotMade(error, "with --out")))
}

fn report(trouble: &Trouble, problem: Problem) {
    *trouble.lock().unwrap_or_else(PoisonError::into_inner) = Some(problem);
}

/// Writes entries until the sender is gone.
fn write(file: File, manifest: &Manifest, entries: &Receiver<Arc<Entry>>) -> io::Result<()> {
    let mut log = LogWriter::new(BufWriter::new(file), manifest)?;
    let (mut dirty, mut due) = (false, Instant::now() + FLUSH);
    loop {
        let entry = match dirty {
            true => entries.recv_timeout(due.saturating_duration_since(Instant::now())),
            false => entries.recv().map_err(|_| RecvTimeoutError::Disconnected),
        };
        match entry {
            Ok(entry) => {
                if !dirty {
                    (dirty, due) = (true, Instant::now() + FLUSH);
                }
                log.record(&entry)?;
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return log.finish().map(drop),
        }
        if dirty && Instant::now() >= due {
            log.flush()?;
            dirty = false;
        }
    }
}

/// The time of day, UTC, as a manifest has it.
#[must_use]
pub fn now_utc() -> String {
    humantime::format_rfc3339_seconds(SystemTime::now()).to_string()
}

/// Its date, `2026-11-29`.
#[must_use]
pub fn today_utc() -> String {
    let mut now = now_utc();
    now.truncate("2026-11-29".len());
    now
}

#[cfg(test)]
mod tests {
    use super::*;
    use rumbo_log::Burst;

    fn burst(t_us: u64) -> Entry {
        Entry::Burst(Burst {
            t_us,
            to_robot: false,
            bytes: vec![7; 100],
        })
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_disk_is_reported_and_blocks_nothing() {
        let file = File::options().write(true).open("/dev/full").unwrap();
        let mut recorder = Recorder::start("/dev/full".into(), file, &Manifest::default()).unwrap();
        (0..100).for_each(|number| recorder.record(burst(number)));
        recorder.close();
        let error = recorder.trouble().unwrap().to_string();
        assert!(error.contains("is the disk full?"), "{error}");
    }

    #[test]
    fn the_end_of_a_robot_s_log_says_what_its_last_second_left_out() {
        let manifest = Manifest {
            kind: LogKind::Robot,
            ..Manifest::default()
        };
        let folder = tempfile::tempdir().unwrap();
        let mut recorder = Recorder::in_folder(folder.path(), &manifest).unwrap();
        (0..1_000).for_each(|number| recorder.record(burst(number)));
        let path = recorder.path().to_owned();
        drop(recorder);
        let log = crate::log_file::read(&path).unwrap();
        let recorded: usize = log.link.iter().map(|burst| burst.bytes.len()).sum();
        let left_out = format!("; {} bytes of the link", 100_000 - recorded);
        assert!(log.events().any(|(.., text)| text.contains(&left_out)));
    }
}
