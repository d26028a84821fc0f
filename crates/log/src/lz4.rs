//! LZ4 without C, so that a browser reads the same logs by the same code.

use lz4_flex::frame::FrameDecoder;
use mcap::sans_io::decompressor::{DecompressResult, Decompressor};
use mcap::{McapError, McapResult};
use std::io::{self, Read};

/// Input of the first attempt, doubled for each further one \[bytes\]: a whole chunk of ours.
const FIRST: usize = 64 << 10;

/// Decompresses chunks, each frame as a whole.
pub(crate) struct Lz4 {
    /// A frame must not become longer \[bytes\].
    longest: usize,
    /// What is not decompressed yet.
    frame: Vec<u8>,
    /// What came of the last frame, and how much of that has been given.
    text: Vec<u8>,
    given: usize,
}

impl Lz4 {
    /// For frames of at most this many bytes.
    pub(crate) fn new(longest: usize) -> Self {
        Self {
            longest,
            frame: Vec::new(),
            text: Vec::new(),
            given: 0,
        }
    }

    /// Decompresses the first frame, if all of it is there.
    fn try_frame(&mut self) -> McapResult<()> {
        self.text.clear();
        self.given = 0;
        let Some(frame) = frame_length(&self.frame).and_then(|end| self.frame.get(..end)) else {
            return Ok(());
        };
        let failed = |error: io::Error| McapError::DecompressionError(error.to_string());
        let mut text = FrameDecoder::new(frame).take(self.longest as u64 + 1);
        let length = text.read_to_end(&mut self.text).map_err(failed)?;
        if length > self.longest {
            let why = format!("a frame is longer than {} bytes", self.longest);
            return Err(McapError::DecompressionError(why));
        }
        self.frame.drain(..frame.len());
        Ok(())
    }
}

/// The length of the first frame, from its block sizes; `None` while more has to come to know it. What is no frame is
/// left to the decoder.
fn frame_length(bytes: &[u8]) -> Option<usize> {
    const MAGIC: [u8; 4] = 0x184d_2204_u32.to_le_bytes();
    const UNCOMPRESSED: u32 = 1 << 31;
    let (magic, rest) = bytes.split_first_chunk()?;
    if *magic != MAGIC {
        return Some(bytes.len());
    }
    let flags = *rest.first()?;
    let length = |flag: u8, length: usize| if flags & flag == 0 { 0 } else { length };
    let (block_checksum, content_checksum) = (length(0x10, 4), length(0x04, 4));
    // Flags, block size, checksum of the header.
    let mut at = MAGIC.len() + 3 + length(0x08, 8) + length(0x01, 4);
    loop {
        let size = u32::from_le_bytes(*bytes.get(at..)?.first_chunk()?) & !UNCOMPRESSED;
        at += 4;
        match size {
            0 => return Some(at + content_checksum),
            size => at += size as usize + block_checksum,
        }
    }
}

impl Decompressor for Lz4 {
    fn next_read_size(&self) -> usize {
        match self.given < self.text.len() {
            true => 0,
            false => self.frame.len().max(FIRST),
        }
    }

    fn decompress(&mut self, from: &[u8], into: &mut [u8]) -> McapResult<DecompressResult> {
        let mut consumed = 0;
        if self.given == self.text.len() {
            self.frame.extend_from_slice(from);
            consumed = from.len();
            self.try_frame()?;
        }
        let left = self.text.get(self.given..).unwrap_or_default();
        let wrote = left.len().min(into.len());
        into[..wrote].copy_from_slice(&left[..wrote]);
        self.given += wrote;
        Ok(DecompressResult { consumed, wrote })
    }

    fn reset(&mut self) -> McapResult<()> {
        self.frame.clear();
        self.text.clear();
        self.given = 0;
        Ok(())
    }

    fn name(&self) -> &'static str {
        "lz4"
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    /// A frame of blocks that refer to each other, as the library in C writes them.
    fn frame(text: &[u8]) -> Vec<u8> {
        let info = lz4_flex::frame::FrameInfo::new()
            .block_mode(lz4_flex::frame::BlockMode::Linked)
            .block_size(lz4_flex::frame::BlockSize::Max64KB);
        let mut frame = lz4_flex::frame::FrameEncoder::with_frame_info(info, Vec::new());
        frame.write_all(text).unwrap();
        frame.finish().unwrap()
    }

    #[test]
    fn frames_are_decompressed_however_they_arrive_and_whatever_room_there_is() {
        let text: Vec<u8> = (0..300_000u32).map(|at| (at / 7 % 251) as u8).collect();
        let frames = [frame(&text[..200_000]), frame(&text[200_000..])].concat();
        for (piece, room) in [(1, 70_000), (1_000, 1_000), (frames.len(), 13)] {
            let mut lz4 = Lz4::new(200_000);
            let (mut into, mut at, mut found) = (vec![0; room], 0, Vec::new());
            while found.len() < text.len() {
                let end = frames.len().min(at + piece);
                // A call without input when there is some is a stall.
                let done = lz4.decompress(&frames[at..end], &mut into).unwrap();
                assert!(done.consumed + done.wrote > 0);
                at += done.consumed;
                found.extend_from_slice(&into[..done.wrote]);
            }
            assert!(found == text && at == frames.len());
            lz4.reset().unwrap();
        }
    }

    #[test]
    fn a_frame_that_is_damaged_or_too_long_is_an_error_and_no_loop() {
        let text = [7; 100_000];
        let sound = frame(&text);
        for at in 0..sound.len() {
            let mut damaged = sound.clone();
            damaged[at] ^= 0x41;
            let mut lz4 = Lz4::new(text.len());
            let mut into = vec![0; text.len()];
            // An error, or more input is waited for, or other bytes: a chunk has a checksum.
            let _ = lz4.decompress(&damaged, &mut into);
            assert!(lz4.text.len() <= text.len() + 1);
        }
        let mut lz4 = Lz4::new(1_000);
        let error = lz4.decompress(&sound, &mut [0; 10]).unwrap_err();
        assert!(error.to_string().contains("longer than 1000"), "{error}");
    }
}
