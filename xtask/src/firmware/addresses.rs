//! Gives debuggers the whole addresses of the image.
//!
//! LLVM writes the addresses of the AVR's debugging information in 16 bits, which reach neither code above 64 KB nor, for GDB, any
//! variable (0x800000 and up). The linker keeps its relocations (`firmware/build.rs`), and they know the whole address. Here the
//! information is read with them and written again with addresses of 32 bits, as avr-gcc has them; the relocations go.

use std::borrow::Cow;
use std::collections::HashMap;
use std::error::Error;

use gimli::write::{Address, AttributeValue, EndianVec, Sections};
use gimli::{EndianSlice, LittleEndian, Reader, ReaderOffsetId, Result as Read};
use object::build::elf::{Builder, SectionData};
use object::elf::{R_AVR_16, R_AVR_32};

type Slice<'a> = EndianSlice<'a, LittleEndian>;
/// Whole addresses by their place in a section, and how many bytes they have there.
type Addresses = HashMap<usize, (u64, usize)>;

/// Widens the addresses of an ELF file that still has its relocations.
pub(super) fn widen(elf: &[u8]) -> Result<Vec<u8>, String> {
    let mut image = Builder::read(elf).map_err(|error| format!("the linked image: {error}"))?;
    let widened = rewrite(&image).map_err(|error| format!("its debugging information: {error}"))?;
    for section in &mut image.sections {
        let name = section.name.to_string();
        let debugs = name.starts_with(".debug_");
        section.delete = debugs || matches!(section.data, SectionData::Relocation(_));
        if let Some(data) = widened.get(&*name) {
            section.delete = false;
            section.data = SectionData::Data(data.clone().into());
        }
    }
    image.set_section_sizes();
    let mut bytes = Vec::new();
    let written = image.write(&mut bytes);
    written.map_err(|error| format!("the image: {error}"))?;
    Ok(bytes)
}

/// The sections of the debugging information, by name.
fn rewrite(image: &Builder<'_>) -> Result<HashMap<&'static str, Vec<u8>>, Box<dyn Error>> {
    let addresses = addresses(image);
    let none = Addresses::new();
    let dwarf = gimli::Dwarf::load(|id| -> Read<_> {
        let section = image
            .sections
            .iter()
            .find(|it| *it.name == *id.name().as_bytes());
        let data: &[u8] = match section.map(|section| &section.data) {
            Some(SectionData::Data(data)) => data,
            _ => &[],
        };
        let section = EndianSlice::new(data, LittleEndian);
        Ok(Relocated {
            rest: section,
            section,
            addresses: addresses.get(id.name()).unwrap_or(&none),
        })
    })?;
    let mut dwarf = gimli::write::Dwarf::from(&dwarf, &|address| Some(Address::Constant(address)))?;
    size_pointers(&mut dwarf);
    let mut sections = Sections::new(EndianVec::new(LittleEndian));
    dwarf.write(&mut sections)?;
    let mut written = HashMap::new();
    sections.for_each(|id, data| -> gimli::write::Result<()> {
        written.insert(id.name(), data.slice().to_vec());
        Ok(())
    })?;
    Ok(written)
}

/// Pointers keep their two bytes: without a size they have that of an address.
fn size_pointers(dwarf: &mut gimli::write::Dwarf) {
    for (_, unit) in dwarf.units.iter_mut() {
        let mut waiting = vec![unit.root()];
        while let Some(id) = waiting.pop() {
            let entry = unit.get_mut(id);
            waiting.extend(entry.children());
            if entry.tag() == gimli::DW_TAG_pointer_type {
                entry.set(gimli::DW_AT_byte_size, AttributeValue::Udata(2));
            }
        }
    }
}

/// Whole addresses, by the name of the section that they are in.
fn addresses(image: &Builder<'_>) -> HashMap<String, Addresses> {
    let mut all = HashMap::new();
    for section in &image.sections {
        let (SectionData::Relocation(relocations), Some(of)) =
            (&section.data, section.sh_info_section)
        else {
            continue;
        };
        let place = relocations.iter().filter_map(|relocation| {
            let bytes = match relocation.r_type {
                R_AVR_16 => 2,
                R_AVR_32 => 4,
                _ => return None,
            };
            let symbol = image.symbols.get(relocation.symbol?);
            let address = symbol.st_value.wrapping_add_signed(relocation.r_addend);
            Some((relocation.r_offset as usize, (address, bytes)))
        });
        all.insert(image.sections.get(of).name.to_string(), place.collect());
    }
    all
}

/// A section whose addresses are relocated, and have 32 bits whatever they have in the file.
#[derive(Clone, Debug)]
struct Relocated<'a> {
    rest: Slice<'a>,
    section: Slice<'a>,
    addresses: &'a Addresses,
}

impl Reader for Relocated<'_> {
    type Endian = LittleEndian;
    type Offset = usize;

    fn read_address_size(&mut self) -> Read<u8> {
        self.rest.read_address_size().map(|_| 4)
    }

    fn read_address(&mut self, _: u8) -> Read<u64> {
        let place = self.rest.offset_from(self.section);
        if let Some((address, bytes)) = self.addresses.get(&place) {
            self.rest.skip(*bytes)?;
            return Ok(*address);
        }
        // Zero; or all ones, in front of the address that others are relative to.
        let small = self.rest.read_u16()?;
        Ok(if small == u16::MAX {
            u64::from(u32::MAX)
        } else {
            small.into()
        })
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
