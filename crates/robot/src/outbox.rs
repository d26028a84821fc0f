//! The transmit queue: a fixed ring that the HAL drains at line rate, one byte at a time.
//!
//! Nothing blocks here. What does not fit is dropped, and lower priorities need more free space: telemetry yields
//! first, so that acknowledgements, events and status still fit when the link is slow or silent.

/// Bytes in the ring: a text row (128) behind a few frames. An index of 8 bits wraps by itself.
const SIZE: usize = 256;
/// Space that telemetry leaves free for the rest: HELLO, status, two events and two acknowledgements take 86 bytes.
const TELEMETRY_RESERVE: usize = 96;
/// Space that the status leaves free for events and acknowledgements, two of each: 44 bytes.
const STATUS_RESERVE: usize = 48;

/// Priority of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Priority {
    /// Yields first: the next one is newer anyway.
    Telemetry,
    /// Yields next: it is repeated.
    Status,
    /// Uses all free space.
    Answer,
}

/// The ring.
#[derive(Clone, Debug)]
pub(crate) struct Outbox {
    bytes: [u8; SIZE],
    first: u8,
    len: usize,
}

impl Outbox {
    /// A ring that starts with 0x00, which ends a frame cut off by a reset, so that the first new frame is not lost
    /// with it.
    pub(crate) fn new() -> Self {
        Self {
            bytes: [0; SIZE],
            first: 0,
            len: 1,
        }
    }

    /// Queues all of `bytes`, or none; returns whether it did.
    pub(crate) fn push(&mut self, priority: Priority, bytes: &[u8]) -> bool {
        let reserve = match priority {
            Priority::Telemetry => TELEMETRY_RESERVE,
            Priority::Status => STATUS_RESERVE,
            Priority::Answer => 0,
        };
        if self.len + bytes.len() + reserve > SIZE {
            return false;
        }
        for byte in bytes {
            let last = self.first.wrapping_add(self.len as u8);
            if let Some(slot) = self.bytes.get_mut(usize::from(last)) {
                *slot = *byte;
                self.len += 1;
            }
        }
        true
    }

    /// The next byte for the link.
    #[inline(always)]
    pub(crate) fn pop(&mut self) -> Option<u8> {
        if self.len == 0 {
            return None;
        }
        let byte = self.bytes.get(usize::from(self.first)).copied();
        self.first = self.first.wrapping_add(1);
        self.len -= 1;
        byte
    }

    /// The ring is empty.
    pub(crate) fn is_empty(&self) -> bool {
        self.len == 0
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::vec::Vec;

    #[test]
    fn telemetry_gives_way_then_status_and_answers_still_fit() {
        let mut outbox = Outbox::new();
        outbox.pop();
        let mut fill = |priority, len| {
            (0..100)
                .filter(|_| outbox.push(priority, &[1; 64][..len]))
                .count()
        };
        assert_eq!(
            fill(Priority::Telemetry, 30),
            (SIZE - TELEMETRY_RESERVE) / 30
        );
        assert_eq!(fill(Priority::Status, 27), 2);
        assert!(fill(Priority::Answer, 13) >= 3);
        assert_eq!(fill(Priority::Telemetry, 1) + fill(Priority::Status, 1), 0);
    }

    #[test]
    fn bytes_leave_in_the_order_in_which_they_came_round_and_round() {
        let mut outbox = Outbox::new();
        outbox.pop();
        let mut sent = Vec::new();
        let mut left = Vec::new();
        for byte in 0..250u8 {
            let frame = [byte; 7];
            assert!(outbox.push(Priority::Answer, &frame));
            sent.extend(frame);
            left.extend(core::iter::from_fn(|| outbox.pop()).take(usize::from(byte % 9)));
            while outbox.len > SIZE - 7 {
                left.extend(outbox.pop());
            }
        }
        left.extend(core::iter::from_fn(|| outbox.pop()));
        assert_eq!(left, sent);
        assert!(outbox.is_empty());
    }
}
