//! The boards that sketches are compiled for, as the core's `boards.txt` describes them.

/// A board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Board {
    /// As robot files and `--board` name it.
    pub name: &'static str,
    /// The compiler's options for its chip.
    pub(crate) options: [&'static str; 2],
    /// Its folder of pin numbers in the core.
    pub(crate) variant: &'static str,
}

/// The boards that there are, the usual one first.
pub const BOARDS: [Board; 3] = [
    Board {
        name: "mega",
        options: ["-mmcu=atmega2560", "-DARDUINO_AVR_MEGA2560"],
        variant: "mega",
    },
    Board {
        name: "uno",
        options: ["-mmcu=atmega328p", "-DARDUINO_AVR_UNO"],
        variant: "standard",
    },
    Board {
        name: "nano",
        options: ["-mmcu=atmega328p", "-DARDUINO_AVR_NANO"],
        variant: "eightanaloginputs",
    },
];

impl Board {
    /// The board of this name.
    #[must_use]
    pub fn named(name: &str) -> Option<Board> {
        BOARDS.into_iter().find(|board| board.name == name)
    }
}
