//! Bytes that wait for the link: a fixed ring that the HAL empties at line rate, one byte at a time.
//!
//! Nothing ever waits here. What does not fit is not sent, and what matters less needs more room: telemetry gives
//! way first, so that acknowledgements, events and status still find a place when the link is slow or silent.

/// Bytes in the ring: a text row (128) behind a few frames. An index of 8 bits wraps by itself.
const SIZE: usize = 256;
/// Room that telemetry leaves to all the rest: HELLO, status, two events and two acknowledgements take 86 bytes.
const TELEMETRY_RESERVE: usize = 96;
/// Room that the status leaves to events and acknowledgements, two of each: 44 bytes.
const STATUS_RESERVE: usize = 48;

/// How important something is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Priority {
    /// Gives way first: the next one is newer anyway.
    Telemetry,
    /// Gives way next: it is repeated.
    Status,
    /// Takes any room there is.
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
    /// With a 0x00 in it, which ends the frame that a reset may have cut off: the first one must not go down with it.
    pub(crate) fn new() -> Self {
        Self {
            bytes: [0; SIZE],
            first: 0,
            len: 1,
        }
    }

    /// Queues all of `bytes` or none; whether it did.
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

    /// Nothing waits.
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
