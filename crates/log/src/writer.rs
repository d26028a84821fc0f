//! Writes a log: manifest and files first, then messages as they come.

use crate::container::Container;
use crate::digest::{Digest, MANIFEST, OUTCOME};
use crate::entry::{Burst, Entry};
use crate::manifest::{Manifest, Outcome};
use crate::messages::{Messages, Sink};
use crate::scene::SonarMount;
use crate::schema::Topic;
use std::collections::BTreeMap;
use std::io::{self, Write};

/// What comes from the robot within this time is one message \[us\].
const JOINED_US: u64 = 200_000;
/// What does not change is written again after this time \[us\].
const AGAIN_US: u64 = 1_000_000;

/// A log being written.
pub struct LogWriter<W: Write> {
    log: Container<W>,
    /// Of each topic that has a message.
    channels: [Option<u16>; Topic::ALL.len()],
    /// The sonars whose frames are written.
    mounts: Option<Vec<SonarMount>>,
    sequences: [u32; Topic::ALL.len()],
    /// The time of what came last \[us\].
    now_us: u64,
    /// What came from the robot, and is not written yet.
    joined: Joined,
    /// Of each topic of which only changes are written.
    kept: [Kept; Topic::ALL.len()],
}

/// Bytes from the robot, a few at a time as a link has them, for one message.
#[derive(Default)]
struct Joined {
    t_us: u64,
    last_us: u64,
    bytes: Vec<u8>,
    pieces: Vec<(u64, usize)>,
}

/// What of a topic is in the log.
#[derive(Default)]
struct Kept {
    what: String,
    t_us: Option<u64>,
    /// It still was so then: written before it changes, so that no viewer draws a slope where there was a step.
    still: Option<(u64, Vec<u8>)>,
}

impl<W: Write> LogWriter<W> {
    /// A log that begins with its manifest.
    ///
    /// # Errors
    /// What `into` does not take.
    pub fn new(into: W, manifest: &Manifest) -> io::Result<Self> {
        let library = concat!("rumbo ", env!("CARGO_PKG_VERSION"));
        let mut log = Container::new(into, "", library)?;
        let metadata = manifest.to_metadata();
        let digest = Digest::of(MANIFEST, &metadata);
        log.metadata(MANIFEST, &metadata)?;
        for (name, text) in &manifest.files {
            let name = format!("{name}.toml");
            log.attach(&name, "application/toml", text.as_bytes())?;
        }
        let mut log = Self {
            log,
            channels: [None; Topic::ALL.len()],
            mounts: None,
            sequences: [0; Topic::ALL.len()],
            now_us: 0,
            joined: Joined::default(),
            kept: Default::default(),
        };
        log.digest(0, &digest)?;
        // A chunk of its own: if the next one is lost, the log's description is not.
        log.flush()?;
        Ok(log)
    }

    /// Records something.
    ///
    /// # Errors
    /// What `into` does not take.
    pub fn record(&mut self, entry: &Entry) -> io::Result<()> {
        match entry {
            Entry::Outcome(outcome) => return self.outcome(outcome),
            Entry::Burst(burst) if !burst.to_robot => return self.join(burst),
            // The order in which both sides spoke is that of their messages.
            Entry::Burst(_) => self.put_joined()?,
            _ => {}
        }
        let mut now_us = self.now_us;
        self.entry(entry, &mut now_us)?;
        self.now_us = now_us;
        Ok(())
    }

    fn join(&mut self, burst: &Burst) -> io::Result<()> {
        self.now_us = burst.t_us;
        let together = self.joined.t_us..self.joined.t_us.saturating_add(JOINED_US);
        if !together.contains(&burst.t_us) || burst.t_us < self.joined.last_us {
            self.put_joined()?;
        }
        let joined = &mut self.joined;
        if joined.pieces.is_empty() {
            (joined.t_us, joined.last_us) = (burst.t_us, burst.t_us);
        }
        let after_us = burst.t_us - joined.last_us;
        joined.pieces.push((after_us, burst.bytes.len()));
        joined.bytes.extend(&burst.bytes);
        joined.last_us = burst.t_us;
        Ok(())
    }

    fn put_joined(&mut self) -> io::Result<()> {
        let joined = std::mem::take(&mut self.joined);
        match joined.pieces.is_empty() {
            true => Ok(()),
            false => self.link(false, joined.t_us, &joined.bytes, &joined.pieces),
        }
    }

    /// What still was so when it was asked last.
    fn put_still(&mut self, topic: Topic) -> io::Result<()> {
        match self.kept[topic as usize].still.take() {
            Some((t_us, data)) => self.put(topic, t_us, &data),
            None => Ok(()),
        }
    }

    /// Makes the channel of a topic that has none: viewers list what there is.
    fn announce(&mut self, topic: Topic) -> u16 {
        let (name, schema) = topic.schema();
        let schema = schema.to_string();
        let schema = self.log.schema(name, "jsonschema", schema.as_bytes());
        let channel = self
            .log
            .channel(schema, topic.name(), "json", &BTreeMap::new());
        *self.channels[topic as usize].insert(channel)
    }

    fn outcome(&mut self, outcome: &Outcome) -> io::Result<()> {
        let metadata = outcome.to_metadata();
        self.digest(self.now_us, &Digest::of(OUTCOME, &metadata))?;
        self.log.metadata(OUTCOME, &metadata)
    }

    fn digest(&mut self, t_us: u64, digest: &Digest) -> io::Result<()> {
        match serde_json::to_vec(digest) {
            Ok(message) => self.put(Topic::Digest, t_us, &message),
            Err(_) => Ok(()),
        }
    }

    /// Closes the chunk and flushes: everything recorded so far survives a crash.
    ///
    /// # Errors
    /// What `into` does not take.
    pub fn flush(&mut self) -> io::Result<()> {
        self.put_joined()?;
        self.log.flush()
    }

    /// Writes the index, and gives back what was written into.
    ///
    /// # Errors
    /// What `into` does not take.
    pub fn finish(mut self) -> io::Result<W> {
        self.put_joined()?;
        for (topic, _) in Topic::ALL {
            self.put_still(topic)?;
        }
        self.log.finish()
    }
}

impl<W: Write> Sink for LogWriter<W> {
    type Error = io::Error;

    fn mounts(&mut self) -> &mut Option<Vec<SonarMount>> {
        &mut self.mounts
    }

    fn put(&mut self, topic: Topic, t_us: u64, data: &[u8]) -> io::Result<()> {
        let sequence = self.sequences[topic as usize];
        self.sequences[topic as usize] = sequence.wrapping_add(1);
        let time_ns = t_us.saturating_mul(1_000);
        let channel = match self.channels[topic as usize] {
            Some(channel) => channel,
            None => self.announce(topic),
        };
        self.log.message(channel, sequence, time_ns, data)
    }

    fn put_new(
        &mut self,
        topic: Topic,
        t_us: u64,
        every_us: u64,
        what: String,
        data: Vec<u8>,
    ) -> io::Result<()> {
        let kept = &mut self.kept[topic as usize];
        let age_us = kept.t_us.map(|then_us| t_us.saturating_sub(then_us));
        let is_same = what == kept.what;
        let is_late = |age_us: u64| age_us >= AGAIN_US && topic.is_repeated();
        if is_same && age_us.is_some_and(|age_us| !is_late(age_us)) {
            kept.still = Some((t_us, data));
            return Ok(());
        }
        if age_us.is_some_and(|age_us| age_us < every_us) {
            return Ok(());
        }
        (kept.what, kept.t_us) = (what, Some(t_us));
        match is_same {
            true => kept.still = None,
            false => self.put_still(topic)?,
        }
        self.put(topic, t_us, &data)
    }
}
