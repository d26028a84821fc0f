//! A serial line on any pins, bit by bit: what the Bluetooth module hears on the chip's pin, and what it says on the other.

use super::CYCLES_PER_US;

/// Bits of a frame: start, eight of data, stop.
const FRAME: u32 = 10;

/// A pulse shorter than this is none of this rate [bits].
const SHORTEST: f64 = 0.7;

/// Length of a bit [cycles].
fn bit_cycles(baud: u32) -> f64 {
    1e6 * CYCLES_PER_US as f64 / f64::from(baud.max(1))
}

/// The levels of a frame that begins at a cycle, each with its own.
pub(super) fn frame(begin: u64, byte: u8, baud: u32) -> impl Iterator<Item = (u64, bool)> {
    (0..FRAME).map(move |bit| {
        let cycle = begin + (f64::from(bit) * bit_cycles(baud)).round() as u64;
        let level = match bit {
            0 => false,
            1..=8 => byte >> (bit - 1) & 1 != 0,
            _ => true,
        };
        (cycle, level)
    })
}

/// A receiver that samples a line in the middle of its own bits, whatever the sender's rate is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Receiver {
    baud: u32,
    high: bool,
    /// A stop bit was low, or a pulse too short to be a bit.
    misframed: bool,
    edge: u64,
    /// Where the start bit began, what has been sampled since, and how many bits of it.
    frame: Option<(u64, u8, u32)>,
}

impl Receiver {
    /// On a line that idles.
    pub(super) fn new(baud: u32) -> Self {
        Self {
            baud,
            high: true,
            misframed: false,
            edge: 0,
            frame: None,
        }
    }

    /// Samples the line up to a cycle; a byte whose stop bit has been sampled, and when.
    pub(super) fn pass(&mut self, cycle: u64) -> Option<(u64, u8)> {
        while let Some((begin, byte, bits)) = self.frame {
            let at = begin + ((f64::from(bits) + 0.5) * bit_cycles(self.baud)) as u64;
            if at > cycle {
                return None;
            }
            let sample = u8::from(self.high);
            self.frame = match bits {
                // The start bit was a spike.
                0 if self.high => None,
                0 => Some((begin, 0, 1)),
                1..=8 => Some((begin, byte | sample << (bits - 1), bits + 1)),
                _ => None,
            };
            if bits == FRAME - 1 {
                self.misframed |= !self.high;
                return Some((at, byte));
            }
        }
        None
    }

    /// Whether its sender has another rate.
    pub(super) fn misframed(&self) -> bool {
        self.misframed
    }

    /// The line's level from this cycle on, after [`Receiver::pass`].
    pub(super) fn set(&mut self, cycle: u64, high: bool) {
        if high == self.high {
            return;
        }
        let short = (cycle.saturating_sub(self.edge) as f64) < SHORTEST * bit_cycles(self.baud);
        self.misframed |= short && self.frame.is_some();
        self.edge = cycle;
        if !high && self.frame.is_none() {
            self.frame = Some((cycle, 0, 0));
        }
        self.high = high;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn received(sent: &[u8], baud: u32, own_baud: u32) -> Vec<u8> {
        let mut receiver = Receiver::new(own_baud);
        let mut received = Vec::new();
        let mut begin = 1_000;
        for byte in sent {
            for (cycle, level) in frame(begin, *byte, baud) {
                received.extend(receiver.pass(cycle));
                receiver.set(cycle, level);
            }
            begin += (10.0 * bit_cycles(baud)).ceil() as u64;
        }
        received.extend(receiver.pass(begin + 1_000_000));
        received.into_iter().map(|(_, byte)| byte).collect()
    }

    #[test]
    fn what_is_sent_at_the_receiver_s_rate_arrives_and_at_another_it_is_garbage() {
        assert_eq!(received(b"Forward", 9_600, 9_600), b"Forward");
        assert_eq!(received(b"Forward", 9_800, 9_600), b"Forward");
        assert_eq!(received(b"Forward", 115_200, 115_200), b"Forward");
        let garbage = received(b"Forward", 19_200, 9_600);
        assert_ne!(garbage, b"Forward");
    }
}
