//! Reads a log, whole or cut off.
//!
//! A truncated log, such as that of a killed writer, is read as far as it goes, and [`Log::cut`] says so. Of a log that
//! is damaged in the middle but has its index, everything intact is read. Logs that `rumbo import` made of the original
//! program's CSV are read too, as far as their signals have a place in a [`Row`](crate::signals::Row).

mod intake;
mod metadata;
mod pieces;
mod reading_json;
mod row_json;

use crate::error::ReadError;
use crate::log::Log;
use intake::{Intake, Stop};
use mcap::MAGIC;
use pieces::Pieces;
use rumbo_wire::{Decoder, FrameMessage, FromRobot, Hello, Received};
use std::io::{BufReader, Read, Seek, SeekFrom};

/// Longest line of text from a robot that is put together.
const LINE: usize = 160;
/// A log that is shorter has no whole manifest \[bytes\].
const SHORTEST: u64 = 256;

impl Log {
    /// Reads a log.
    ///
    /// # Errors
    /// Bytes that cannot be read, are no log, or hold nothing known.
    pub fn read(from: impl Read + Seek) -> Result<Self, ReadError> {
        read(from, true)
    }

    /// Reads a log without the raw bytes of its link, for showing.
    ///
    /// # Errors
    /// As [`Log::read`].
    pub fn read_signals(from: impl Read + Seek) -> Result<Self, ReadError> {
        read(from, false)
    }

    /// Reads a log to be shown as a replay: without the raw bytes of its link, unless people read them as text.
    ///
    /// # Errors
    /// As [`Log::read`].
    pub fn read_replay(mut from: impl Read + Seek) -> Result<Self, ReadError> {
        let log = read(&mut from, false)?;
        if !log.speaks_text() {
            return Ok(log);
        }
        from.rewind()?;
        read(from, true)
    }

    /// How the robot first named itself in frames.
    #[must_use]
    pub fn hello(&self) -> Option<Hello> {
        let from_robot = self.link.iter().filter(|burst| !burst.to_robot);
        let mut decoder = Decoder::<LINE>::default();
        from_robot
            .flat_map(|burst| &burst.bytes)
            .find_map(|byte| match decoder.push(*byte) {
                Some(Received::Frame(body)) => match FromRobot::from_body(&body) {
                    Ok(FromRobot::Hello(hello)) => Some(hello),
                    _ => None,
                },
                _ => None,
            })
    }
}

fn read(mut from: impl Read + Seek, with_link: bool) -> Result<Log, ReadError> {
    // What is of another kind may be too long for the memory.
    if !is_log(&mut from)? {
        return Err(ReadError::NothingYet);
    }
    let mut log = Intake::new(with_link).read(MAGIC.chain(BufReader::new(&mut from)));
    if let Some(stop @ (Stop::NoEnd | Stop::Damaged(_))) = &log.stop
        && let Some(pieces) = Pieces::find(&mut from)
    {
        log = pieces.take(stop.text(), with_link);
    }
    let mut log = log.into_log();
    if log.manifest.is_none() && log.rows.is_empty() {
        let length = from.seek(SeekFrom::End(0));
        return Err(match log.cut {
            Some(_) if length.is_ok_and(|length| length < SHORTEST) => ReadError::NothingYet,
            Some(_) => ReadError::CutOff,
            None => ReadError::Foreign,
        });
    }
    // What stayed as it was is written late.
    log.rows.sort_by_key(|row| row.t_ms);
    log.readings.sort_by_key(|reading| reading.t_ms);
    log.states
        .sort_by(|one, other| one.t_s.total_cmp(&other.t_s));
    Ok(log)
}

/// Reads how it begins: false for a log whose writer was stopped before it had begun.
///
/// # Errors
/// Bytes that cannot be read, or are no log.
pub(crate) fn is_log(from: &mut impl Read) -> Result<bool, ReadError> {
    let mut start = Vec::new();
    from.take(MAGIC.len() as u64).read_to_end(&mut start)?;
    match start.as_slice() {
        MAGIC => Ok(true),
        start if MAGIC.starts_with(start) => Ok(false),
        _ => Err(ReadError::NoLog),
    }
}
