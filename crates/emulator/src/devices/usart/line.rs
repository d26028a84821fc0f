//! The sender at the other end of a serial line: frames that come in, as levels of the RXD pin. Its times are those of the crystal's cycles.

use std::collections::VecDeque;

/// A cycle in units of 2^-16, so that bits of any rate keep their place over a whole run of frames.
const UNIT: u64 = 1 << 16;

/// A frame to come.
#[derive(Clone, Copy, Debug)]
struct Frame {
    /// Levels, start bit first.
    bits: u32,
    count: u32,
    /// Units of a bit.
    bit: u64,
}

/// Frames in a row.
#[derive(Clone, Debug, Default)]
pub(super) struct Line {
    frames: VecDeque<Frame>,
    /// When the first of them begins, or the last one ended [units].
    start: u64,
    /// Its bits that have begun.
    begun: u32,
}

impl Line {
    /// A frame whose start bit begins at `time`, or when those before it are over: `count` levels after the start bit.
    pub(super) fn send(&mut self, bits: u16, count: u8, baud: u32, time: u64) {
        let count = u32::from(count.min(16));
        let bits = (u32::from(bits) & ((1 << count) - 1)) << 1;
        let bit = (super::CLOCK_HZ * UNIT).div_ceil(u64::from(baud.max(1)));
        if self.frames.is_empty() {
            self.start = self.start.max(time * UNIT);
        }
        self.frames.push_back(Frame {
            bits,
            count: count + 1,
            bit,
        });
    }

    /// The next bit of the first frame with another level, or its end.
    fn next_change(&self, frame: &Frame) -> u32 {
        let Some(now) = self.begun.checked_sub(1) else {
            return 0;
        };
        let level = frame.bits >> now & 1;
        (self.begun..frame.count)
            .find(|bit| frame.bits >> bit & 1 != level)
            .unwrap_or(frame.count)
    }

    /// The time of the next change.
    pub(super) fn next(&self) -> Option<u64> {
        let frame = self.frames.front()?;
        let at = self.start + u64::from(self.next_change(frame)) * frame.bit;
        Some(at / UNIT)
    }

    /// The level after the change that is due; the line idles high.
    pub(super) fn step(&mut self) -> bool {
        let Some(frame) = self.frames.front() else {
            return true;
        };
        let bit = self.next_change(frame);
        if bit < frame.count {
            self.begun = bit + 1;
            return frame.bits >> bit & 1 != 0;
        }
        self.start += u64::from(bit) * frame.bit;
        self.begun = 0;
        self.frames.pop_front();
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_keep_their_rate_and_follow_each_other() {
        let mut line = Line::default();
        line.send(0x155, 9, 9_600, 1_000);
        line.send(0x100, 9, 9_600, 1_000);
        let mut edges = Vec::new();
        while let Some(cycle) = line.next() {
            edges.push((cycle, line.step()));
        }
        let at = |bits: u64| 1_000 + bits * 16_000_000 / 9_600;
        // 0x55 and its stop bit alternate; the second frame is low up to its stop bit.
        let first: Vec<_> = (0..10).map(|bit| (at(bit), bit % 2 == 1)).collect();
        assert_eq!(edges[..10], first);
        let rest = [
            (at(10), true),
            (at(10), false),
            (at(19), true),
            (at(20), true),
        ];
        assert_eq!(edges[10..], rest);
    }
}
