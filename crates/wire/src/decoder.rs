//! Finds binary frames and lines of text in a stream of bytes, whichever they are.
//!
//! Bytes since the last 0x00 collect in a fixed buffer. At a 0x00 they are tried as a frame: all of them, and, if text
//! lines came before, those after the last line. At a LF the bytes since the last LF are a line, if all of
//! them are printable ASCII. Garbage is neither. A LF inside a frame does not end the frame; should the bytes before
//! it happen to be printable they also come out as a line, which then fails to parse and is ignored.

use crate::frame::FrameBody;

/// What came in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Received<'a> {
    /// A frame that passed the CRC.
    Frame(FrameBody),
    /// A line of printable ASCII, without its end. As bytes: to make text of them takes 700 bytes of the chip's flash.
    Line(&'a [u8]),
}

/// The receiver of one direction, with room for lines of `N` bytes; `N` must be at least
/// [`crate::frame::MAX_FRAME`] for frames to fit.
#[derive(Clone, Debug)]
pub struct Decoder<const N: usize> {
    buffer: [u8; N],
    len: usize,
    /// Where the bytes after the last line of text start, if there was one since the last 0x00.
    after_text: Option<usize>,
    /// Where bytes after the last LF start.
    line_start: usize,
    /// Bytes since the last 0x00 were dropped for lack of space: no frame can be complete.
    frame_cut: bool,
    /// The same for the line.
    line_cut: bool,
    expected_seq: Option<u8>,
    crc_errors: u16,
    frames_lost: u16,
}

impl<const N: usize> Default for Decoder<N> {
    fn default() -> Self {
        Self {
            buffer: [0; N],
            len: 0,
            after_text: None,
            line_start: 0,
            frame_cut: false,
            line_cut: false,
            expected_seq: None,
            crc_errors: 0,
            frames_lost: 0,
        }
    }
}

impl<const N: usize> Decoder<N> {
    /// Ingests one byte; returns what it completes.
    pub fn push(&mut self, byte: u8) -> Option<Received<'_>> {
        match byte {
            0 => self.end_frame().map(Received::Frame),
            b'\n' => {
                let range = self.end_line()?;
                self.buffer.get(range).map(Received::Line)
            }
            _ => {
                self.store(byte);
                None
            }
        }
    }

    /// Pieces between two 0x00 that were no valid frame: noise, cuts, another protocol version. Wraps.
    pub fn crc_errors(&self) -> u16 {
        self.crc_errors
    }

    /// Frames missing according to their sequence numbers (modulo 16: a gap of 16 goes unseen). Wraps.
    pub fn frames_lost(&self) -> u16 {
        self.frames_lost
    }

    fn store(&mut self, byte: u8) {
        if self.len >= N {
            self.make_room();
        }
        match self.buffer.get_mut(self.len) {
            Some(slot) => {
                *slot = byte;
                self.len += 1;
            }
            None => self.line_cut = true,
        }
    }

    /// Drops the oldest bytes of a full buffer: finished lines, then the start of a frame too long to be valid.
    #[cfg_attr(not(target_arch = "avr"), inline(never))]
    fn make_room(&mut self) {
        self.frame_cut = true;
        let keep_from = match self.after_text {
            Some(start) if start > 0 => {
                self.after_text = Some(0);
                start
            }
            _ => {
                self.after_text = None;
                self.line_start
            }
        };
        self.buffer.copy_within(keep_from..N, 0);
        self.len = N - keep_from;
        self.line_start -= keep_from;
    }

    // Most bytes end nothing, and are not to save the registers that this and its like need.
    #[cfg_attr(not(target_arch = "avr"), inline(never))]
    fn end_frame(&mut self) -> Option<FrameBody> {
        let pending = self.buffer.get(..self.len).unwrap_or(&[]);
        let after_text = self.after_text.and_then(|start| pending.get(start..));
        let whole = if self.frame_cut {
            None
        } else {
            FrameBody::parse(pending)
        };
        let body = whole.or_else(|| FrameBody::parse(after_text?));
        let noise = match after_text {
            Some(rest) => !rest.is_empty(),
            None => self.frame_cut || !pending.is_empty(),
        };
        self.len = 0;
        self.after_text = None;
        self.line_start = 0;
        self.frame_cut = false;
        self.line_cut = false;
        match &body {
            Some(body) => {
                let gap = self
                    .expected_seq
                    .map_or(0, |expected| body.seq.wrapping_sub(expected) & 0xF);
                self.frames_lost = self.frames_lost.wrapping_add(u16::from(gap));
                self.expected_seq = Some(body.seq.wrapping_add(1) & 0xF);
            }
            None if noise => self.crc_errors = self.crc_errors.wrapping_add(1),
            None => {}
        }
        body
    }

    /// Where the line that ends here lies in the buffer, if it is one.
    #[cfg_attr(not(target_arch = "avr"), inline(never))]
    fn end_line(&mut self) -> Option<core::ops::Range<usize>> {
        let cut = self.line_cut;
        let line = self.buffer.get(self.line_start..self.len).unwrap_or(&[]);
        let line = line.strip_suffix(b"\r").unwrap_or(line);
        let len = line.len();
        let printable = len > 0 && line.iter().all(|byte| matches!(byte, b' '..=b'~'));
        // Kept for the frame it may be part of; making room for it may move the line.
        self.store(b'\n');
        let start = self.line_start;
        self.line_start = self.len;
        self.line_cut = false;
        if cut || !printable {
            return None;
        }
        // A frame starts with a COBS code below 32, so the bytes up to its first LF are never printable: a line
        // that follows something unprintable after text may lie inside a frame.
        if self.after_text.is_none_or(|end| end == start) {
            self.after_text = Some(self.len);
        }
        Some(start..start + len)
    }
}
