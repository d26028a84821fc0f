//! The boards that sketches are compiled for, as the core's `boards.txt` describes them.

use crate::diagnostics::Diagnostic;

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
    /// An error with what it means on this board, where that is not what it says.
    pub(crate) fn explained(&self, mut error: Diagnostic) -> Diagnostic {
        let ports = ["'Serial1'", "'Serial2'", "'Serial3'"];
        if self.variant != "mega" && ports.iter().any(|port| error.text.starts_with(port)) {
            let board = self.name;
            error.notes.push(format!(
                "it is compiled for the robot's board, `{board}`, which has Serial alone; a Mega has Serial1 to Serial3"
            ));
        }
        error
    }

    /// The board of this name.
    #[must_use]
    pub fn named(name: &str) -> Option<Board> {
        BOARDS.into_iter().find(|board| board.name == name)
    }
}
