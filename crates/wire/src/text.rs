//! The original program's text protocol, both directions, both ends.
//!
//! To the robot: a command a line (`ON`, `OFF`, `REF v`, `REF A v`, `REF B v`, `GOAL x y`, `PID A|B kp ki kd`, and our
//! `MODE n`, `SAVE`, `RESET`), in upper or lower case. From the robot: a row of comma-separated numbers, whose columns depend on the
//! mode (`csv` names them). Units are the original's here and nowhere else: cm, degrees, rpm, ms; A is the right wheel,
//! B the left one. The meaning of `REF` depends on the mode, so values stay as written.

use core::fmt;
use rumbo_control::Side;
use rumbo_control::math::round;
use rumbo_control::mode::{ModeId, ReferenceKind};

use crate::decimal;
use crate::message::Command;

pub use crate::text_error::TextError;
pub use crate::text_line::TextLine;
pub use crate::text_row::{DistanceRow, MissionRow, RowKind, SpeedRow, TextRow, WaypointsRow};
pub use crate::text_units::{
    CM_PER_M, MAX_LINE, RAD_PER_DEG, RAD_S_PER_RPM, cm_from_range, range_from_cm,
};

/// A command of the original text protocol.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TextCommand {
    /// Arm and start.
    On,
    /// Stop and disarm.
    Off,
    /// The mode's reference for both wheels [cm] or [rpm].
    Reference(f32),
    /// One wheel's reference [rpm].
    WheelReference(Side, f32),
    /// The next goal.
    Goal {
        /// Forward of the origin [m].
        x_m: f32,
        /// Left of the origin [m].
        y_m: f32,
    },
    /// Gains of one wheel's speed loop.
    Gains {
        /// The wheel.
        side: Side,
        /// Proportional gain [PWM per rpm].
        kp: f32,
        /// Integral gain [PWM per rpm and s].
        ki: f32,
        /// Derivative gain [PWM per rpm, times s].
        kd: f32,
    },
    /// Select a mode, by its number.
    Mode(u8),
    /// Save the parameters on the robot.
    Save,
    /// Set all parameters to their defaults.
    Reset,
}

impl TextCommand {
    /// The command in a line, given without its end.
    ///
    /// # Errors
    /// If the line is not exactly a command and its values.
    pub fn parse(line: impl AsRef<[u8]>) -> Result<TextCommand, TextError> {
        let mut words = Words {
            rest: line.as_ref(),
            values: 0,
        };
        let name = words.next().ok_or(TextError::UnknownCommand)?;
        let is = |wanted| is_word(name, wanted);
        let command = if is("ON") {
            TextCommand::On
        } else if is("OFF") {
            TextCommand::Off
        } else if is("REF") {
            match words.motor() {
                Some(side) => TextCommand::WheelReference(side, words.number()?),
                None => TextCommand::Reference(words.number()?),
            }
        } else if is("GOAL") {
            TextCommand::Goal {
                x_m: words.number()?,
                y_m: words.number()?,
            }
        } else if is("PID") {
            let side = words.motor().ok_or(TextError::UnknownMotor)?;
            TextCommand::Gains {
                side,
                kp: words.number()?,
                ki: words.number()?,
                kd: words.number()?,
            }
        } else if is("MODE") {
            match words.next().ok_or(TextError::Missing)? {
                [digit @ b'0'..=b'9'] => TextCommand::Mode(digit - b'0'),
                _ => return Err(TextError::NotANumber(1)),
            }
        } else if is("SAVE") {
            TextCommand::Save
        } else if is("RESET") {
            TextCommand::Reset
        } else {
            return Err(TextError::UnknownCommand);
        };
        if words.next().is_some() {
            Err(TextError::Extra)
        } else {
            Ok(command)
        }
    }
}

/// The command as the station sends it, without the LF.
impl fmt::Display for TextCommand {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        let motor = |side: &Side| match side {
            Side::Right => 'A',
            Side::Left => 'B',
        };
        match self {
            TextCommand::On => out.write_str("ON"),
            TextCommand::Off => out.write_str("OFF"),
            TextCommand::Reference(value) => write!(out, "REF {value}"),
            TextCommand::WheelReference(side, value) => write!(out, "REF {} {value}", motor(side)),
            TextCommand::Goal { x_m, y_m } => write!(out, "GOAL {x_m} {y_m}"),
            TextCommand::Gains { side, kp, ki, kd } => {
                write!(out, "PID {} {kp} {ki} {kd}", motor(side))
            }
            TextCommand::Mode(number) => write!(out, "MODE {number}"),
            TextCommand::Save => out.write_str("SAVE"),
            TextCommand::Reset => out.write_str("RESET"),
        }
    }
}

/// A command of the link in the original text protocol, for a robot in this mode: a line, or one for each wheel; none
/// where the protocol has no such command.
pub fn lines_of(command: &Command, mode: ModeId) -> [Option<TextCommand>; 2] {
    // Two decimals are what the original prints, and all that its units need.
    let short = |value: f32| round(value * 100.0) as f32 / 100.0;
    let single = |command| [Some(command), None];
    match *command {
        Command::Arm => single(TextCommand::On),
        Command::Stop | Command::Disarm => single(TextCommand::Off),
        Command::Mode(mode) => single(TextCommand::Mode(mode as u8)),
        Command::Goal { x_m, y_m } => single(TextCommand::Goal { x_m, y_m }),
        Command::Reference(value) => {
            let value = match mode.takes_reference() {
                Some(ReferenceKind::WheelSpeed | ReferenceKind::Speed) => value / RAD_S_PER_RPM,
                _ => value * CM_PER_M,
            };
            single(TextCommand::Reference(short(value)))
        }
        Command::WheelReference(rad_s) => {
            let line = |side| {
                Some(TextCommand::WheelReference(
                    side,
                    short(rad_s[side] / RAD_S_PER_RPM),
                ))
            };
            [line(Side::Right), line(Side::Left)]
        }
        _ => [None; 2],
    }
}

/// Whether a word is the wanted one, in upper or lower case.
fn is_word(word: &[u8], wanted: &str) -> bool {
    word.eq_ignore_ascii_case(wanted.as_bytes())
}

/// Words separated by blanks.
struct Words<'a> {
    rest: &'a [u8],
    values: u8,
}

impl<'a> Words<'a> {
    fn next(&mut self) -> Option<&'a [u8]> {
        let rest = self.rest.trim_ascii_start();
        let end = rest
            .iter()
            .position(u8::is_ascii_whitespace)
            .unwrap_or(rest.len());
        let (word, rest) = rest.split_at_checked(end)?;
        self.rest = rest;
        (!word.is_empty()).then_some(word)
    }

    /// The motor, if its letter is next.
    fn motor(&mut self) -> Option<Side> {
        let before = self.rest;
        match self.next() {
            Some(b"A" | b"a") => Some(Side::Right),
            Some(b"B" | b"b") => Some(Side::Left),
            _ => {
                self.rest = before;
                None
            }
        }
    }

    fn number(&mut self) -> Result<f32, TextError> {
        let word = self.next().ok_or(TextError::Missing)?;
        self.values += 1;
        decimal::parse(word).ok_or(TextError::NotANumber(self.values))
    }
}
