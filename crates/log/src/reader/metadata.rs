//! What a log says of itself, and whether that can be relied on.

use crate::digest::{CUT, Digest, Fields, MANIFEST, NO_END, OUTCOME};
use crate::log::Log;
use crate::manifest::{Manifest, Outcome};
use std::collections::BTreeMap;

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
        if self.records.contains_key(CUT) && log.cut.is_none() {
            log.cut = Some(NO_END.to_owned());
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
