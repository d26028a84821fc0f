//! Program images: ELF with symbols and EEPROM contents, or Intel HEX.

mod elf;
mod error;
mod hex;
mod start;

pub use error::ImageError;

use crate::model::{MODELS, Model};

/// A byte of flash that is not programmed.
const ERASED: u8 = 0xFF;

/// A program for the chip.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Image {
    /// The chip that it says it is for.
    model: Option<&'static Model>,
    flash: Vec<u8>,
    eeprom: Vec<u8>,
    functions: Vec<Symbol>,
    variables: Vec<Symbol>,
    data_end: Option<u16>,
}

/// A function or a variable.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Symbol {
    /// Where it starts: of a function [words], of a variable its address in the data space.
    pub address: u32,
    /// Its length, in the same unit; 0 if the image does not contain it.
    pub size: u32,
    /// As it is written in the source: C++ and Rust with their paths.
    pub name: String,
}

impl Image {
    /// Reads an ELF file or Intel HEX, whichever `bytes` are. An ELF file names its chip; a HEX file does not, but most
    /// show it by where they put their stack.
    ///
    /// # Errors
    /// Why they are no program for any chip that there is.
    pub fn parse(bytes: &[u8]) -> Result<Image, ImageError> {
        let image = if elf::is_elf(bytes) {
            elf::read(bytes)
        } else if let Some(text) = hex::text(bytes) {
            hex::read(text)
        } else {
            Err(ImageError::Unknown)
        }?;
        if image.flash.is_empty() {
            return Err(ImageError::Empty);
        }
        let model = image.model;
        image.fitting(model)
    }

    /// The image as one for this chip.
    ///
    /// # Errors
    /// It is for another one, or too large.
    pub fn on(self, model: &'static Model) -> Result<Image, ImageError> {
        match self.model {
            Some(own) if own != model => Err(ImageError::Board { own, model }),
            _ => self.fitting(Some(model)),
        }
    }

    fn fitting(mut self, model: Option<&'static Model>) -> Result<Image, ImageError> {
        self.model = model;
        let Some(model) = model else {
            return Ok(self);
        };
        let data = self.data_end.map_or(0, usize::from);
        for (memory, end, size) in [
            ("flash", self.flash.len(), model.flash_bytes()),
            ("EEPROM", self.eeprom.len(), model.eeprom_bytes),
            ("SRAM", data, usize::from(model.ram_end) + 1),
        ] {
            if end > size {
                return Err(ImageError::TooLarge {
                    memory,
                    end: end as u64,
                    size,
                });
            }
        }
        Ok(self)
    }

    /// The chip that it is for: a Mega's, if it does not say.
    pub fn model(&self) -> &'static Model {
        self.model.unwrap_or_default()
    }

    /// A program of these bytes of flash, without names; what lies beyond the largest flash is ignored.
    pub fn of_flash(bytes: &[u8]) -> Image {
        Image {
            flash: bytes[..bytes.len().min(largest(Model::flash_bytes))].to_vec(),
            ..Image::default()
        }
    }

    /// The same with these bytes at an address behind the program; what lies between is erased.
    ///
    /// # Errors
    /// The program reaches there, or the bytes do not fit.
    pub fn with(mut self, at: u32, bytes: &[u8]) -> Result<Image, ImageError> {
        let start = at as usize;
        if self.flash.len() > start {
            return Err(ImageError::Overlap(start));
        }
        self.flash.resize(start, ERASED);
        self.flash.extend(bytes);
        let model = self.model();
        self.fitting(Some(model))
    }

    /// The flash from address 0 to the end of the program.
    pub fn flash(&self) -> &[u8] {
        &self.flash
    }

    /// The image's EEPROM content, from address 0.
    pub fn eeprom(&self) -> &[u8] {
        &self.eeprom
    }

    /// The end of the program's static data, below which the stack must not grow; known from an ELF file only.
    pub fn data_end(&self) -> Option<u16> {
        self.data_end
    }

    /// Functions by address, ascending; of several names for one address the last is the one shown.
    pub fn functions(&self) -> &[Symbol] {
        &self.functions
    }

    /// Variables by address, ascending.
    pub fn variables(&self) -> &[Symbol] {
        &self.variables
    }

    /// The variable of this name.
    pub fn variable(&self, name: &str) -> Option<&Symbol> {
        self.variables.iter().find(|variable| variable.name == name)
    }

    /// The function of this name.
    pub fn function_named(&self, name: &str) -> Option<&Symbol> {
        self.functions.iter().find(|function| function.name == name)
    }

    /// The function that an instruction [words] is in, if the image has symbols.
    pub fn function(&self, word: u32) -> Option<&str> {
        let after = self
            .functions
            .partition_point(|function| function.address <= word);
        let function = self.functions.get(after.checked_sub(1)?)?;
        let end = match function.size {
            // A label of the assembler: to the end of the program, if no other follows.
            0 => self.flash.len().div_ceil(2) as u32,
            size => function.address + size,
        };
        (word < end).then_some(&function.name)
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
        let size = largest(Model::flash_bytes);
        if end > size as u64 {
            return Err(ImageError::TooLarge {
                memory: "flash",
                end,
                size,
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

/// The size of a memory on the model that has most of it.
fn largest(size: impl Fn(&Model) -> usize) -> usize {
    MODELS.into_iter().map(size).max().unwrap_or_default()
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
    fn an_error_in_a_hex_file_is_reported_with_its_line() {
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
