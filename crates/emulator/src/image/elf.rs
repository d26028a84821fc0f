//! ELF files as avr-gcc and rustc make them.
//!
//! They put memories side by side in one space: flash from 0, data at 0x800000, EEPROM at 0x810000, fuses, lock bits and
//! signature beyond. Loading goes by the program headers' physical addresses: where initial data lie in flash.

use super::{Image, ImageError, Symbol, largest, start};
use crate::model::MODELS;
use object::read::elf::{FileHeader, ProgramHeader};
use object::{Endianness, Object, ObjectSection, ObjectSymbol, SymbolKind, elf};
use std::cmp::Reverse;

/// Where the toolchain puts data.
const DATA_SPACE: u64 = 0x80_0000;
/// Where it puts EEPROM contents.
const EEPROM_SPACE: u64 = 0x81_0000;
/// What lies beyond is no memory to load: fuses, lock bits, signature.
const FUSE_SPACE: u64 = 0x82_0000;
/// Bits of the header's flags that hold the number of the architecture.
const ARCHITECTURE: u32 = 0x7F;

/// The bytes are those of an ELF file.
pub(super) fn is_elf(bytes: &[u8]) -> bool {
    bytes.starts_with(&elf::ELFMAG)
}

/// Reads an ELF file.
pub(super) fn read(bytes: &[u8]) -> Result<Image, ImageError> {
    let broken = |error: object::Error| ImageError::Elf(error.to_string());
    // Not every file is 32 bits wide, but every AVR's is.
    let header = match elf::FileHeader32::<Endianness>::parse(bytes) {
        Ok(header) => header,
        Err(_) => {
            let other = elf::FileHeader64::<Endianness>::parse(bytes).map_err(broken)?;
            let endian = other.endian().map_err(broken)?;
            return Err(ImageError::Processor(other.e_machine(endian)));
        }
    };
    let endian = header.endian().map_err(broken)?;
    if header.e_machine(endian) != elf::EM_AVR {
        return Err(ImageError::Processor(header.e_machine(endian)));
    }
    let architecture = header.e_flags(endian) & ARCHITECTURE;
    let mut models = MODELS.into_iter();
    let Some(model) = models.find(|model| model.architecture == architecture) else {
        return Err(ImageError::Chip(architecture));
    };
    if header.e_type(endian) == elf::ET_REL {
        return Err(ImageError::Object);
    }
    let file = object::File::parse(bytes).map_err(broken)?;
    if let Some(name) = device(&file).filter(|name| name != model.name) {
        return Err(ImageError::Device(name));
    }
    let mut image = Image {
        model: Some(model),
        ..Image::default()
    };
    let mut filled = Vec::new();
    for segment in header.program_headers(endian, bytes).map_err(broken)? {
        if segment.p_type(endian) != elf::PT_LOAD || segment.p_filesz(endian) == 0 {
            continue;
        }
        let data = segment
            .data(endian, bytes)
            .map_err(|()| ImageError::Elf("a segment lies beyond the end of the file".into()))?;
        let at = u64::from(segment.p_paddr(endian));
        match at {
            0..DATA_SPACE => image.put(&mut filled, at, data)?,
            EEPROM_SPACE..FUSE_SPACE => put_eeprom(&mut image, at - EEPROM_SPACE, data)?,
            _ => {}
        }
    }
    read_symbols(&mut image, &file)?;
    start::model(&image)?;
    Ok(image)
}

fn put_eeprom(image: &mut Image, at: u64, data: &[u8]) -> Result<(), ImageError> {
    let end = at + data.len() as u64;
    let size = largest(|model| model.eeprom_bytes);
    if end > size as u64 {
        return Err(ImageError::TooLarge {
            memory: "EEPROM",
            end,
            size,
        });
    }
    let (start, end) = (at as usize, end as usize);
    if image.eeprom.len() < end {
        image.eeprom.resize(end, 0xFF);
    }
    image.eeprom[start..end].copy_from_slice(data);
    Ok(())
}

/// The chip's name in the note that avr-gcc puts into a program: sizes of the memories, then strings.
fn device(file: &object::File) -> Option<String> {
    let section = file.section_by_name(".note.gnu.avr.deviceinfo")?;
    let data = section.data().ok()?;
    let names = data.split(|byte| !byte.is_ascii_graphic());
    let mut names = names.filter_map(|name| str::from_utf8(name).ok());
    let name = names.find(|name| name.starts_with("at") || name.starts_with("avr"))?;
    Some(name.to_owned())
}

fn read_symbols(image: &mut Image, file: &object::File) -> Result<(), ImageError> {
    for symbol in file.symbols() {
        let Ok(name) = symbol.name() else { continue };
        let (address, size) = (symbol.address(), symbol.size());
        let in_data = u16::try_from(address.wrapping_sub(DATA_SPACE)).ok();
        if matches!(name, "_end" | "__heap_start") {
            image.data_end = in_data.filter(|end| *end >= image.model().sram_start);
        }
        // A routine in assembly, as those of libgcc, has no type, but a size.
        let code = match symbol.kind() {
            SymbolKind::Text => true,
            SymbolKind::Unknown => size > 0,
            _ => false,
        };
        match in_data {
            _ if name.is_empty() => {}
            Some(place) if symbol.kind() == SymbolKind::Data => image.variables.push(Symbol {
                address: place.into(),
                size: size as u32,
                name: demangled(name),
            }),
            _ if code && address < image.model().flash_bytes() as u64 => {
                image.functions.push(Symbol {
                    address: (address / 2) as u32,
                    size: size.div_ceil(2) as u32,
                    name: demangled(name),
                })
            }
            _ => {}
        }
    }
    // Of several names for one place the last one counts: one with a size, which is a function's own.
    let by_place = |symbol: &Symbol| {
        (
            symbol.address,
            symbol.size != 0,
            Reverse(symbol.name.clone()),
        )
    };
    image.functions.sort_by_key(by_place);
    image.variables.sort();
    Ok(())
}

/// The name as in the source.
fn demangled(name: &str) -> String {
    if let Ok(rust) = rustc_demangle::try_demangle(name) {
        return format!("{rust:#}");
    }
    let cpp = cpp_demangle::Symbol::new(name).ok();
    cpp.and_then(|symbol| symbol.demangle().ok())
        .unwrap_or_else(|| name.to_owned())
}
