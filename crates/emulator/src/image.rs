//! Program images: ELF with symbols and EEPROM contents, or Intel HEX.
//!
//! The toolchain's ELF files put memories side by side in one space: flash from 0, data at 0x800000, EEPROM at 0x810000,
//! fuses, lock bits and signature beyond. Loading goes by the program headers' physical addresses: where initial data lie in flash.

use crate::cpu::{FLASH_BYTES, SRAM_START};
use object::read::elf::{FileHeader, ProgramHeader};
use object::{Endianness, Object, ObjectSymbol, SymbolKind, elf};
use std::fmt;

/// Bytes of EEPROM.
pub const EEPROM_BYTES: usize = 0x1000;
/// Where the toolchain puts data.
const DATA_SPACE: u64 = 0x80_0000;
/// Where it puts EEPROM contents.
const EEPROM_SPACE: u64 = 0x81_0000;
/// What lies beyond is no memory to load: fuses, lock bits, signature.
const FUSE_SPACE: u64 = 0x82_0000;
/// Architecture number of chips with a 22-bit program counter in the ELF header's flags.
const AVR6: u32 = 6;
/// Bits of the flags that hold it.
const ARCHITECTURE: u32 = 0x7F;

/// A program for the chip.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Image {
    flash: Vec<u8>,
    eeprom: Vec<u8>,
    /// Functions by address [words], ascending.
    functions: Vec<(u32, String)>,
    /// Variables by address in the data space, ascending.
    variables: Vec<(u16, String)>,
    data_end: Option<u16>,
}

/// Why a file is no program for this chip.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ImageError {
    /// Neither ELF nor Intel HEX.
    Unknown,
    /// An ELF file that cannot be read, or is cut off.
    Elf(String),
    /// An ELF file for another processor.
    Processor(u16),
    /// An AVR program, but for a chip of another architecture.
    Chip(u32),
    /// A line of a HEX file is wrong.
    Hex {
        /// Its number, from 1.
        line: usize,
        /// What is wrong.
        what: String,
    },
    /// A HEX file without its end record.
    Truncated,
    /// Two parts of the file want the same byte.
    Overlap(usize),
    /// Something lies beyond the end of a memory.
    TooLarge {
        /// Which memory.
        memory: &'static str,
        /// First byte after the end of what should go there.
        end: u64,
        /// Its size.
        size: usize,
    },
    /// There is nothing in it.
    Empty,
}

impl fmt::Display for ImageError {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        match self {
            ImageError::Unknown => write!(
                out,
                "neither an ELF file nor Intel HEX; give the .elf or .hex that the compiler made"
            ),
            ImageError::Elf(what) => {
                write!(out, "the ELF file cannot be read ({what}); build it again")
            }
            ImageError::Processor(machine) => write!(
                out,
                "an ELF file for another processor (machine {machine}, an AVR is {}); build for the ATmega2560",
                elf::EM_AVR
            ),
            ImageError::Chip(architecture) => write!(
                out,
                "an AVR program for another chip (architecture avr{architecture}, the ATmega2560 is avr{AVR6}); build with -mmcu=atmega2560"
            ),
            ImageError::Hex { line, what } => {
                write!(out, "line {line} of the HEX file is wrong: {what}")
            }
            ImageError::Truncated => write!(
                out,
                "the HEX file ends without its end record: it is cut off; copy it again"
            ),
            ImageError::Overlap(address) => write!(
                out,
                "two parts of the file want flash address 0x{address:05x}; link it again"
            ),
            ImageError::TooLarge { memory, end, size } => write!(
                out,
                "too large: {memory} ends at 0x{size:x}, the program at 0x{end:x}"
            ),
            ImageError::Empty => write!(out, "there is no program in it"),
        }
    }
}

impl std::error::Error for ImageError {}

impl Image {
    /// Reads an ELF file or Intel HEX, whichever `bytes` are.
    ///
    /// # Errors
    /// Why they are no program for this chip.
    pub fn parse(bytes: &[u8]) -> Result<Image, ImageError> {
        let image = if bytes.starts_with(&elf::ELFMAG) {
            read_elf(bytes)
        } else if let Some(text) = hex_text(bytes) {
            read_hex(text)
        } else {
            Err(ImageError::Unknown)
        }?;
        if image.flash.is_empty() {
            return Err(ImageError::Empty);
        }
        Ok(image)
    }

    /// The flash from address 0 to the end of the program.
    pub fn flash(&self) -> &[u8] {
        &self.flash
    }

    /// What the image wants in the EEPROM, from address 0.
    pub fn eeprom(&self) -> &[u8] {
        &self.eeprom
    }

    /// The end of the program's static data, below which the stack must not grow; known from an ELF file only.
    pub fn data_end(&self) -> Option<u16> {
        self.data_end
    }

    /// Functions by address [words], ascending.
    pub fn functions(&self) -> &[(u32, String)] {
        &self.functions
    }

    /// Variables by address in the data space, ascending.
    pub fn variables(&self) -> &[(u16, String)] {
        &self.variables
    }

    /// The function that an instruction [words] is in, if the image has symbols.
    pub fn function(&self, word: u32) -> Option<&str> {
        let after = self.functions.partition_point(|(start, _)| *start <= word);
        let (_, name) = self.functions.get(after.checked_sub(1)?)?;
        Some(name)
    }

    /// An instruction's place for people: the byte address that listings show, and the function.
    pub fn place(&self, word: u32) -> String {
        match self.function(word) {
            Some(name) => format!("0x{:05x} in {name}", 2 * word),
            None => format!("0x{:05x}", 2 * word),
        }
    }

    /// Puts a part of the program into flash.
    fn put(&mut self, filled: &mut Vec<bool>, at: u64, bytes: &[u8]) -> Result<(), ImageError> {
        let end = at.saturating_add(bytes.len() as u64);
        if end > FLASH_BYTES as u64 {
            return Err(ImageError::TooLarge {
                memory: "flash",
                end,
                size: FLASH_BYTES,
            });
        }
        let (start, end) = (at as usize, end as usize);
        if self.flash.len() < end {
            self.flash.resize(end, 0xFF);
            filled.resize(end, false);
        }
        if let Some(taken) = filled[start..end].iter().position(|taken| *taken) {
            return Err(ImageError::Overlap(start + taken));
        }
        filled[start..end].fill(true);
        self.flash[start..end].copy_from_slice(bytes);
        Ok(())
    }
}

/// The text, if the first mark in it is that of a HEX record.
fn hex_text(bytes: &[u8]) -> Option<&str> {
    let text = str::from_utf8(bytes).ok()?;
    text.trim_start().starts_with(':').then_some(text)
}

fn read_hex(text: &str) -> Result<Image, ImageError> {
    use ihex::Record;
    let mut image = Image::default();
    let (mut filled, mut base, mut ended) = (Vec::new(), 0u64, false);
    for (index, line) in text.lines().enumerate() {
        let line = line.trim();
        if line.is_empty() {
            continue;
        }
        let wrong = |what: String| ImageError::Hex {
            line: index + 1,
            what,
        };
        if ended {
            return Err(wrong("something follows the end record".into()));
        }
        let record = Record::from_record_string(line).map_err(|error| wrong(error.to_string()))?;
        match record {
            Record::Data { offset, value } => {
                image.put(&mut filled, base + u64::from(offset), &value)?;
            }
            Record::ExtendedSegmentAddress(segment) => base = u64::from(segment) << 4,
            Record::ExtendedLinearAddress(high) => base = u64::from(high) << 16,
            Record::EndOfFile => ended = true,
            Record::StartSegmentAddress { .. } | Record::StartLinearAddress(_) => {}
        }
    }
    if ended {
        Ok(image)
    } else {
        Err(ImageError::Truncated)
    }
}

fn read_elf(bytes: &[u8]) -> Result<Image, ImageError> {
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
    if architecture != AVR6 {
        return Err(ImageError::Chip(architecture));
    }
    let mut image = Image::default();
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
    read_symbols(&mut image, bytes).map_err(broken)?;
    Ok(image)
}

fn put_eeprom(image: &mut Image, at: u64, data: &[u8]) -> Result<(), ImageError> {
    let end = at + data.len() as u64;
    if end > EEPROM_BYTES as u64 {
        return Err(ImageError::TooLarge {
            memory: "EEPROM",
            end,
            size: EEPROM_BYTES,
        });
    }
    let (start, end) = (at as usize, end as usize);
    if image.eeprom.len() < end {
        image.eeprom.resize(end, 0xFF);
    }
    image.eeprom[start..end].copy_from_slice(data);
    Ok(())
}

fn read_symbols(image: &mut Image, bytes: &[u8]) -> Result<(), object::Error> {
    let file = object::File::parse(bytes)?;
    for symbol in file.symbols() {
        let Ok(name) = symbol.name() else { continue };
        let address = symbol.address();
        if name == "_end" || name == "__heap_start" {
            image.data_end = u16::try_from(address.wrapping_sub(DATA_SPACE))
                .ok()
                .filter(|end| *end >= SRAM_START);
        }
        let code = symbol.kind() == SymbolKind::Text
            || symbol.kind() == SymbolKind::Label && name.starts_with("__vector");
        match u16::try_from(address.wrapping_sub(DATA_SPACE)) {
            _ if name.is_empty() => {}
            Ok(place) if symbol.kind() == SymbolKind::Data => {
                image.variables.push((place, name.to_owned()));
            }
            _ if code && address < FLASH_BYTES as u64 => {
                image
                    .functions
                    .push(((address / 2) as u32, name.to_owned()));
            }
            _ => {}
        }
    }
    image.functions.sort();
    image.functions.dedup_by_key(|(start, _)| *start);
    image.variables.sort();
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(text: &str) -> ImageError {
        Image::parse(text.as_bytes()).unwrap_err()
    }

    #[test]
    fn a_hex_file_is_loaded_to_its_addresses() {
        let image = Image::parse(b":020000000C945E\r\n:0200040008955D\r\n:00000001FF\r\n").unwrap();
        assert_eq!(image.flash(), [0x0C, 0x94, 0xFF, 0xFF, 0x08, 0x95]);
        let far = Image::parse(b":020000021000EC\n:02000000089561\n:00000001FF\n").unwrap();
        assert_eq!(far.flash().len(), 0x1_0002);
    }

    #[test]
    fn what_is_wrong_with_a_hex_file_is_told_with_its_line() {
        assert_eq!(error(":020000000C945E\n"), ImageError::Truncated);
        let overlap = ":020000000C945E\n:020001000C945D\n:00000001FF\n";
        assert_eq!(error(overlap), ImageError::Overlap(1));
        let beyond = ":020000040004F6\n:020000000C945E\n:00000001FF\n";
        assert!(matches!(
            error(beyond),
            ImageError::TooLarge {
                memory: "flash",
                ..
            }
        ));
        assert_eq!(error(":00000001FF\n"), ImageError::Empty);
        assert_eq!(error("hello"), ImageError::Unknown);
        assert!(matches!(
            error(":0200000\n"),
            ImageError::Hex { line: 1, .. }
        ));
        for wrong in [overlap, beyond, ":00000001FF\n", "hello"] {
            assert!(!error(wrong).to_string().is_empty());
        }
    }

    #[test]
    fn a_place_without_symbols_is_its_byte_address() {
        assert_eq!(Image::default().place(0x100), "0x00200");
    }
}
