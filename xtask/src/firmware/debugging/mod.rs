//! Corrects the image's debugging information for GDB.
//!
//! LLVM writes addresses of 16 bits, which reach neither code above 64 KB nor, for GDB, any variable (0x800000 and up).
//! The linker keeps its relocations (`firmware/build.rs`), and they hold the whole address. The information is read
//! with them ([`relocated`]) and written with addresses of 32 bits, as avr-gcc does, and with corrected locations
//! of variables ([`locations`]). None of it goes to the chip.

mod locations;
mod relocated;

use std::collections::HashMap;
use std::error::Error;

use gimli::write::{Address, AttributeValue, EndianVec, Expression, Sections};
use gimli::{Dwarf, LittleEndian, SectionId};
use object::build::elf::{Builder, Relocation, SectionData};
use object::elf::{R_AVR_16, R_AVR_32};
use relocated::{Relocated, Values};

/// Rewrites the debugging information of an ELF file that still has its relocations, and leaves them out.
pub(super) fn mend(elf: &[u8]) -> Result<Vec<u8>, String> {
    let mut image = Builder::read(elf).map_err(|error| format!("the linked image: {error}"))?;
    let written = rewrite(&image).map_err(|error| format!("its debugging information: {error}"))?;
    for section in &mut image.sections {
        let name = section.name.to_string();
        let debugs = name.starts_with(".debug_");
        section.delete = debugs || matches!(section.data, SectionData::Relocation(_));
        if let Some(data) = written.get(&*name) {
            section.delete = false;
            section.data = SectionData::Data(data.clone().into());
        }
    }
    image.set_section_sizes();
    let mut bytes = Vec::new();
    let done = image.write(&mut bytes);
    done.map_err(|error| format!("the image: {error}"))?;
    Ok(bytes)
}

/// The sections of the debugging information, by name.
fn rewrite(image: &Builder<'_>) -> Result<HashMap<&'static str, Vec<u8>>, Box<dyn Error>> {
    let lists = SectionId::DebugLoc.name();
    let mut values = HashMap::new();
    for (section, relocations) in relocations(image) {
        values.insert(section, values_of(image, relocations));
    }
    let none = Values::new();
    let old = |id: SectionId| -> gimli::Result<_> {
        let values = values.get(id.name()).unwrap_or(&none);
        Ok(Relocated::new(data(image, id.name()), values, 2))
    };
    let frames = locations::frames(&Dwarf::load(old)?)?;
    let places = locations::rewrite(&old(SectionId::DebugLoc)?, &frames)?;
    // References to a list follow it.
    for (section, relocations) in relocations(image) {
        for relocation in relocations {
            let symbol = relocation.symbol.map(|symbol| image.symbols.get(symbol));
            let target = symbol.and_then(|symbol| symbol.section);
            let value = values
                .get_mut(&section)
                .and_then(|it| it.get_mut(&(relocation.r_offset as usize)));
            if let (Some(target), Some((value, _))) = (target, value)
                && *image.sections.get(target).name == *lists.as_bytes()
            {
                *value = *places
                    .moved
                    .get(&(*value as usize))
                    .ok_or("a location list is not where an entry refers to")?
                    as u64;
            }
        }
    }
    let mended = Dwarf::load(|id: SectionId| -> gimli::Result<_> {
        if id == SectionId::DebugLoc {
            return Ok(Relocated::new(&places.bytes, &none, 4));
        }
        let values = values.get(id.name()).unwrap_or(&none);
        Ok(Relocated::new(data(image, id.name()), values, 2))
    })?;
    let mut dwarf =
        gimli::write::Dwarf::from(&mended, &|address| Some(Address::Constant(address)))?;
    mend_entries(&mut dwarf);
    let mut sections = Sections::new(EndianVec::new(LittleEndian));
    dwarf.write(&mut sections)?;
    let mut written = HashMap::new();
    sections.for_each(|id, data| -> gimli::write::Result<()> {
        written.insert(id.name(), data.slice().to_vec());
        Ok(())
    })?;
    Ok(written)
}

/// Pointers keep their two bytes: without a size they would have that of an address. Frames begin one byte higher.
fn mend_entries(dwarf: &mut gimli::write::Dwarf) {
    let frame_pointer = |build: fn(&mut Expression)| {
        let mut expression = Expression::new();
        build(&mut expression);
        AttributeValue::Exprloc(expression)
    };
    let wrong = frame_pointer(|it| it.op_reg(locations::Y));
    let right = frame_pointer(|it| it.op_breg(locations::Y, 1));
    for (_, unit) in dwarf.units.iter_mut() {
        let mut waiting = vec![unit.root()];
        while let Some(id) = waiting.pop() {
            let entry = unit.get_mut(id);
            waiting.extend(entry.children());
            if entry.tag() == gimli::DW_TAG_pointer_type {
                entry.set(gimli::DW_AT_byte_size, AttributeValue::Udata(2));
            }
            if entry.get(gimli::DW_AT_frame_base) == Some(&wrong) {
                entry.set(gimli::DW_AT_frame_base, right.clone());
            }
        }
    }
}

/// The bytes of a section; none where there is none.
fn data<'a>(image: &'a Builder<'_>, name: &str) -> &'a [u8] {
    let mut sections = image.sections.iter();
    let section = sections.find(|section| *section.name == *name.as_bytes());
    match section.map(|section| &section.data) {
        Some(SectionData::Data(data)) => data,
        _ => &[],
    }
}

/// Relocations, with the name of the section that they are in.
fn relocations<'a>(image: &'a Builder<'_>) -> impl Iterator<Item = (String, &'a [Relocation])> {
    image.sections.iter().filter_map(|section| {
        let of = image.sections.get(section.sh_info_section?);
        match &section.data {
            SectionData::Relocation(relocations) => Some((of.name.to_string(), &**relocations)),
            _ => None,
        }
    })
}

/// The values of relocations.
fn values_of(image: &Builder<'_>, relocations: &[Relocation]) -> Values {
    let values = relocations.iter().filter_map(|relocation| {
        let bytes = match relocation.r_type {
            R_AVR_16 => 2,
            R_AVR_32 => 4,
            _ => return None,
        };
        let symbol = image.symbols.get(relocation.symbol?);
        let value = symbol.st_value.wrapping_add_signed(relocation.r_addend);
        Some((relocation.r_offset as usize, (value, bytes)))
    });
    values.collect()
}
