//! Why a file is no program for a chip, in one line each: what is wrong and what to do.

use crate::model::{MODELS, Model};
use object::elf;
use std::fmt;

/// Why a file is no program for a chip.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ImageError {
    /// Neither ELF nor Intel HEX.
    Unknown,
    /// An ELF file that cannot be read, or is cut off.
    Elf(String),
    /// An ELF file for another processor.
    Processor(u16),
    /// An AVR program, but for an architecture that no model has.
    Chip(u32),
    /// An AVR program for a chip that there is no model of.
    Device(String),
    /// A program for another chip than the board's.
    Board {
        /// Its chip.
        own: &'static Model,
        /// The board's.
        model: &'static Model,
    },
    /// An object file: not linked.
    Object,
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
                "an ELF file for another processor (machine {machine}, an AVR is {}); {}",
                elf::EM_AVR,
                advice()
            ),
            ImageError::Chip(architecture) => write!(
                out,
                "an AVR program for another chip (architecture avr{architecture}); {}",
                advice()
            ),
            ImageError::Device(name) => {
                write!(out, "a program for another chip ({name}); {}", advice())
            }
            ImageError::Board { own, model } => write!(
                out,
                "a program for the {} of an {}, and this robot has an {}; {}",
                own.name,
                own.boards,
                model.boards,
                model.advice()
            ),
            ImageError::Object => write!(
                out,
                "an object file, which is not a program yet; give the .elf that the linker made"
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

/// How to compile for one of the models.
fn advice() -> String {
    MODELS.map(Model::advice).join(", or ")
}

impl std::error::Error for ImageError {}
