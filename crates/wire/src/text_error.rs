//! Why a line of text is refused.

use core::fmt;

/// Why a line is no command or no row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TextError {
    /// No command starts like this.
    UnknownCommand,
    /// The motor is neither `A` nor `B`.
    UnknownMotor,
    /// A value is missing.
    Missing,
    /// Something follows the last value.
    Extra,
    /// The value number `.0` (the first is 1) is no decimal number.
    NotANumber(u8),
    /// The number of values fits no row of telemetry.
    Columns,
    /// The value number `.0` (the first is 1) is a number that the column cannot hold.
    OutOfRange(u8),
}

impl fmt::Display for TextError {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        match self {
            TextError::UnknownCommand => out.write_str(
                "unknown command; allowed: ON, OFF, REF, GOAL, PID, MODE, SAVE, RESET, each with its values",
            ),
            TextError::UnknownMotor => {
                out.write_str("unknown motor; A is the right wheel, B the left one")
            }
            TextError::Missing => out.write_str("a value is missing"),
            TextError::Extra => out.write_str("too many values"),
            TextError::NotANumber(at) => write!(out, "value {at} is not a number"),
            TextError::Columns => {
                out.write_str("the number of values fits no row of telemetry (7, 10 or 13)")
            }
            TextError::OutOfRange(at) => write!(out, "value {at} is out of range"),
        }
    }
}

impl core::error::Error for TextError {}
