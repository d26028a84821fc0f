//! Why a program cannot go on, and how it got there.

use crate::image::Image;
use std::collections::BTreeMap;
use std::fmt;

/// Why a program could not continue. Addresses in words; [`crate::image::Image::place`] names them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The program counter ran into flash that was never written.
    ErasedFlash {
        /// Where.
        program_counter: u32,
        /// From where, and how.
        arrival: Arrival,
        /// When.
        cycle: u64,
    },
    /// No such instruction.
    IllegalInstruction {
        /// Where.
        program_counter: u32,
        /// What stands there.
        word: u16,
        /// From where, and how.
        arrival: Arrival,
        /// When.
        cycle: u64,
    },
    /// The stack grew into the program's data.
    StackOverflow {
        /// The instruction that pushed.
        program_counter: u32,
        /// Where the stack stands.
        stack_pointer: u16,
        /// Bytes on the stack.
        depth: u16,
        /// Return addresses on the stack [words], the innermost first.
        returns: Vec<u32>,
        /// End of the data.
        floor: u16,
        /// When.
        cycle: u64,
    },
}

/// How the program counter got to where the program cannot go on. `at` is the instruction that led there [words].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrival {
    /// RET or RETI.
    Return {
        /// Where.
        at: u32,
        /// The stack pointer behind it: the address was in the bytes up to there.
        stack_pointer: u16,
    },
    /// A jump or call through Z.
    Pointer {
        /// Where.
        at: u32,
        /// The assembler's name of it.
        mnemonic: &'static str,
    },
    /// An interrupt whose place in the table of vectors is this.
    Interrupt {
        /// Its vector.
        vector: u8,
    },
    /// A jump, call or branch whose target is in the instruction.
    Jump {
        /// Where: the first of the program that leads there.
        at: u32,
    },
    /// The instruction before.
    Sequence {
        /// Where.
        at: u32,
    },
    /// The reset.
    Start,
    /// A debugger, or something that was changed meanwhile.
    Unknown,
}

impl Verdict {
    /// The instruction at which it ended [words].
    pub const fn program_counter(&self) -> u32 {
        match self {
            Verdict::ErasedFlash {
                program_counter, ..
            }
            | Verdict::IllegalInstruction {
                program_counter, ..
            }
            | Verdict::StackOverflow {
                program_counter, ..
            } => *program_counter,
        }
    }

    /// The verdict with the names of the functions involved, as far as the image has them.
    pub fn describe(&self, image: &Image) -> String {
        self.text(image)
    }

    fn text(&self, image: &Image) -> String {
        let place = image.place(self.program_counter());
        match self {
            Verdict::ErasedFlash { arrival, cycle, .. } => {
                let how = arrival.text(image);
                format!("ran into erased flash at {place} in cycle {cycle}, {how}")
            }
            Verdict::IllegalInstruction {
                word,
                arrival,
                cycle,
                ..
            } => {
                let how = arrival.text(image);
                format!(
                    "illegal instruction 0x{word:04x} at {place} in cycle {cycle}, {how}; or this image is for another chip"
                )
            }
            Verdict::StackOverflow {
                stack_pointer,
                depth,
                returns,
                floor,
                cycle,
                ..
            } => format!(
                "stack overflow at {place} in cycle {cycle}: {depth} bytes deep, down to 0x{stack_pointer:04x}, the data end at 0x{floor:04x}{}",
                calls(returns, image)
            ),
        }
    }
}

/// Summary of the return addresses: the function most often on the stack, or the chain of calls.
fn calls(returns: &[u32], image: &Image) -> String {
    let names: Vec<&str> = returns
        .iter()
        .filter_map(|word| image.function(*word))
        .collect();
    let mut counts = BTreeMap::new();
    for name in &names {
        *counts.entry(*name).or_insert(0) += 1;
    }
    match counts.into_iter().max_by_key(|(_, count)| *count) {
        None => String::new(),
        Some((name, count)) if count > 2 => format!("; {name} is on it {count} times"),
        Some(_) => format!("; called from {}", names.join(", from ")),
    }
}

impl Arrival {
    fn text(&self, image: &Image) -> String {
        match self {
            Arrival::Return { at, stack_pointer } => format!(
                "by the return at {} with the stack pointer at 0x{stack_pointer:04x}: the return address was overwritten, or the stack is out of step",
                image.place(*at)
            ),
            Arrival::Pointer { at, mnemonic } => format!(
                "by {mnemonic} at {}: a wrong function pointer",
                image.place(*at)
            ),
            Arrival::Interrupt { vector } => {
                format!("by interrupt {vector}: the program has no table of vectors there")
            }
            Arrival::Jump { at } => format!(
                "by the jump at {}: the image lacks what it leads to",
                image.place(*at)
            ),
            Arrival::Sequence { at } => format!(
                "after the instruction at {}: the program goes on past its end, or into its constants",
                image.place(*at)
            ),
            Arrival::Start => "where a program begins: the image has nothing there".into(),
            Arrival::Unknown => {
                "by a jump through a wrong pointer, or a return address overwritten".into()
            }
        }
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        out.write_str(&self.text(&Image::default()))
    }
}
