//! Why a program cannot be written, with what to do.

use std::fmt;
use thiserror::Error;

/// Where the boot loader begins, in the last 8 KB of 256 \[bytes\].
pub(crate) const BOOT_SECTION: usize = (256 - 8) << 10;

/// What is going on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// The board is reset, and its boot loader looked for.
    Connecting,
    /// Pages are written.
    Writing,
    /// They are read back.
    Verifying,
    /// The first page is written and the program started.
    Finishing,
}

impl fmt::Display for Phase {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Connecting => "connecting",
            Self::Writing => "writing",
            Self::Verifying => "reading back",
            Self::Finishing => "finishing",
        })
    }
}

/// A program reaches into the section of the boot loader.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error(
    "it reaches into the boot loader's section, from {BOOT_SECTION:#x} on, which stays as it is: give the image \
     without a boot loader"
)]
pub struct IntoBootSection;

/// Why writing has ended before its time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum FlashError {
    /// Nothing answers after a reset.
    #[error(
        "no Arduino Mega answers: is it on its USB cable, is the port the right one, does another program use it? \
         If its reset by the cable is disabled, press its RESET button now and then while this runs"
    )]
    NoAnswer,
    /// The port's lines do not reset the board, which is needed before the first page is written.
    #[error(
        "the board is not reset by the port any more: write it again, and press its RESET button while this runs"
    )]
    NoReset,
    /// Another chip answers.
    #[error(
        "the chip has the signature {}, an ATmega2560 has {}: is that board an Arduino Mega 2560?",
        hex(.found), hex(.expected)
    )]
    Signature {
        /// Its own.
        found: [u8; 3],
        /// That of an ATmega2560.
        expected: [u8; 3],
    },
    /// The boot loader answers no more.
    #[error("the boot loader answers no more ({0}): check the cable and write again")]
    Silent(Phase),
    /// The boot loader answers that it does not do what it was asked for.
    #[error(
        "the boot loader refuses the command {command:#04x} with {status:#04x} ({phase}): is that board an Arduino \
         Mega 2560?"
    )]
    Refused {
        /// Meanwhile.
        phase: Phase,
        /// The number of the command.
        command: u8,
        /// Its answer.
        status: u8,
    },
    /// What was read back is not what was written.
    #[error(
        "at {address:#07x} the board has {read:#04x}, and {written:#04x} was written: write again; if it stays so, \
         the chip's flash is worn out"
    )]
    Mismatch {
        /// Where [bytes].
        address: usize,
        /// What was written.
        written: u8,
        /// What was read.
        read: u8,
    },
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
