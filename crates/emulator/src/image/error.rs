//! Why a file is no program for a chip, in one line each: what is wrong and what to do.

use crate::model::{MODELS, Model};
use object::elf;
use thiserror::Error;

/// Why a file is no program for a chip.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum ImageError {
    /// Neither ELF nor Intel HEX.
    #[error("neither an ELF file nor Intel HEX; give the .elf or .hex that the compiler made")]
    Unknown,
    /// An ELF file that cannot be read, or is cut off.
    #[error("the ELF file cannot be read ({0}); build it again")]
    Elf(String),
    /// An ELF file for another processor.
    #[error(
        "an ELF file for another processor (machine {machine}, an AVR is {avr}); {advice}",
        machine = .0, avr = elf::EM_AVR, advice = advice()
    )]
    Processor(u16),
    /// An AVR program, but for an architecture that no model has.
    #[error("an AVR program for another chip (architecture avr{0}); {advice}", advice = advice())]
    Chip(u32),
    /// An AVR program for a chip that there is no model of.
    #[error("a program for another chip ({0}); {advice}", advice = advice())]
    Device(String),
    /// A program for another chip than the board's.
    #[error(
        "a program for the {} of an {}, and this robot has an {}; {}",
        .own.name, .own.boards, .model.boards, .model.advice()
    )]
    Board {
        /// Its chip.
        own: &'static Model,
        /// The board's.
        model: &'static Model,
    },
    /// An object file: not linked.
    #[error("an object file, which is not a program yet; give the .elf that the linker made")]
    Object,
    /// A line of a HEX file is wrong.
    #[error("line {line} of the HEX file is wrong: {what}")]
    Hex {
        /// Its number, from 1.
        line: usize,
        /// What is wrong.
        what: String,
    },
    /// A HEX file without its end record.
    #[error("the HEX file ends without its end record: it is cut off; copy it again")]
    Truncated,
    /// Two parts of the file want the same byte.
    #[error("two parts of the file want flash address 0x{0:05x}; link it again")]
    Overlap(usize),
    /// Something lies beyond the end of a memory.
    #[error("too large: {memory} ends at 0x{size:x}, the program at 0x{end:x}")]
    TooLarge {
        /// Which memory.
        memory: &'static str,
        /// First byte after the end of what should go there.
        end: u64,
        /// Its size.
        size: usize,
    },
    /// There is nothing in it.
    #[error("there is no program in it")]
    Empty,
}

/// How to compile for one of the models.
fn advice() -> String {
    MODELS.map(Model::advice).join(", or ")
}
