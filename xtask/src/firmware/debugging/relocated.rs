//! Sections of the debugging information, read with the relocations that the linker has kept.

use std::borrow::Cow;
use std::collections::HashMap;

use gimli::{EndianSlice, Format, LittleEndian, Reader, ReaderOffsetId, Result as Read};

type Slice<'a> = EndianSlice<'a, LittleEndian>;
/// Value and size of a relocation, by its offset in a section.
pub(super) type Values = HashMap<usize, (u64, usize)>;

/// A section whose addresses are relocated, and have 32 bits whatever they have in the file.
#[derive(Clone, Debug)]
pub(super) struct Relocated<'a> {
    rest: Slice<'a>,
    section: Slice<'a>,
    values: &'a Values,
    /// Bytes of an address that is not relocated.
    width: u8,
}

impl<'a> Relocated<'a> {
    pub(super) fn new(section: &'a [u8], values: &'a Values, width: u8) -> Self {
        let section = EndianSlice::new(section, LittleEndian);
        Self {
            rest: section,
            section,
            values,
            width,
        }
    }
}

impl Reader for Relocated<'_> {
    type Endian = LittleEndian;
    type Offset = usize;

    fn read_address_size(&mut self) -> Read<u8> {
        self.rest.read_address_size().map(|_| 4)
    }

    fn read_address(&mut self, _: u8) -> Read<u64> {
        let place = self.rest.offset_from(self.section);
        if let Some((address, bytes)) = self.values.get(&place) {
            self.rest.skip(*bytes)?;
            return Ok(*address);
        }
        let address = self.rest.read_address(self.width)?;
        // All ones stand in front of the address that others are relative to.
        let is_ones = self.width == 2 && address == u64::from(u16::MAX);
        Ok(if is_ones { u32::MAX.into() } else { address })
    }

    fn read_offset(&mut self, format: Format) -> Read<usize> {
        let place = self.rest.offset_from(self.section);
        let offset = self.rest.read_offset(format)?;
        let value = self.values.get(&place);
        Ok(value.map_or(offset, |(value, _)| *value as usize))
    }

    fn split(&mut self, len: usize) -> Read<Self> {
        let rest = self.rest.split(len)?;
        Ok(Self {
            rest,
            ..self.clone()
        })
    }

    fn offset_from(&self, base: &Self) -> usize {
        self.rest.offset_from(base.rest)
    }

    fn endian(&self) -> LittleEndian {
        LittleEndian
    }

    fn len(&self) -> usize {
        self.rest.len()
    }

    fn empty(&mut self) {
        self.rest.empty();
    }

    fn truncate(&mut self, len: usize) -> Read<()> {
        self.rest.truncate(len)
    }

    fn offset_id(&self) -> ReaderOffsetId {
        self.rest.offset_id()
    }

    fn lookup_offset_id(&self, id: ReaderOffsetId) -> Option<usize> {
        self.rest.lookup_offset_id(id)
    }

    fn find(&self, byte: u8) -> Read<usize> {
        Reader::find(&self.rest, byte)
    }

    fn skip(&mut self, len: usize) -> Read<()> {
        self.rest.skip(len)
    }

    fn to_slice(&self) -> Read<Cow<'_, [u8]>> {
        self.rest.to_slice()
    }

    fn to_string(&self) -> Read<Cow<'_, str>> {
        Reader::to_string(&self.rest)
    }

    fn to_string_lossy(&self) -> Read<Cow<'_, str>> {
        Reader::to_string_lossy(&self.rest)
    }

    fn read_slice(&mut self, buffer: &mut [u8]) -> Read<()> {
        self.rest.read_slice(buffer)
    }
}
