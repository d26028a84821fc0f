//! Little-endian fields, bounds-checked: a writer that fills a payload and a reader that must use it up.

use crate::frame::MAX_PAYLOAD;
use crate::malformed::Malformed;

/// Fills a payload from the front. What does not fit is dropped; the codec's tests show that everything fits.
#[derive(Default)]
pub(crate) struct Writer {
    bytes: [u8; MAX_PAYLOAD],
    len: usize,
}

impl Writer {
    /// Appends bytes.
    pub(crate) fn put<const N: usize>(&mut self, bytes: [u8; N]) -> &mut Self {
        if let Some(slots) = self
            .bytes
            .get_mut(self.len..)
            .and_then(|rest| rest.first_chunk_mut::<N>())
        {
            *slots = bytes;
            self.len += N;
        }
        self
    }

    /// What was written.
    pub(crate) fn payload(&self) -> &[u8] {
        self.bytes.get(..self.len).unwrap_or(&self.bytes)
    }
}

/// Reads a payload from the front. Missing bytes read as 0 and make the payload malformed.
pub(crate) struct Reader<'a> {
    rest: &'a [u8],
    short: bool,
}

impl<'a> Reader<'a> {
    pub(crate) fn new(payload: &'a [u8]) -> Self {
        Self {
            rest: payload,
            short: false,
        }
    }

    /// The next `N` bytes.
    pub(crate) fn take<const N: usize>(&mut self) -> [u8; N] {
        match self.rest.split_first_chunk::<N>() {
            Some((bytes, rest)) => {
                self.rest = rest;
                *bytes
            }
            None => {
                self.short = true;
                [0; N]
            }
        }
    }

    pub(crate) fn u8(&mut self) -> u8 {
        u8::from_le_bytes(self.take())
    }

    pub(crate) fn i16(&mut self) -> i16 {
        i16::from_le_bytes(self.take())
    }

    pub(crate) fn u16(&mut self) -> u16 {
        u16::from_le_bytes(self.take())
    }

    pub(crate) fn u32(&mut self) -> u32 {
        u32::from_le_bytes(self.take())
    }

    /// A float as it is, non-finite values included: the receiver's logic checks it.
    pub(crate) fn f32(&mut self) -> f32 {
        f32::from_le_bytes(self.take())
    }

    /// A read went past the end.
    pub(crate) fn is_short(&self) -> bool {
        self.short
    }

    /// The error when the last number has no meaning.
    pub(crate) fn wrong(&self) -> Malformed {
        if self.short {
            Malformed::Length
        } else {
            Malformed::Number
        }
    }

    /// Checks that nothing was missing and nothing is left over.
    pub(crate) fn finish(&self) -> Result<(), Malformed> {
        if self.rest.is_empty() && !self.short {
            Ok(())
        } else {
            Err(Malformed::Length)
        }
    }
}
