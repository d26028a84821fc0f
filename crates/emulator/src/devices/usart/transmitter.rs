//! The transmitter: a buffer of one character, and the shift register (2549Q, section 22.6).
//!
//! A character moves to an empty shift register at once, and its start bit begins with the next bit of the clock. What
//! follows it in the buffer joins on without a gap.

use super::format::Format;
use super::rate::Rate;

/// A frame in the shift register.
#[derive(Clone, Copy, Debug)]
struct Frame {
    data: u16,
    bits: u32,
    count: u32,
    /// The cycle in which its start bit begins.
    start: u64,
    /// Bits that have begun.
    begun: u32,
}

impl Frame {
    fn level(&self, bit: u32) -> bool {
        self.bits >> bit & 1 != 0
    }

    /// The next bit that differs from the present one, or the end.
    fn next_change(&self) -> u32 {
        match self.begun.checked_sub(1) {
            None => 0,
            Some(now) => (self.begun..self.count)
                .find(|bit| self.level(*bit) != self.level(now))
                .unwrap_or(self.count),
        }
    }
}

/// What the transmitter does at a cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Step {
    /// The line takes this level.
    Level(bool),
    /// A frame with these data is over.
    Sent(u16),
}

/// The transmitter.
#[derive(Clone, Debug)]
pub(super) struct Transmitter {
    /// A character waits for the shift register.
    buffer: Option<u16>,
    frame: Option<Frame>,
    /// TXC: the last frame is out, and nothing waits.
    pub(super) complete: bool,
    /// The level of the line.
    pub(super) level: bool,
}

impl Default for Transmitter {
    fn default() -> Transmitter {
        Transmitter {
            buffer: None,
            frame: None,
            complete: false,
            level: true,
        }
    }
}

impl Transmitter {
    /// UDRE: the buffer takes a character.
    pub(super) fn is_ready(&self) -> bool {
        self.buffer.is_none()
    }

    /// A frame is going out or waits for its bit.
    pub(super) fn is_busy(&self) -> bool {
        self.frame.is_some()
    }

    /// A character is written; one too many is ignored.
    pub(super) fn write(&mut self, data: u16, format: Format, rate: Rate, cycle: u64) {
        if self.buffer.is_none() {
            self.buffer = Some(format.mask(data));
            if self.frame.is_none() {
                self.load(format, rate.next_bit(cycle + 1));
            }
        }
    }

    fn load(&mut self, format: Format, start: u64) {
        self.frame = self.buffer.take().map(|data| {
            let (bits, count) = format.frame(data);
            Frame {
                data,
                bits,
                count,
                start,
                begun: 0,
            }
        });
    }

    /// The cycle of the next step.
    pub(super) fn next(&self, rate: Rate) -> Option<u64> {
        let frame = self.frame.as_ref()?;
        Some(frame.start + u64::from(frame.next_change()) * rate.bit())
    }

    /// Takes the step that is due at [`Transmitter::next`].
    pub(super) fn step(&mut self, format: Format, rate: Rate) -> Option<Step> {
        let frame = self.frame.as_mut()?;
        let bit = frame.next_change();
        if bit < frame.count {
            frame.begun = bit + 1;
            self.level = frame.level(bit);
            return Some(Step::Level(self.level));
        }
        let (data, end) = (frame.data, frame.start + u64::from(bit) * rate.bit());
        self.frame = None;
        self.complete |= self.buffer.is_none();
        self.load(format, end);
        Some(Step::Sent(data))
    }

    /// The cycle before which the frame does not begin, as long as it has not.
    pub(super) fn waits_until(&self) -> Option<u64> {
        self.frame
            .filter(|frame| frame.begun == 0)
            .map(|frame| frame.start)
    }

    /// A bit of the clock begins: the frame advances by one bit, or is over and the next one begins.
    pub(super) fn shift(&mut self, format: Format, cycle: u64) -> Option<Step> {
        let mut sent = None;
        if let Some(frame) = self.frame.filter(|frame| frame.begun == frame.count) {
            sent = Some(Step::Sent(frame.data));
            self.frame = None;
            self.complete |= self.buffer.is_none();
            self.load(format, cycle);
        }
        if let Some(frame) = &mut self.frame {
            self.level = frame.level(frame.begun);
            frame.begun += 1;
        }
        sent
    }

    /// Its clock stood for some cycles.
    pub(super) fn delay(&mut self, cycles: u64) {
        if let Some(frame) = &mut self.frame {
            frame.start += cycles;
        }
    }

    /// The rate changes at `cycle`: the bit that is going out lasts a whole one of the new kind from there.
    pub(super) fn change_rate(&mut self, from: Rate, to: Rate, cycle: u64) {
        if let Some(frame) = &mut self.frame {
            if cycle < frame.start {
                frame.start = to.next_bit(cycle + 1);
            } else {
                let whole = (cycle - frame.start) / from.bit();
                frame.start = cycle.saturating_sub(whole * to.bit());
                frame.begun = whole as u32 + 1;
            }
        }
    }
}
