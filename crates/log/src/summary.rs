//! What a log is, without reading it: from its index, or, where its writer was stopped, from the heads of its records.

use crate::digest::{CUT, MANIFEST};
use crate::error::ReadError;
use crate::manifest::Manifest;
use crate::reader::is_log;
use mcap::records::{MetadataIndex, Record, op};
use mcap::sans_io::summary_reader::{SummaryReadEvent, SummaryReader};
use mcap::{MAGIC, McapResult, parse_record};
use std::io::{self, BufReader, Read, Seek, SeekFrom};

/// A record's head: what it is, and how long.
const HEAD_BYTES: usize = 9;
/// Longer metadata is not a manifest.
const LONGEST_METADATA: u64 = 1 << 20;

/// What a log is.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Summary {
    /// What ran, where the log says so.
    pub manifest: Option<Manifest>,
    /// Time of the last message \[s\].
    pub duration_s: f64,
    /// Its writer was not stopped.
    pub complete: bool,
}

impl Summary {
    /// Reads what is needed of a log, and no more.
    ///
    /// # Errors
    /// Bytes that cannot be read, or are no log.
    pub fn read(mut from: impl Read + Seek) -> Result<Self, ReadError> {
        if !is_log(&mut from)? {
            return Ok(Self::default());
        }
        match Self::by_index(&mut from) {
            Ok(Some(summary)) => Ok(summary),
            // No index, or a damaged one.
            Ok(None) | Err(_) => Ok(Self::by_heads(from)?),
        }
    }

    fn by_index(file: &mut (impl Read + Seek)) -> McapResult<Option<Self>> {
        let mut reader = SummaryReader::new();
        while let Some(event) = reader.next_event() {
            match event? {
                SummaryReadEvent::ReadRequest(count) => {
                    let read = file.read(reader.insert(count))?;
                    reader.notify_read(read);
                }
                SummaryReadEvent::SeekRequest(to) => {
                    let at = file.seek(to)?;
                    reader.notify_seeked(at);
                }
            }
        }
        let Some(index) = reader.finish() else {
            return Ok(None);
        };
        let Some(statistics) = &index.stats else {
            return Ok(None);
        };
        let mut summary = Self {
            manifest: None,
            duration_s: seconds(statistics.message_end_time),
            complete: true,
        };
        for MetadataIndex { offset, name, .. } in &index.metadata_indexes {
            summary.complete &= name != CUT;
            file.seek(SeekFrom::Start(*offset))?;
            if let Some((op::METADATA, length)) = head(file)? {
                summary.take_metadata(file, length)?;
            }
        }
        Ok(Some(summary))
    }

    /// Goes from record to record up to the end, or to where the writer was stopped.
    fn by_heads(mut file: impl Read + Seek) -> io::Result<Self> {
        let end = file.seek(SeekFrom::End(0))?;
        let mut at = file.seek(SeekFrom::Start(MAGIC.len() as u64))?;
        let mut file = BufReader::new(file);
        let mut summary = Self::default();
        while let Some((kind, length)) = head(&mut file)? {
            let body = at + HEAD_BYTES as u64;
            at = body.saturating_add(length);
            if at > end {
                break;
            }
            let mut taken = 0;
            match kind {
                op::DATA_END => {
                    summary.complete = true;
                    break;
                }
                op::METADATA if summary.take_metadata(&mut file, length)? => taken = length,
                // A chunk begins with the times of its first and its last message.
                op::CHUNK if length >= 16 => {
                    let mut times = [[0; 8]; 2];
                    for time in &mut times {
                        file.read_exact(time)?;
                    }
                    taken = 16;
                    let last_s = seconds(u64::from_le_bytes(times[1]));
                    summary.duration_s = summary.duration_s.max(last_s);
                }
                _ => {}
            }
            file.seek_relative(i64::try_from(length - taken).unwrap_or(i64::MAX))?;
        }
        Ok(summary)
    }

    /// Takes the manifest, if this is it; whether the record has been read.
    fn take_metadata(&mut self, file: &mut impl Read, length: u64) -> io::Result<bool> {
        if length > LONGEST_METADATA {
            return Ok(false);
        }
        let mut body = vec![0; length as usize];
        file.read_exact(&mut body)?;
        if let Ok(Record::Metadata(metadata)) = parse_record(op::METADATA, &body)
            && metadata.name == MANIFEST
        {
            self.manifest = Manifest::from_metadata(&metadata.metadata);
        }
        Ok(true)
    }
}

fn seconds(time_ns: u64) -> f64 {
    time_ns as f64 / 1e9
}

/// What comes next and how long it is; `None` at the end.
fn head(file: &mut impl Read) -> io::Result<Option<(u8, u64)>> {
    let (mut kind, mut length) = ([0; 1], [0; 8]);
    let read = file
        .read_exact(&mut kind)
        .and_then(|()| file.read_exact(&mut length));
    match read {
        Ok(()) => Ok(Some((kind[0], u64::from_le_bytes(length)))),
        Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => Ok(None),
        Err(error) => Err(error),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::entry::{Burst, Entry};
    use crate::log::Log;
    use crate::writer::LogWriter;
    use std::io::Cursor;

    #[test]
    fn a_log_is_summed_up_as_it_is_read_whole_or_cut() {
        let manifest = Manifest {
            scenario: Some("mode1".into()),
            seed: Some(7),
            ..Manifest::default()
        };
        let mut writer = LogWriter::new(Cursor::new(Vec::new()), &manifest).unwrap();
        for number in 0..40_000 {
            let burst = Burst {
                t_us: 1_000 * number,
                to_robot: true,
                bytes: number.to_le_bytes().repeat(8),
            };
            writer.record(&Entry::Burst(burst)).unwrap();
        }
        let whole = writer.finish().unwrap().into_inner();
        let log = Log::read(Cursor::new(&whole)).unwrap();
        let summary = Summary::read(Cursor::new(&whole)).unwrap();
        assert_eq!(
            (summary.duration_s, summary.complete),
            (log.duration_s(), true)
        );
        assert_eq!(summary.manifest, Some(manifest));
        let mut lasted = Vec::new();
        for part in 1..20 {
            let cut = &whole[..whole.len() * part / 20];
            let summary = Summary::read(Cursor::new(cut)).unwrap();
            // What is not in its index any more is still in it.
            assert!(!summary.complete || part == 19, "{part}");
            // Of a chunk that is cut a reader may still find some messages.
            let found_s = Log::read(Cursor::new(cut)).unwrap().duration_s();
            assert!(
                (0.0..12.0).contains(&(found_s - summary.duration_s)),
                "{found_s}"
            );
            assert_eq!(summary.manifest.unwrap().seed, Some(7));
            lasted.push(summary.duration_s);
        }
        assert!(
            lasted.is_sorted() && lasted[0] < 10.0 && lasted[10] > 10.0,
            "{lasted:?}"
        );
        assert!(Summary::read(Cursor::new(b"t_s\n0\n1\n2\n3\n")).is_err());
    }
}
