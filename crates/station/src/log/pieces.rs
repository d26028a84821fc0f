//! What is left of a log that is damaged within: its index, at its end, tells where each part begins, whatever became of the parts before.

use super::Log;
use super::reader::{Channel, NO_END};
use mcap::MAGIC;
use std::collections::HashMap;
use std::io::Read;
use std::path::Path;

/// The parts of a log as its index knows them: each can be read alone, when one before it is damaged.
pub(super) struct Pieces {
    bytes: Vec<u8>,
    index: mcap::Summary,
}

impl Pieces {
    /// Of a log that has an index.
    pub(super) fn find(path: &Path) -> Option<Self> {
        let bytes = std::fs::read(path).ok()?;
        let index = mcap::Summary::read(&bytes).ok().flatten()?;
        (!index.chunk_indexes.is_empty()).then_some(Self { bytes, index })
    }

    /// All that is whole.
    pub(super) fn take(&self, error: &str, with_link: bool) -> Log {
        let index = &self.index;
        let chunks = index
            .chunk_indexes
            .iter()
            .map(|chunk| (chunk.chunk_start_offset, chunk.chunk_length));
        let metadata = index
            .metadata_indexes
            .iter()
            .map(|of| (of.offset, of.length));
        let files = index
            .attachment_indexes
            .iter()
            .map(|of| (of.offset, of.length));
        let mut places: Vec<(u64, u64)> = chunks.chain(metadata).chain(files).collect();
        places.sort_unstable();
        let mut channels: HashMap<u16, Option<Channel>> = index
            .channels
            .iter()
            .map(|(id, channel)| (*id, Channel::of(&channel.topic, with_link)))
            .collect();
        let (mut log, mut lost) = (Log::default(), 0);
        for (at, length) in &places {
            let piece = self
                .bytes
                .get(*at as usize..at.saturating_add(*length) as usize);
            let taken = piece
                .map(|piece| log.take_all(MAGIC.chain(piece), *length, &mut channels, with_link));
            lost += usize::from(!matches!(taken, Some(Err(end)) if end == NO_END));
        }
        log.cut = Some(format!(
            "{error}; {lost} of its {} pieces are left out, the others are there",
            places.len()
        ));
        log.has_holes = true;
        log
    }
}
