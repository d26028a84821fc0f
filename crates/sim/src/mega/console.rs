//! What a USART has sent, for a person to read.

use std::collections::VecDeque;

/// Unread bytes kept.
const KEPT: usize = 1 << 16;

/// One USART's output.
#[derive(Clone, Debug, Default)]
pub(super) struct Console {
    bytes: VecDeque<u8>,
    spoken: bool,
}

impl Console {
    pub(super) fn push(&mut self, byte: u8) {
        if self.bytes.len() == KEPT {
            self.bytes.pop_front();
        }
        self.bytes.push_back(byte);
        self.spoken = true;
    }

    pub(super) fn take(&mut self) -> Vec<u8> {
        self.bytes.drain(..).collect()
    }

    /// Something has been sent.
    pub(super) fn has_spoken(&self) -> bool {
        self.spoken
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_console_nobody_reads_keeps_the_latest_bytes() {
        let mut console = Console::default();
        (0..KEPT + 3).for_each(|n| console.push(n as u8));
        let bytes = console.take();
        assert_eq!(
            (bytes.len(), bytes[0], console.has_spoken()),
            (KEPT, 3, true)
        );
        assert!(console.take().is_empty());
    }
}
