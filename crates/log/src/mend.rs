//! Gives a log whose writer was stopped the end that it lacks, so that every reader of MCAP reads it as a whole one.
//!
//! Chunks stay as they are, to the byte; what was cut within is left out, as a reader leaves it out. A record `cut` says
//! that the recording ended early. A log that is damaged otherwise is left alone.

use crate::container::Container;
use crate::digest::{CUT, Fields, MANIFEST};
use mcap::records::{Record, op};
use mcap::{MAGIC, parse_record};
use std::io::{self, ErrorKind, Read, Write};

/// Longest record that is taken for one \[bytes\].
const LONGEST: u64 = 64 << 20;

/// Writes a log whose end is missing as a whole one. `None` for what is whole, damaged otherwise, or not ours; `into`
/// then holds nothing of use.
///
/// # Errors
/// What cannot be read, and what `into` does not take.
pub fn mend<W: Write>(mut from: impl Read, into: W) -> io::Result<Option<W>> {
    let mut start = [0; MAGIC.len()];
    let Some((op::HEADER, header)) = is_there(from.read_exact(&mut start))?
        .filter(|()| start == MAGIC)
        .and_then(|()| next(&mut from).transpose())
        .transpose()?
    else {
        return Ok(None);
    };
    let Ok(Record::Header(header)) = parse_record(op::HEADER, &header) else {
        return Ok(None);
    };
    let mut log = Container::new(into, &header.profile, &header.library)?;
    let (mut is_ours, mut is_complete) = (false, false);
    while let Some((kind, body)) = next(&mut from)? {
        match (kind, parse_record(kind, &body)) {
            // Past the data: the index behind it is what was cut, or nothing.
            (op::DATA_END, Ok(_)) => {
                is_complete = true;
                break;
            }
            (op::METADATA, Ok(Record::Metadata(found))) => {
                is_ours |= found.name == MANIFEST;
                log.metadata(&found.name, &found.metadata)?;
            }
            (op::ATTACHMENT, Ok(Record::Attachment { header, data, .. })) => {
                log.attach(&header.name, &header.media_type, &data)?;
            }
            (op::CHUNK, Ok(Record::Chunk { header, data })) => {
                if !log.copy_chunk(&body, &header, &data)? {
                    return Ok(None);
                }
            }
            // Made anew.
            (op::MESSAGE_INDEX, Ok(_)) => {}
            _ => return Ok(None),
        }
    }
    if !is_ours || is_complete && is_whole(from)? {
        return Ok(None);
    }
    if !is_complete {
        log.metadata(CUT, &Fields::new())?;
    }
    log.finish().map(Some)
}

/// The next record, unless it is cut.
fn next(from: &mut impl Read) -> io::Result<Option<(u8, Vec<u8>)>> {
    let mut head = [0; 9];
    if is_there(from.read_exact(&mut head))?.is_none() {
        return Ok(None);
    }
    let [kind, length @ ..] = head;
    let length = u64::from_le_bytes(length);
    if length > LONGEST {
        return Err(ErrorKind::InvalidData.into());
    }
    let mut body = Vec::new();
    from.take(length).read_to_end(&mut body)?;
    Ok((body.len() as u64 == length).then_some((kind, body)))
}

/// Nothing, where there is no more.
fn is_there(read: io::Result<()>) -> io::Result<Option<()>> {
    match read {
        Ok(()) => Ok(Some(())),
        Err(error) if error.kind() == ErrorKind::UnexpectedEof => Ok(None),
        Err(error) => Err(error),
    }
}

/// Whether what follows the data ends as a log ends.
fn is_whole(mut from: impl Read) -> io::Result<bool> {
    let mut rest = Vec::new();
    from.read_to_end(&mut rest)?;
    Ok(rest.ends_with(MAGIC))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Burst, Entry, Log, LogWriter, Manifest, Summary};
    use std::io::Cursor;

    #[test]
    fn a_log_cut_anywhere_becomes_whole_and_holds_all_that_could_be_read_of_it() {
        let manifest = Manifest {
            seed: Some(7),
            files: [("robot".to_owned(), "name = \"x\"\n".to_owned())].into(),
            ..Manifest::default()
        };
        let mut writer = LogWriter::new(Cursor::new(Vec::new()), &manifest).unwrap();
        for number in 0..3_000_u64 {
            let burst = Burst {
                t_us: 1_000 * number,
                to_robot: number % 3 == 0,
                bytes: number.to_le_bytes().repeat(8),
            };
            writer.record(&Entry::Burst(burst)).unwrap();
        }
        let whole = writer.finish().unwrap().into_inner();
        let mended = |bytes: &[u8]| mend(bytes, Vec::new());
        assert!(mended(&whole).unwrap().is_none());
        let (mut most, mut given) = (0, 0);
        for length in (0..whole.len())
            .step_by(whole.len() / 40)
            .chain([whole.len() - 1])
        {
            let cut = &whole[..length];
            let before = Log::read(Cursor::new(cut));
            let Some(after) = mended(cut).unwrap() else {
                assert!(before.is_err(), "{length}");
                continue;
            };
            // Once is enough.
            assert!(mended(&after).unwrap().is_none());
            let index = mcap::Summary::read(&after).unwrap().unwrap();
            let stats = index.stats.unwrap();
            let (before, log) = (before.unwrap(), Log::read(Cursor::new(&after)).unwrap());
            assert_eq!(log.link, before.link, "{length}");
            assert_eq!(log.manifest, before.manifest);
            // With the checksum of the manifest.
            assert!(log.link.is_empty() || stats.message_count > 1);
            let is_cut = length < whole.len() - 1 && log.link.len() < 3_000;
            assert!(!is_cut || log.cut.is_some() && !log.has_holes);
            assert_eq!(
                Summary::read(Cursor::new(&after)).unwrap().complete,
                log.cut.is_none()
            );
            (most, given) = (most.max(log.link.len()), given + 1);
        }
        assert!(most == 3_000 && given > 10, "{most} {given}");
        // A chunk that is damaged, in a log without an end, is for nobody to judge.
        let mut damaged = whole[..whole.len() / 2].to_vec();
        let middle = damaged.len() / 2;
        damaged[middle] ^= 1;
        assert!(mended(&damaged).unwrap().is_none());
        assert!(mended(b"t_s\n0\n").unwrap().is_none());
    }
}
