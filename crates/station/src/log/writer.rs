//! Writes a log: manifest and files first, then messages as they come.

use super::digest::{Digest, MANIFEST, OUTCOME};
use super::messages::Sink;
use super::schema::Topic;
use super::{Manifest, Outcome};
use mcap::records::{MessageHeader, Metadata};
use mcap::{Attachment, Compression, McapError, McapResult, WriteOptions, Writer};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::{Seek, Write};

/// A chunk is closed at this size before compression \[bytes\]: what a damaged or cut one takes with it.
const CHUNK: u64 = 64 << 10;

/// A log being written.
pub(super) struct LogWriter<W: Write + Seek> {
    log: Writer<W>,
    channels: [u16; Topic::ALL.len()],
    sequences: [u32; Topic::ALL.len()],
}

impl<W: Write + Seek> LogWriter<W> {
    /// A log that begins with its manifest.
    pub(super) fn new(into: W, manifest: &Manifest) -> McapResult<Self> {
        let mut log = WriteOptions::new()
            .compression(Some(Compression::Lz4))
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
        };
        log.digest(0, &digest)?;
        Ok(log)
    }

    /// How the run ended, and when \[us\].
    pub(super) fn outcome(&mut self, t_us: u64, outcome: &Outcome) -> McapResult<()> {
        let metadata = outcome.to_metadata();
        self.digest(t_us, &Digest::of(OUTCOME, &metadata))?;
        self.log.write_metadata(&Metadata {
            name: OUTCOME.into(),
            metadata,
        })
    }

    fn digest(&mut self, t_us: u64, digest: &Digest) -> McapResult<()> {
        match serde_json::to_vec(digest) {
            Ok(message) => self.put(Topic::Digest, t_us, &message),
            Err(_) => Ok(()),
        }
    }

    /// Closes the chunk and hands everything to the system.
    pub(super) fn flush(&mut self) -> McapResult<()> {
        self.log.flush()
    }

    /// Writes the index.
    pub(super) fn finish(mut self) -> McapResult<()> {
        self.log.finish()?;
        self.log.into_inner().flush().map_err(Into::into)
    }
}

impl<W: Write + Seek> Sink for LogWriter<W> {
    type Error = McapError;

    fn put(&mut self, topic: Topic, t_us: u64, data: &[u8]) -> McapResult<()> {
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
