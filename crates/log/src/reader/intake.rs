//! Reads a log record by record and verifies its checksums.
//!
//! MCAP has checksums of chunks, of attachments, of the data section and of the index; [`crate::digest`] adds one for
//! metadata. A flipped bit may turn a record without a checksum into another kind of record: so only records
//! that belong in a log are accepted.

use super::metadata::Metadata;
use super::reading_json::Readings;
use super::row_json::Signals;
use crate::digest::{Digest, NO_END};
use crate::entry::{Burst, Said};
use crate::event::{Level, LoggedEvent};
use crate::frames::Frames;
use crate::log::{Log, SentIndex};
use crate::reading::{Reading, ReadingSource};
use crate::scene::Scene;
use crate::schema::Topic;
use crate::signals::Row;
use crate::state::State;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use mcap::parse_record;
use mcap::records::Record;
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};
use serde::Deserialize;
use std::borrow::Cow;
use std::collections::HashMap;
use std::io::Read;

/// Longest record of a log: what its compressed chunks may hold \[bytes\].
pub(super) const LONGEST: usize = 64 << 20;
/// Longest log: a week of the target's time \[s\].
const LONGEST_S: f64 = 604_800.0;
/// What a log may fill of the memory, half a day of telemetry and link \[bytes\].
const LARGEST: usize = 256 << 20;
/// The topic of a log made by `rumbo import`.
const IMPORTED: &str = "telemetry";

/// Why a log is not read to its end.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Stop {
    /// Nothing says that it ends there, after a whole record.
    NoEnd,
    /// It is damaged.
    Damaged(String),
    /// It holds more than is read.
    TooMuch(String),
}

impl Stop {
    pub(super) fn text(&self) -> &str {
        match self {
            Self::NoEnd => NO_END,
            Self::Damaged(why) | Self::TooMuch(why) => why,
        }
    }
}

/// What messages of a channel are.
#[derive(Clone, Copy)]
enum Channel {
    Ours(Topic),
    Imported,
    /// Another program's, or not wanted now.
    Other,
}

/// Which part of a log is being read.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Part {
    Beginning,
    Data,
    Index,
}

/// A log that is being read.
pub(super) struct Intake {
    pub(super) log: Log,
    channels: HashMap<u16, Channel>,
    metadata: Metadata,
    with_link: bool,
    readings: Readings,
    part: Part,
    /// The checksum of all data is right.
    verified: bool,
    /// Memory filled so far \[bytes\].
    filled: usize,
    /// Why reading ended before the log's end.
    pub(super) stop: Option<Stop>,
}

impl Intake {
    pub(super) fn new(with_link: bool) -> Self {
        Self {
            log: Log::default(),
            channels: HashMap::new(),
            metadata: Metadata::default(),
            with_link,
            readings: Readings::default(),
            part: Part::Beginning,
            verified: false,
            filled: 0,
            stop: None,
        }
    }

    /// Reads a log.
    pub(super) fn read(mut self, from: impl Read) -> Self {
        let options = LinearReaderOptions::default()
            .with_validate_data_section_crc(true)
            .with_validate_summary_section_crc(true)
            .with_check_finishes_after_end_magic(true);
        self.stop = self.take_all(from, options).err();
        // Of a log whose data are whole, only the index can be what is wrong.
        if self.part == Part::Index && self.verified && self.stop.take().is_some() {
            let note = "its index is damaged or cut off; what it recorded is whole";
            self.log.notes.push(note.into());
        }
        self
    }

    /// Reads a piece of a log: a record of its data.
    pub(super) fn read_piece(&mut self, piece: &[u8]) -> Result<(), Stop> {
        self.part = Part::Data;
        let options = LinearReaderOptions::default()
            .with_skip_start_magic(true)
            .with_skip_end_magic(true);
        match self.take_all(piece, options) {
            Err(Stop::NoEnd) => Ok(()),
            Err(stop) => Err(stop),
            Ok(()) => Err(Stop::Damaged("an end within".into())),
        }
    }

    /// A channel that the log's index names.
    pub(super) fn know_channel(&mut self, id: u16, topic: &str) {
        let channel = match Topic::find(topic) {
            Some(Topic::FromRobot | Topic::ToRobot) if !self.with_link => Channel::Other,
            Some(topic) => Channel::Ours(topic),
            None if topic == IMPORTED => Channel::Imported,
            None => Channel::Other,
        };
        self.channels.insert(id, channel);
    }

    /// What has been read, with what is known of it.
    pub(super) fn into_log(self) -> Log {
        let mut log = self.log;
        if let Some(stop) = self.stop {
            log.cut = Some(stop.text().to_owned());
        }
        self.metadata.settle(&mut log, self.verified);
        log
    }

    fn take_all(&mut self, mut from: impl Read, options: LinearReaderOptions) -> Result<(), Stop> {
        let damaged = |error: mcap::McapError| match error {
            mcap::McapError::UnexpectedEof => Stop::Damaged(NO_END.into()),
            other => Stop::Damaged(other.to_string()),
        };
        let options = options
            // Nothing of a damaged chunk is taken, its lengths least of all.
            .with_prevalidate_chunk_crcs(true)
            .with_record_length_limit(LONGEST);
        let mut reader = LinearReader::new_with_options(options);
        reader
            .add_decompressor(Frames::lz4(LONGEST))
            .map_err(damaged)?;
        while let Some(event) = reader.next_event() {
            match event.map_err(damaged)? {
                LinearReadEvent::ReadRequest(count) => {
                    let into = reader.insert(count);
                    let read = from.read(into).map_err(|error| damaged(error.into()))?;
                    reader.notify_read(read);
                }
                LinearReadEvent::Record { opcode, data } => {
                    let record = parse_record(opcode, data).map_err(damaged)?;
                    if !is_exact(&record, data.len()) {
                        return Err(misplaced(opcode));
                    }
                    self.take_record(record, opcode)?;
                }
            }
        }
        match self.part {
            Part::Index => Ok(()),
            _ => Err(Stop::NoEnd),
        }
    }

    fn take_record(&mut self, record: Record<'_>, opcode: u8) -> Result<(), Stop> {
        let part = match (&record, self.part) {
            (Record::Header(_), Part::Beginning) => Part::Data,
            (_, Part::Beginning) | (Record::Header(_), _) => return Err(misplaced(opcode)),
            (Record::DataEnd(_), Part::Data) => Part::Index,
            (_, part) => part,
        };
        self.part = part;
        match record {
            // The index says once more what is known.
            _ if part == Part::Index && !matches!(record, Record::DataEnd(_)) => {}
            Record::Header(_) | Record::Schema { .. } | Record::MessageIndex(_) => {}
            Record::Channel(channel) => self.know_channel(channel.id, &channel.topic),
            Record::Message { header, data } => {
                let t_s = header.log_time as f64 / 1e9;
                let Some(channel) = self.channels.get(&header.channel_id).copied() else {
                    return Err(Stop::Damaged(format!(
                        "a message at {t_s:.3} s is of no channel"
                    )));
                };
                if t_s > LONGEST_S {
                    return Err(Stop::Damaged(format!(
                        "a message is of the time {t_s:.0} s: must be within 0..{LONGEST_S} s"
                    )));
                }
                self.take(channel, header.log_time, &data)
                    .map_err(|error| {
                        Stop::Damaged(format!("a message at {t_s:.3} s is damaged ({error})"))
                    })?;
                if self.filled > LARGEST {
                    return Err(Stop::TooMuch(format!(
                        "it holds more than {} MB; what comes after {t_s:.1} s is left out",
                        LARGEST >> 20
                    )));
                }
            }
            Record::Metadata(metadata) => self.metadata.take(metadata.name, metadata.metadata),
            Record::Attachment { header, data, .. } => {
                if let Some(name) = header.name.strip_suffix(".toml") {
                    let text = String::from_utf8_lossy(&data).into_owned();
                    self.metadata.take_file(name, text);
                }
            }
            // Zero stands for none.
            Record::DataEnd(end) => self.verified = end.data_section_crc != 0,
            _ => return Err(misplaced(opcode)),
        }
        Ok(())
    }

    fn take(&mut self, channel: Channel, time_ns: u64, data: &[u8]) -> serde_json::Result<()> {
        let t_us = time_ns / 1_000;
        let t_ms = (t_us / 1_000) as i64;
        let topic = match channel {
            Channel::Ours(topic) => topic,
            Channel::Imported => Topic::Telemetry,
            Channel::Other => return Ok(()),
        };
        let log = &mut self.log;
        self.filled += match topic {
            // As text they are about as long as in memory.
            Topic::State | Topic::Parameters | Topic::Events | Topic::Scene => 2 * data.len(),
            Topic::FromRobot | Topic::ToRobot => size_of::<Burst>() + data.len(),
            Topic::Console => size_of::<Said>() + data.len(),
            Topic::Telemetry | Topic::Digest | Topic::Truth | Topic::Loops | Topic::Others => 0,
            Topic::Printed | Topic::Estimated | Topic::True | Topic::World => 0,
            Topic::Body | Topic::Frames | Topic::ServoFrame | Topic::FixedFrames => 0,
        };
        match topic {
            Topic::Telemetry => {
                let Signals(mut row) = serde_json::from_slice(data)?;
                row.t_ms = t_ms;
                if !row.is_empty() {
                    self.filled += size_of::<Row>();
                    log.rows.push(row);
                }
            }
            Topic::State => {
                let state: State = serde_json::from_slice(data)?;
                if !(0.0..=LONGEST_S).contains(&state.t_s) {
                    let what = format!("t_s = {}: must be within 0..{LONGEST_S}", state.t_s);
                    return Err(serde::de::Error::custom(what));
                }
                log.states.push(state);
            }
            Topic::Parameters => log.parameters.push((t_ms, serde_json::from_slice(data)?)),
            Topic::Events => log.events.push(event(t_ms, serde_json::from_slice(data)?)),
            Topic::Scene => {
                let Around { scene } = serde_json::from_slice(data)?;
                log.scene = scene;
            }
            Topic::FromRobot | Topic::ToRobot => {
                let Bytes { data, pieces } = serde_json::from_slice(data)?;
                let to_robot = topic == Topic::ToRobot;
                if to_robot {
                    log.order.push(SentIndex::Link(log.link.len()));
                }
                self.filled += size_of::<Burst>() * pieces.len();
                let bursts = bursts(to_robot, t_us, decoded(&data)?, &pieces);
                log.link.extend(bursts.ok_or_else(|| {
                    serde::de::Error::custom("its pieces are not those of its data")
                })?);
            }
            Topic::Console => {
                let Console {
                    usart,
                    to_chip,
                    data,
                } = serde_json::from_slice(data)?;
                if to_chip {
                    log.order.push(SentIndex::Said(log.said.len()));
                }
                log.said.push(Said {
                    t_us,
                    usart,
                    to_chip,
                    bytes: decoded(&data)?,
                });
            }
            Topic::Truth | Topic::Loops | Topic::Others => {
                let source = match topic {
                    Topic::Loops => ReadingSource::Loops,
                    Topic::Others => ReadingSource::Others,
                    _ => ReadingSource::Truth,
                };
                log.readings.push(self.readings.shown(t_ms, source, data)?);
                self.filled += size_of::<Reading>() + data.len() / 4;
            }
            Topic::Printed => {
                log.readings.push(self.readings.printed(t_ms, data)?);
                self.filled += size_of::<Reading>() + data.len();
            }
            Topic::Digest => {
                let digest: Digest = serde_json::from_slice(data)?;
                self.metadata.take_digest(digest);
            }
            // Made of what the others hold.
            Topic::Estimated | Topic::True | Topic::World => {}
            Topic::Body | Topic::Frames | Topic::ServoFrame | Topic::FixedFrames => {}
        }
        Ok(())
    }
}

/// Whether a record is as long as what it holds: one that a flipped bit has made of another kind, or longer, is not.
fn is_exact(record: &Record<'_>, length: usize) -> bool {
    let text = |text: &str| 4 + text.len();
    length
        == match record {
            Record::Header(header) => text(&header.profile) + text(&header.library),
            Record::Channel(channel) => {
                let pairs = channel.metadata.iter();
                let pairs: usize = pairs.map(|(key, value)| text(key) + text(value)).sum();
                8 + text(&channel.topic) + text(&channel.message_encoding) + pairs
            }
            Record::MessageIndex(index) => 6 + 16 * index.records.len(),
            Record::Metadata(metadata) => {
                let pairs = metadata.metadata.iter();
                let pairs: usize = pairs.map(|(key, value)| text(key) + text(value)).sum();
                text(&metadata.name) + 4 + pairs
            }
            Record::Attachment { header, data, .. } => {
                28 + text(&header.name) + text(&header.media_type) + data.len()
            }
            _ => length,
        }
}

fn misplaced(opcode: u8) -> Stop {
    Stop::Damaged(format!(
        "a record of kind 0x{opcode:02x} is where none belongs"
    ))
}

#[derive(Deserialize)]
struct Around {
    scene: Option<Scene>,
}

#[derive(Deserialize)]
struct Bytes<'a> {
    #[serde(borrow)]
    data: Cow<'a, str>,
    /// In which it came: how long after the one before \[us\], and how many bytes.
    #[serde(default)]
    pieces: Vec<(u64, usize)>,
}

#[derive(Deserialize)]
struct Console<'a> {
    usart: u8,
    to_chip: bool,
    #[serde(borrow)]
    data: Cow<'a, str>,
}

/// Each piece of what crossed the link; `None` if they are not those of these bytes.
fn bursts(
    to_robot: bool,
    mut t_us: u64,
    bytes: Vec<u8>,
    pieces: &[(u64, usize)],
) -> Option<Vec<Burst>> {
    let burst = |t_us, bytes| Burst {
        t_us,
        to_robot,
        bytes,
    };
    if pieces.is_empty() {
        return Some(vec![burst(t_us, bytes)]);
    }
    let mut rest = &bytes[..];
    let mut bursts = Vec::with_capacity(pieces.len());
    for (after_us, length) in pieces {
        t_us = t_us.checked_add(*after_us)?;
        let (piece, next) = rest.split_at_checked(*length)?;
        bursts.push(burst(t_us, piece.to_vec()));
        rest = next;
    }
    (rest.is_empty() && t_us as f64 <= LONGEST_S * 1e6).then_some(bursts)
}

fn decoded(data: &str) -> serde_json::Result<Vec<u8>> {
    STANDARD
        .decode(data.as_bytes())
        .map_err(serde::de::Error::custom)
}

#[derive(Deserialize)]
struct Happened {
    level: u8,
    message: String,
    name: String,
}

fn event(t_ms: i64, said: Happened) -> LoggedEvent {
    let level = match (said.level, said.name.as_str()) {
        (_, "good") => Level::Good,
        (3, _) => Level::Warning,
        (4.., _) => Level::Fault,
        _ => Level::Info,
    };
    LoggedEvent {
        t_s: t_ms as f64 / 1e3,
        level,
        text: said.message,
    }
}
