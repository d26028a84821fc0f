//! LZ4, and Zstandard as other programs write it, without C, so that a browser reads the same logs by the same code.

use lz4_flex::frame::FrameDecoder;
use mcap::sans_io::decompressor::{DecompressResult, Decompressor};
use mcap::{McapError, McapResult};
use ruzstd::decoding::StreamingDecoder;
use std::io::{self, Read};

/// Input of the first attempt, doubled for each further one \[bytes\]: a whole chunk of ours.
const FIRST: usize = 64 << 10;

/// A way to compress.
struct Method {
    /// What chunks call it.
    name: &'static str,
    /// The length of the first frame; `None` while more has to come to know it. What is no frame is left to the decoder.
    frame_length: fn(&[u8]) -> Option<usize>,
    /// Decompresses a frame into bytes, at most so many.
    decompress: fn(&[u8], u64, &mut Vec<u8>) -> io::Result<usize>,
}

static LZ4: Method = Method {
    name: "lz4",
    frame_length: lz4_length,
    decompress: |frame, most, text| FrameDecoder::new(frame).take(most).read_to_end(text),
};

static ZSTD: Method = Method {
    name: "zstd",
    frame_length: zstd_length,
    decompress: |frame, most, text| {
        let decoder = StreamingDecoder::new(frame);
        let decoder = decoder.map_err(|error| io::Error::other(error.to_string()))?;
        decoder.take(most).read_to_end(text)
    },
};

/// Decompresses chunks, each frame as a whole.
pub(crate) struct Frames {
    method: &'static Method,
    /// A frame must not become longer \[bytes\].
    longest: usize,
    /// What is not decompressed yet.
    frame: Vec<u8>,
    /// What came of the last frame, and how much of that has been given.
    text: Vec<u8>,
    given: usize,
}

impl Frames {
    /// For frames of LZ4 of at most this many bytes.
    pub(crate) fn lz4(longest: usize) -> Self {
        Self::of(&LZ4, longest)
    }

    /// The same for Zstandard.
    pub(crate) fn zstd(longest: usize) -> Self {
        Self::of(&ZSTD, longest)
    }

    fn of(method: &'static Method, longest: usize) -> Self {
        Self {
            method,
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
        let length = (self.method.frame_length)(&self.frame);
        let Some(frame) = length.and_then(|end| self.frame.get(..end)) else {
            return Ok(());
        };
        let failed = |error: io::Error| McapError::DecompressionError(error.to_string());
        let most = self.longest as u64 + 1;
        let length = (self.method.decompress)(frame, most, &mut self.text).map_err(failed)?;
        if length > self.longest {
            let why = format!("a frame is longer than {} bytes", self.longest);
            return Err(McapError::DecompressionError(why));
        }
        self.frame.drain(..frame.len());
        Ok(())
    }
}

/// From the sizes of its blocks.
fn lz4_length(bytes: &[u8]) -> Option<usize> {
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

/// The same of Zstandard (RFC 8878, 3.1.1).
fn zstd_length(bytes: &[u8]) -> Option<usize> {
    const MAGIC: [u8; 4] = 0xfd2f_b528_u32.to_le_bytes();
    let (magic, rest) = bytes.split_first_chunk()?;
    if *magic != MAGIC {
        return Some(bytes.len());
    }
    let flags = *rest.first()?;
    let single = flags & 0x20 != 0;
    let window = usize::from(!single);
    let dictionary = [0, 1, 2, 4][usize::from(flags & 3)];
    let content = [usize::from(single), 2, 4, 8][usize::from(flags >> 6)];
    let mut at = MAGIC.len() + 1 + window + dictionary + content;
    loop {
        let head: &[u8; 3] = bytes.get(at..)?.first_chunk()?;
        let head = u32::from_le_bytes([head[0], head[1], head[2], 0]);
        let size = (head >> 3) as usize;
        // One byte, so many times.
        let repeated = head >> 1 & 3 == 1;
        at += 3 + if repeated { 1 } else { size };
        if head & 1 == 1 {
            return Some(at + if flags & 4 == 0 { 0 } else { 4 });
        }
    }
}

impl Decompressor for Frames {
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
        self.method.name
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
            let mut lz4 = Frames::lz4(200_000);
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
            let mut lz4 = Frames::lz4(text.len());
            let mut into = vec![0; text.len()];
            // An error, or more input is waited for, or other bytes: a chunk has a checksum.
            let _ = lz4.decompress(&damaged, &mut into);
            assert!(lz4.text.len() <= text.len() + 1);
        }
        let mut lz4 = Frames::lz4(1_000);
        let error = lz4.decompress(&sound, &mut [0; 10]).unwrap_err();
        assert!(error.to_string().contains("longer than 1000"), "{error}");
    }
}
