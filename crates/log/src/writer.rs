//! Writes a log: manifest and files first, then messages as they come.

use crate::digest::{Digest, MANIFEST, OUTCOME};
use crate::entry::Entry;
use crate::manifest::{Manifest, Outcome};
use crate::messages::Sink;
use crate::schema::Topic;
pub use mcap::McapError as WriteError;
use mcap::records::{MessageHeader, Metadata};
use mcap::{Attachment, Compression, WriteOptions, Writer};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::{Seek, Write};

/// A chunk is closed at this size before compression \[bytes\]: what a damaged or cut one takes with it.
const CHUNK: u64 = 64 << 10;

/// How chunks are compressed. In a browser they are not: that would take a compiler for C.
#[cfg(not(target_family = "wasm"))]
const COMPRESSION: Option<Compression> = Some(Compression::Lz4);
#[cfg(target_family = "wasm")]
const COMPRESSION: Option<Compression> = None;

/// A log being written.
pub struct LogWriter<W: Write + Seek> {
    log: Writer<W>,
    channels: [u16; Topic::ALL.len()],
    sequences: [u32; Topic::ALL.len()],
    /// The time of what came last \[us\].
    now_us: u64,
}

impl<W: Write + Seek> LogWriter<W> {
    /// A log that begins with its manifest.
    ///
    /// # Errors
    /// What `into` does not take.
    pub fn new(into: W, manifest: &Manifest) -> Result<Self, WriteError> {
        let mut log = WriteOptions::new()
            .compression(COMPRESSION)
            .chunk_size(Some(CHUNK))
            // The file only grows: killed at any moment, all chunks but the last are whole.
            .disable_seeking(true)
            .profile("")
            .library(concat!("rumbo ", env!("CARGO_PKG_VERSION")))
            .create(into)?;
        let metadata = manifest.to_metadata();
        let digest = Digest::of(MANIFEST, &metadata);
        log.write_metadata(&Metadata {
            name: MANIFEST.into(),
            metadata,
        })?;
        for (name, text) in &manifest.files {
            log.attach(&Attachment {
                log_time: 0,
                create_time: 0,
                name: format!("{name}.toml"),
                media_type: "application/toml".into(),
                data: Cow::Borrowed(text.as_bytes()),
            })?;
        }
        let mut channels = [0; Topic::ALL.len()];
        for topic in Topic::ALL {
            let (name, schema) = topic.schema();
            let schema = log.add_schema(name, "jsonschema", schema.to_string().as_bytes())?;
            channels[topic as usize] =
                log.add_channel(schema, topic.name(), "json", &BTreeMap::new())?;
        }
        let mut log = Self {
            log,
            channels,
            sequences: [0; Topic::ALL.len()],
            now_us: 0,
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
    pub fn record(&mut self, entry: &Entry) -> Result<(), WriteError> {
        if let Entry::Outcome(outcome) = entry {
            return self.outcome(outcome);
        }
        let mut now_us = self.now_us;
        self.entry(entry, &mut now_us)?;
        self.now_us = now_us;
        Ok(())
    }

    fn outcome(&mut self, outcome: &Outcome) -> Result<(), WriteError> {
        let metadata = outcome.to_metadata();
        self.digest(self.now_us, &Digest::of(OUTCOME, &metadata))?;
        self.log.write_metadata(&Metadata {
            name: OUTCOME.into(),
            metadata,
        })
    }

    fn digest(&mut self, t_us: u64, digest: &Digest) -> Result<(), WriteError> {
        match serde_json::to_vec(digest) {
            Ok(message) => self.put(Topic::Digest, t_us, &message),
            Err(_) => Ok(()),
        }
    }

    /// Closes the chunk and flushes: everything recorded so far survives a crash.
    ///
    /// # Errors
    /// What `into` does not take.
    pub fn flush(&mut self) -> Result<(), WriteError> {
        self.log.flush()
    }

    /// Writes the index, and gives back what was written into.
    ///
    /// # Errors
    /// What `into` does not take.
    pub fn finish(mut self) -> Result<W, WriteError> {
        self.log.finish()?;
        let mut into = self.log.into_inner();
        into.flush()?;
        Ok(into)
    }
}

impl<W: Write + Seek> Sink for LogWriter<W> {
    type Error = WriteError;

    fn put(&mut self, topic: Topic, t_us: u64, data: &[u8]) -> Result<(), WriteError> {
        let sequence = self.sequences[topic as usize];
        self.sequences[topic as usize] = sequence.wrapping_add(1);
        let time_ns = t_us.saturating_mul(1_000);
        let header = MessageHeader {
            channel_id: self.channels[topic as usize],
            sequence,
            log_time: time_ns,
            publish_time: time_ns,
        };
        self.log.write_to_known_channel(&header, data)
    }
}
