//! Checksums of a log's metadata, for which MCAP has none: a message each, in a chunk, which has one.
//!
//! Metadata that does not match its checksum is dropped. Logs of earlier versions have no such checksums: there the
//! checksum of the whole data section is verified instead. A log that lacks that too, because it was truncated, reports
//! that its metadata cannot be verified.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Name of the metadata that says what ran.
pub(crate) const MANIFEST: &str = "manifest";
/// Name of the metadata that says how it ended.
pub(crate) const OUTCOME: &str = "outcome";

/// Name of the metadata, empty, that says that the recording ended early.
pub(crate) const CUT: &str = "cut";

/// Why a log ends of which nothing says that it does, or of which `mend` says so.
pub(crate) const NO_END: &str = "its writer was stopped";

/// Keys and values of a metadata record.
pub(crate) type Fields = BTreeMap<String, String>;

/// The checksum of a metadata record, as its message has it.
#[derive(Debug, Deserialize, Serialize)]
pub(crate) struct Digest {
    /// The record's name.
    pub(crate) name: String,
    /// CRC-32 of its name, keys and values, each ended by a zero byte.
    pub(crate) crc32: u32,
}

impl Digest {
    pub(crate) fn of(name: &str, fields: &Fields) -> Self {
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
