//! Why a program cannot go on.

use crate::image::Image;
use std::fmt;

/// How a run of a program ended before its time. Addresses in words; [`crate::image::Image::place`] names them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The program counter ran into flash that was never written.
    ErasedFlash {
        /// Where.
        program_counter: u32,
        /// When.
        cycle: u64,
    },
    /// No such instruction.
    IllegalInstruction {
        /// Where.
        program_counter: u32,
        /// What stands there.
        word: u16,
        /// When.
        cycle: u64,
    },
    /// The stack grew into the program's data.
    StackOverflow {
        /// The instruction that pushed.
        program_counter: u32,
        /// Where the stack stands.
        stack_pointer: u16,
        /// End of the data.
        floor: u16,
        /// When.
        cycle: u64,
    },
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
}

impl Verdict {
    /// The verdict with the name of the function in which it happened, if the image knows it.
    pub fn told(&self, image: &Image) -> String {
        self.text(&image.place(self.program_counter()))
    }

    fn text(&self, place: &str) -> String {
        match self {
            Verdict::ErasedFlash { cycle, .. } => format!(
                "ran into erased flash at {place} in cycle {cycle}: a jump through a wrong pointer, or a return address overwritten"
            ),
            Verdict::IllegalInstruction { word, cycle, .. } => format!(
                "illegal instruction 0x{word:04x} at {place} in cycle {cycle}: this image is for another chip, or the program ran into data"
            ),
            Verdict::StackOverflow {
                stack_pointer,
                floor,
                cycle,
                ..
            } => format!(
                "stack overflow at {place} in cycle {cycle}: the stack has come down to 0x{stack_pointer:04x}, the data end at 0x{floor:04x}"
            ),
        }
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        let place = format!("0x{:05x}", 2 * self.program_counter());
        out.write_str(&self.text(&place))
    }
}
