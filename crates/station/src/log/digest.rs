//! Checksums of a log's metadata, for which MCAP has none: a message each, in a chunk, which has one.
//!
//! Metadata that is not what its checksum says is left out. In a log without such checksums, of a version before they
//! were written, the checksum of the whole data section stands for them; a log that lacks that too, because it was cut
//! off, says that its metadata cannot be verified.

use super::{Log, Manifest, Outcome};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Name of the metadata that says what ran.
pub(super) const MANIFEST: &str = "manifest";
/// Name of the metadata that says how it ended.
pub(super) const OUTCOME: &str = "outcome";

type Fields = BTreeMap<String, String>;

/// The checksum of a metadata record, as its message has it.
#[derive(Debug, Deserialize, Serialize)]
pub(super) struct Digest {
    /// The record's name.
    name: String,
    /// CRC-32 of its name, keys and values, each ended by a zero byte.
    crc32: u32,
}

impl Digest {
    pub(super) fn of(name: &str, fields: &Fields) -> Self {
        let crc = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);
        let mut digest = crc.digest();
        let pairs = fields.iter().flat_map(|(key, value)| [key, value]);
        for text in std::iter::once(name).chain(pairs.map(String::as_str)) {
            digest.update(text.as_bytes());
            digest.update(&[0]);
        }
        Self {
            name: name.to_owned(),
            crc32: digest.finalize(),
        }
    }
}

/// What a log says of itself, until all of it has been read.
#[derive(Debug, Default)]
pub(super) struct Metadata {
    records: BTreeMap<String, Fields>,
    files: Fields,
    digests: BTreeMap<String, u32>,
}

impl Metadata {
    pub(super) fn take(&mut self, name: String, fields: Fields) {
        self.records.insert(name, fields);
    }

    pub(super) fn take_file(&mut self, name: &str, text: String) {
        self.files.insert(name.to_owned(), text);
    }

    pub(super) fn take_digest(&mut self, digest: Digest) {
        self.digests.insert(digest.name, digest.crc32);
    }

    /// Puts what is sound into the log; `verified`: the checksum of all data has been found to be right.
    pub(super) fn settle(mut self, log: &mut Log, verified: bool) {
        let manifest = self.sound(MANIFEST, log, verified);
        log.manifest = manifest.and_then(|fields| Manifest::from_metadata(&fields));
        if let Some(manifest) = &mut log.manifest {
            manifest.files = std::mem::take(&mut self.files);
        }
        let outcome = self.sound(OUTCOME, log, verified);
        log.outcome = outcome.map(|fields| Outcome::from_metadata(&fields));
    }

    /// A record, if it is not known to be damaged.
    fn sound(&mut self, name: &str, log: &mut Log, verified: bool) -> Option<Fields> {
        let record = self.records.remove(name);
        let found = record.as_ref().map(|fields| Digest::of(name, fields).crc32);
        match (self.digests.get(name), found) {
            (Some(due), Some(found)) if *due == found => record,
            (None, Some(_)) if verified => record,
            (None, Some(_)) => {
                log.notes.push(format!(
                    "its {name} cannot be verified: no checksum of it is there, as in logs of older versions"
                ));
                record
            }
            (None, None) => None,
            (Some(_), _) => {
                log.lose(&format!("its {name} is damaged and left out"));
                None
            }
        }
    }
}
