//! Records while things happen: whoever has something to record hands it to a thread, and never waits for the disk.
//!
//! What a slow disk cannot take is dropped and counted; a disk that fails ends the recording. Both are reported
//! ([`Recorder::trouble`]), and the robot goes on.

use super::bound::Bound;
use super::messages::Sink;
use super::writer::LogWriter;
use super::{Burst, Kind, LogError, Manifest, Outcome, Said};
use crate::catalogue::ParameterState;
use crate::event::LoggedEvent;
use crate::scene::Scene;
use crate::signals::Row;
use crate::state::State;
use mcap::McapResult;
use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, TrySendError, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// What has been recorded reaches the file within this time: half of what may be missing after a crash.
pub(crate) const FLUSH: Duration = Duration::from_millis(400);
/// Entries that wait for the disk: several seconds of a session in real time.
const WAITING: usize = 4_096;

/// Where runs are recorded.
#[derive(Clone, Debug)]
pub struct Recording {
    /// The folder for their logs; made if need be.
    pub folder: PathBuf,
}

/// Something to record.
#[derive(Debug)]
pub(crate) enum Entry {
    Burst(Burst),
    Said(Said),
    Rows(Vec<Row>),
    Event(LoggedEvent),
    Scene(Option<Box<Scene>>),
    State(Box<State>),
    Parameters(Vec<ParameterState>),
    Outcome(Outcome),
}

/// What went wrong so far, told once.
type Trouble = Arc<Mutex<Option<String>>>;

/// Records one run. Dropping it completes the log.
#[derive(Debug)]
pub(crate) struct Recorder {
    path: PathBuf,
    /// `None` only while it is dropped.
    entries: Option<SyncSender<Arc<Entry>>>,
    trouble: Trouble,
    thread: Option<JoinHandle<()>>,
    /// Waits for the disk rather than drop anything.
    patient: bool,
    dropped: u64,
    /// Of a real robot, so that a flood on its link does not fill the disk.
    bound: Option<Bound>,
}

impl Recorder {
    /// A new log in a folder, named after its manifest.
    pub(crate) fn in_folder(folder: &Path, manifest: &Manifest) -> Result<Self, LogError> {
        let failed = |path: &Path, error: std::io::Error| {
            LogError::new(
                path,
                format!("cannot be written ({error}); choose another folder for logs with --out"),
            )
        };
        std::fs::create_dir_all(folder).map_err(|error| failed(folder, error))?;
        let stem = manifest.stem();
        let mut number = 1;
        let (path, file) = loop {
            let name = match number {
                1 => format!("{stem}.mcap"),
                _ => format!("{stem}-{number}.mcap"),
            };
            let path = folder.join(name);
            match File::create_new(&path) {
                Ok(file) => break (path, file),
                Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists => number += 1,
                Err(error) => return Err(failed(&path, error)),
            }
        };
        Self::start(path, file, manifest, false)
    }

    /// A log of this name, in place of what was there; nothing of it is dropped, however slow the disk.
    pub(crate) fn at(path: &Path, manifest: &Manifest) -> Result<Self, LogError> {
        let file = File::create(path).map_err(|error| {
            LogError::new(
                path,
                format!("cannot be written ({error}); choose another folder with --out"),
            )
        })?;
        Self::start(path.into(), file, manifest, true)
    }

    fn start(
        path: PathBuf,
        file: File,
        manifest: &Manifest,
        patient: bool,
    ) -> Result<Self, LogError> {
        let (sender, entries) = sync_channel(WAITING);
        let trouble = Trouble::default();
        let bound = (manifest.kind == Kind::Robot && !patient).then(Bound::default);
        let (manifest, told) = (manifest.clone(), Arc::clone(&trouble));
        let thread = std::thread::Builder::new()
            .name("recorder".into())
            .spawn(move || {
                if let Err(error) = write(file, &manifest, &entries) {
                    tell(&told, format!("recording ended: the log cannot be written ({error}); is the disk full?"));
                }
            })
            .map_err(|error| LogError::new(&path, format!("no thread to write it ({error})")))?;
        Ok(Self {
            path,
            entries: Some(sender),
            trouble,
            thread: Some(thread),
            patient,
            dropped: 0,
            bound,
        })
    }

    /// The same, but nothing is dropped, however slow the disk: for what can wait for it.
    pub(crate) fn patient(mut self) -> Self {
        self.patient = true;
        self
    }

    /// The log's file.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Takes something to record.
    pub(crate) fn take(&mut self, entry: impl Into<Arc<Entry>>) {
        let entry = entry.into();
        if let Some(bound) = &mut self.bound {
            let (admitted, note) = bound.judge(&entry);
            if let Some(note) = note {
                self.pass_on(Arc::new(note));
            }
            if !admitted {
                return;
            }
        }
        self.pass_on(entry);
    }

    fn pass_on(&mut self, entry: Arc<Entry>) {
        let Some(entries) = &self.entries else {
            return;
        };
        if self.patient {
            // A recording that has ended has said why.
            let _ = entries.send(entry);
            return;
        }
        match entries.try_send(entry) {
            Ok(()) if self.dropped > 0 => {
                let dropped = std::mem::take(&mut self.dropped);
                tell(
                    &self.trouble,
                    format!(
                        "recording: the disk is slow, {dropped} entries are missing in the log"
                    ),
                );
            }
            Ok(()) | Err(TrySendError::Disconnected(_)) => {}
            Err(TrySendError::Full(_)) => self.dropped += 1,
        }
    }

    /// What has gone wrong since it was last asked.
    pub(crate) fn trouble(&self) -> Option<String> {
        self.trouble
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .take()
    }

    /// Completes the log.
    pub(crate) fn finish(mut self) -> Result<(), LogError> {
        self.close();
        match self.trouble() {
            Some(what) => Err(LogError::new(&self.path, what)),
            None => Ok(()),
        }
    }

    fn close(&mut self) {
        if let Some(note) = self.bound.as_mut().and_then(|bound| bound.pass_to(0)) {
            self.pass_on(Arc::new(note));
        }
        drop(self.entries.take());
        if let Some(thread) = self.thread.take()
            && thread.join().is_err()
        {
            tell(
                &self.trouble,
                "recording ended by a fault of its own; please report it".into(),
            );
        }
    }
}

impl Drop for Recorder {
    fn drop(&mut self) {
        self.close();
    }
}

fn tell(trouble: &Trouble, what: String) {
    *trouble.lock().unwrap_or_else(PoisonError::into_inner) = Some(what);
}

/// Writes what comes until the sender is gone.
fn write(file: File, manifest: &Manifest, entries: &Receiver<Arc<Entry>>) -> McapResult<()> {
    let mut log = LogWriter::new(BufWriter::new(file), manifest)?;
    log.flush()?;
    let mut now_us = 0;
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
                match &*entry {
                    Entry::Outcome(outcome) => log.outcome(now_us, outcome)?,
                    entry => log.entry(entry, &mut now_us)?,
                }
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return log.finish(),
        }
        if dirty && Instant::now() >= due {
            log.flush()?;
            dirty = false;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::{Log, Said, Sent};

    fn burst(t_us: u64) -> Entry {
        Entry::Burst(Burst {
            t_us,
            to_robot: false,
            bytes: vec![7; 100],
        })
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_disk_is_reported_and_nobody_waits_for_it() {
        let file = File::options().write(true).open("/dev/full").unwrap();
        let mut recorder =
            Recorder::start("/dev/full".into(), file, &Manifest::default(), false).unwrap();
        (0..100).for_each(|number| recorder.take(burst(number)));
        let error = recorder.finish().unwrap_err().to_string();
        assert!(error.contains("is the disk full?"), "{error}");
    }

    #[test]
    fn a_log_cut_anywhere_is_read_up_to_there_and_a_complete_one_is_not_called_cut() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("whole.mcap");
        let mut recorder = Recorder::at(&path, &Manifest::default()).unwrap();
        for number in 0..6 {
            (0..50).for_each(|each| recorder.take(burst(1_000 * (50 * number + each))));
            std::thread::sleep(FLUSH / 2);
        }
        recorder.finish().unwrap();
        let whole = std::fs::read(&path).unwrap();
        let log = Log::read(&path).unwrap();
        assert_eq!((log.cut.as_deref(), log.link.len()), (None, 300));
        let cut = folder.path().join("cut.mcap");
        let mut lengths = Vec::new();
        for part in 1..40 {
            std::fs::write(&cut, &whole[..whole.len() * part / 40]).unwrap();
            match Log::read(&cut) {
                Ok(log) => lengths.push(log.link.len()),
                // Not even the manifest is whole.
                Err(error) => assert!(lengths.is_empty(), "{error}"),
            }
        }
        assert!(
            lengths.is_sorted() && lengths.last() == Some(&300),
            "{lengths:?}"
        );
        assert!(
            lengths.iter().any(|length| (1..300).contains(length)),
            "{lengths:?}"
        );
    }

    #[test]
    fn what_was_sent_at_one_time_is_told_in_the_order_in_which_it_was_sent() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sent.mcap");
        let mut recorder = Recorder::at(&path, &Manifest::default()).unwrap();
        for number in 0..6 {
            let (t_us, bytes) = (5_000 * (number / 3), vec![number as u8]);
            recorder.take(match number % 2 {
                0 => Entry::Burst(Burst {
                    t_us,
                    to_robot: true,
                    bytes,
                }),
                _ => Entry::Said(Said {
                    t_us,
                    usart: 1,
                    to_chip: true,
                    bytes,
                }),
            });
            recorder.take(burst(t_us));
        }
        recorder.finish().unwrap();
        let log = Log::read(&path).unwrap();
        let sent = log.sent().map(|sent| match sent {
            Sent::Link(burst) => burst.bytes[0],
            Sent::Typed(said) => said.bytes[0],
        });
        assert_eq!(sent.collect::<Vec<_>>(), [0, 1, 2, 3, 4, 5]);
    }

    #[test]
    fn a_log_with_damaged_bytes_is_read_as_far_as_it_goes_or_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("damaged.mcap");
        let mut recorder = Recorder::at(&path, &Manifest::default()).unwrap();
        (0..300).for_each(|number| recorder.take(burst(1_000 * number)));
        recorder.finish().unwrap();
        let whole = std::fs::read(&path).unwrap();
        let mut cut = 0;
        for at in (mcap::MAGIC.len()..whole.len() - 8).step_by(61) {
            let mut damaged = whole.clone();
            // A length that no memory holds, if a length was there.
            damaged[at..at + 8].fill(0x7f);
            std::fs::write(&path, &damaged).unwrap();
            match Log::read(&path) {
                Ok(log) => cut += usize::from(log.cut.is_some()),
                Err(error) => assert!(!error.to_string().contains('\n'), "{error}"),
            }
        }
        assert!(cut > 0);
    }

    #[test]
    fn what_comes_after_damage_near_the_start_is_read_all_the_same() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("damaged.mcap");
        let manifest = Manifest {
            seed: Some(7),
            ..Manifest::default()
        };
        let mut recorder = Recorder::at(&path, &manifest).unwrap();
        (0..3_000).for_each(|number| recorder.take(burst(1_000 * number)));
        recorder.finish().unwrap();
        let whole = std::fs::read(&path).unwrap();
        let index = mcap::Summary::read(&whole).unwrap().unwrap();
        assert!(index.chunk_indexes.len() > 3);
        let middle = |chunk: &mcap::records::ChunkIndex| {
            (chunk.chunk_start_offset + chunk.chunk_length / 2) as usize
        };
        let [topics, first] = [0, 1].map(|at| middle(&index.chunk_indexes[at]));
        // The length of the very first record; the chunk that says which channels there are; the first one with messages.
        for (at, has_holes, least, most) in [
            (mcap::MAGIC.len() + 1, false, 3_000, 3_000),
            (topics, true, 3_000, 3_000),
            (first, true, 1_000, 2_999),
        ] {
            let mut damaged = whole.clone();
            damaged[at..at + 8].fill(0x7f);
            std::fs::write(&path, &damaged).unwrap();
            let log = Log::read(&path).unwrap();
            assert_eq!((log.has_holes, log.cut.is_some()), (has_holes, has_holes));
            assert!(has_holes || !log.notes.is_empty());
            assert_eq!(log.manifest.as_ref().unwrap().seed, Some(7));
            assert!(
                (least..=most).contains(&log.link.len()),
                "{}",
                log.link.len()
            );
            assert_eq!(log.link.last().unwrap().t_us, 2_999_000);
        }
    }

    #[test]
    fn what_is_no_log_gets_one_line() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.mcap");
        let mut foreign = mcap::Writer::new(std::io::Cursor::new(Vec::new())).unwrap();
        foreign.finish().unwrap();
        let foreign = foreign.into_inner().into_inner();
        for (bytes, said) in [
            (&b""[..], "ends before its first record"),
            (&foreign, "neither a manifest"),
            (b"t_s,x_m\n0,0\n", "is no MCAP log"),
            (&mcap::MAGIC[..3], "ends before its first record"),
            (mcap::MAGIC, "ends before its first record"),
        ] {
            std::fs::write(&path, bytes).unwrap();
            let error = Log::read(&path).unwrap_err().to_string();
            assert!(error.contains(said) && !error.contains('\n'), "{error}");
        }
        assert!(Log::read(&folder.path().join("none.mcap")).is_err());
    }
}
