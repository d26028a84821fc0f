//! Compresses chunks as LZ4 (<https://github.com/lz4/lz4/tree/dev/doc>): a frame of blocks, each on its own.
//!
//! A log repeats itself a few messages back. So it pays to search: for every place the earlier ones with the same four
//! bytes are chained, the nearest are compared, and a match gives way to a longer one that begins a byte later. That is
//! a fifth less than the quick search of `lz4_flex`, for which there is no other way in Rust.

/// Magic number; version 1, blocks independent, without checksums; blocks of 64 KB; checksum of these two bytes.
const HEAD: [u8; 7] = [0x04, 0x22, 0x4d, 0x18, 0x60, 0x40, 0x82];
/// Longest block before compression \[bytes\].
pub(crate) const BLOCK: usize = 64 << 10;
/// Says of a block's length that its bytes are as they were.
const AS_IT_IS: u32 = 1 << 31;

/// Shortest match, and what the format leaves without: no match begins in the last 12 bytes or covers the last 5.
const SHORTEST: usize = 4;
const NO_START: usize = 12;
const NO_MATCH: usize = 5;
/// Farthest match: its distance has 16 bits.
const FARTHEST: usize = u16::MAX as usize;
/// So many earlier places are compared.
const TRIED: usize = 24;
/// Bits of the number that four bytes are found by.
const HASH: u32 = 14;
/// No earlier place.
const NONE: u32 = u32::MAX;

/// A frame that holds these bytes.
pub(crate) fn lz4(bytes: &[u8]) -> Vec<u8> {
    let mut frame = HEAD.to_vec();
    for part in bytes.chunks(BLOCK) {
        let block = block(part);
        let (length, content) = match block.len() < part.len() {
            true => (block.len() as u32, &block[..]),
            false => (part.len() as u32 | AS_IT_IS, part),
        };
        frame.extend(length.to_le_bytes());
        frame.extend(content);
    }
    frame.extend([0; 4]);
    frame
}

/// Bytes that were there before.
#[derive(Clone, Copy, Default)]
struct Match {
    length: usize,
    distance: usize,
}

fn block(bytes: &[u8]) -> Vec<u8> {
    let mut block = Vec::with_capacity(bytes.len() / 4);
    let mut places = Places::new(bytes);
    let (mut at, mut written) = (0, 0);
    let end = bytes.len().saturating_sub(NO_START);
    while at < end {
        let mut found = places.longest(at);
        if found.length < SHORTEST {
            at += 1;
            continue;
        }
        while at + 1 < end {
            let next = places.longest(at + 1);
            if next.length <= found.length {
                break;
            }
            (at, found) = (at + 1, next);
        }
        put(&mut block, &bytes[written..at], Some(found));
        at += found.length;
        written = at;
    }
    put(&mut block, &bytes[written..], None);
    block
}

/// Where the same four bytes were before, for every place.
struct Places<'a> {
    bytes: &'a [u8],
    /// The last place of each hash, and of each place the one before it.
    last: Vec<u32>,
    before: Vec<u32>,
}

impl<'a> Places<'a> {
    fn new(bytes: &'a [u8]) -> Self {
        Self {
            bytes,
            last: vec![NONE; 1 << HASH],
            before: Vec::with_capacity(bytes.len()),
        }
    }

    /// The longest match at a place; places only grow.
    fn longest(&mut self, at: usize) -> Match {
        while self.before.len() <= at {
            let place = self.before.len();
            let earlier = match self.hash(place) {
                Some(hash) => std::mem::replace(&mut self.last[hash], place as u32),
                None => NONE,
            };
            self.before.push(earlier);
        }
        let ahead = &self.bytes[at..self.bytes.len().saturating_sub(NO_MATCH).max(at)];
        let (mut best, mut earlier) = (Match::default(), self.before[at]);
        for _ in 0..TRIED {
            let distance = at.wrapping_sub(earlier as usize);
            if earlier == NONE || distance > FARTHEST {
                break;
            }
            let there = &self.bytes[earlier as usize..];
            // What is no longer need not be measured.
            if there.get(best.length) == ahead.get(best.length) {
                let same = ahead
                    .iter()
                    .zip(there)
                    .take_while(|(one, other)| one == other);
                let length = same.count();
                if length > best.length {
                    best = Match { length, distance };
                }
            }
            earlier = self.before[earlier as usize];
        }
        best
    }

    fn hash(&self, at: usize) -> Option<usize> {
        let four = u32::from_le_bytes(*self.bytes.get(at..)?.first_chunk()?);
        // Knuth's multiplier, 2^32 over the golden ratio.
        Some((four.wrapping_mul(2_654_435_761) >> (32 - HASH)) as usize)
    }
}

/// Bytes as they are, and a match behind them; the last ones have none.
fn put(block: &mut Vec<u8>, literals: &[u8], found: Option<Match>) {
    let most = |length: usize| length.min(15) as u8;
    let more = found.map_or(0, |found| found.length - SHORTEST);
    block.push(most(literals.len()) << 4 | most(more));
    put_rest(block, literals.len());
    block.extend(literals);
    if let Some(found) = found {
        block.extend((found.distance as u16).to_le_bytes());
        put_rest(block, more);
    }
}

/// What of a length does not fit into four bits.
fn put_rest(block: &mut Vec<u8>, length: usize) {
    if let Some(rest) = length.checked_sub(15) {
        block.extend(std::iter::repeat_n(255, rest / 255));
        block.push((rest % 255) as u8);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lz4_flex::frame::{FrameDecoder, FrameEncoder};
    use std::io::{Read, Write};

    fn back(frame: &[u8]) -> Vec<u8> {
        let mut bytes = Vec::new();
        FrameDecoder::new(frame).read_to_end(&mut bytes).unwrap();
        bytes
    }

    /// Like telemetry: the same words, other digits.
    fn messages(count: u32) -> Vec<u8> {
        let messages = (0..count).map(|number| {
            let [left, right] = [7, 31].map(|by| f64::from(number * by % 1_000) / 100.0);
            format!("{{\"armed\":1.0,\"left_rad_s\":{left},\"mode\":7.0,\"right_rad_s\":{right},\"x_m\":0.0}}")
        });
        messages.collect::<String>().into_bytes()
    }

    #[test]
    fn what_is_compressed_comes_back() {
        let noise = |length: u32| {
            (0..length).map(|at| (at.wrapping_mul(at).wrapping_mul(2_654_435_761) >> 24) as u8)
        };
        for bytes in [
            Vec::new(),
            b"0".to_vec(),
            vec![7; 12],
            vec![7; 13],
            vec![7; 300_000],
            noise(1_000).collect(),
            noise(70_000).collect(),
            messages(5_000),
            [messages(2), noise(40).collect(), messages(3)].concat(),
        ] {
            for length in [bytes.len(), bytes.len() / 2, bytes.len() / 3] {
                let bytes = &bytes[..length];
                let frame = lz4(bytes);
                assert!(back(&frame) == bytes, "{length}");
                assert!(frame.len() <= bytes.len() + 20 * (1 + length / BLOCK));
            }
        }
    }

    #[test]
    fn messages_become_shorter_than_by_the_quick_search() {
        let bytes = messages(200);
        let mut quick = FrameEncoder::new(Vec::new());
        quick.write_all(&bytes).unwrap();
        let quick = quick.finish().unwrap().len();
        let searched = lz4(&bytes).len();
        assert!(searched * 10 < quick * 9, "{searched} {quick}");
    }
}
