//! The readable parts of a log that is damaged in the middle: the index at its end gives the start of each chunk,
//! however damaged the others are.

use super::intake::{Intake, LONGEST, Stop};
use mcap::MAGIC;
use mcap::parse_record;
use mcap::records::{Footer, Record, op};
use std::io::{Read, Seek, SeekFrom};

/// What a record is and how long \[bytes\].
const HEAD: usize = 9;
/// The footer with its head, and the end of the file behind it \[bytes\].
const END: u64 = (HEAD + 20 + MAGIC.len()) as u64;

/// A part of a log as its index knows it: it can be read alone, when one before it is damaged.
struct Piece {
    at: u64,
    kind: u8,
    /// With its head \[bytes\].
    length: u64,
}

/// The parts of a log.
pub(super) struct Pieces<F> {
    from: F,
    pieces: Vec<Piece>,
    channels: Vec<(u16, String)>,
}

impl<F: Read + Seek> Pieces<F> {
    /// Of a log that has a sound index.
    pub(super) fn find(mut from: F) -> Option<Self> {
        let end = from.seek(SeekFrom::End(0)).ok()?;
        let footer_at = end.checked_sub(END)?;
        let tail = read_at(&mut from, footer_at, END)?;
        let (footer, magic) = tail.split_at(tail.len() - MAGIC.len());
        let Some((op::FOOTER, body, [])) = split(footer).filter(|_| magic == MAGIC) else {
            return None;
        };
        let Ok(Record::Footer(Footer {
            summary_start,
            summary_crc,
            ..
        })) = parse_record(op::FOOTER, body)
        else {
            return None;
        };
        let index = read_at(
            &mut from,
            summary_start,
            footer_at.checked_sub(summary_start)?,
        )?;
        // Of the index and of the footer up to the checksum.
        let covered = [&index[..], footer.split_last_chunk::<4>()?.0].concat();
        let crc = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);
        if summary_crc != 0 && crc.checksum(&covered) != summary_crc {
            return None;
        }
        let mut pieces = Self {
            from,
            pieces: Vec::new(),
            channels: Vec::new(),
        };
        let mut rest = &index[..];
        while let Some((kind, body, next)) = split(rest) {
            pieces.know(parse_record(kind, body).ok()?);
            rest = next;
        }
        pieces.pieces.sort_unstable_by_key(|piece| piece.at);
        (!pieces.pieces.is_empty()).then_some(pieces)
    }

    fn know(&mut self, record: Record<'_>) {
        let (kind, at, length) = match record {
            Record::Channel(channel) => return self.channels.push((channel.id, channel.topic)),
            Record::ChunkIndex(of) => (op::CHUNK, of.chunk_start_offset, of.chunk_length),
            Record::MetadataIndex(of) => (op::METADATA, of.offset, of.length),
            Record::AttachmentIndex(of) => (op::ATTACHMENT, of.offset, of.length),
            _ => return,
        };
        self.pieces.push(Piece { at, kind, length });
    }

    /// All that is whole; `why` the log could not be read from its beginning to its end.
    pub(super) fn take(mut self, why: &str, with_link: bool) -> Intake {
        let mut log = Intake::new(with_link);
        for (id, topic) in &self.channels {
            log.know_channel(*id, topic);
        }
        let mut lost = 0;
        for Piece { at, kind, length } in &self.pieces {
            let bytes = read_at(&mut self.from, *at, *length);
            let is_there = |bytes: &&Vec<u8>| {
                split(bytes).is_some_and(|(found, _, rest)| found == *kind && rest.is_empty())
            };
            match bytes
                .as_ref()
                .filter(is_there)
                .map(|bytes| log.read_piece(bytes))
            {
                Some(Ok(())) => {}
                Some(Err(stop @ Stop::TooMuch(_))) => {
                    log.stop = Some(stop);
                    return log;
                }
                Some(Err(_)) | None => lost += 1,
            }
        }
        match lost {
            0 => log.log.notes.push(format!(
                "it is damaged where nothing was recorded ({why}): nothing of it is missing"
            )),
            _ => log.log.lose(&format!(
                "{why}; {lost} of its {} pieces are left out, the others are there",
                self.pieces.len()
            )),
        }
        log
    }
}

/// The first record of some: what it is, what it holds, and what comes after it.
fn split(bytes: &[u8]) -> Option<(u8, &[u8], &[u8])> {
    let (head, rest) = bytes.split_first_chunk::<HEAD>()?;
    let [kind, length @ ..] = head;
    let (body, rest) = rest.split_at_checked(usize::try_from(u64::from_le_bytes(*length)).ok()?)?;
    Some((*kind, body, rest))
}

fn read_at(from: &mut (impl Read + Seek), at: u64, length: u64) -> Option<Vec<u8>> {
    let mut bytes = vec![
        0;
        usize::try_from(length)
            .ok()
            .filter(|length| *length <= LONGEST)?
    ];
    from.seek(SeekFrom::Start(at)).ok()?;
    from.read_exact(&mut bytes).ok()?;
    Some(bytes)
}
