//! The link to a robot that speaks the original's text: commands become lines, rows of telemetry become frames.
//!
//! Lines are sent once and not acknowledged; what the robot makes of them its rows tell. Whether it is armed no row says: it is what
//! was last ordered.

use rumbo_control::mode::ModeId;
use rumbo_wire::text::{self, Row};
use rumbo_wire::{Command, Telemetry};

/// A line longer than this is none.
const LONGEST: usize = 256;

/// The station's end of a link of text.
#[derive(Debug)]
pub(crate) struct Terminal {
    armed: bool,
    line: Vec<u8>,
    clock_ms: u32,
    /// Lines not sent yet.
    waiting: Vec<u8>,
}

impl Terminal {
    pub(crate) fn new() -> Self {
        Self {
            armed: false,
            line: Vec::new(),
            clock_ms: 0,
            waiting: Vec::new(),
        }
    }

    /// The command in words, to be sent; false if there are none.
    pub(crate) fn submit(&mut self, command: &Command, mode: ModeId) -> bool {
        match command {
            Command::Arm => self.armed = true,
            Command::Stop | Command::Disarm => {
                self.armed = false;
                self.waiting.clear();
            }
            _ => {}
        }
        let lines = text::lines_of(command, mode);
        for line in lines.iter().flatten() {
            self.waiting.extend(format!("{line}\n").bytes());
        }
        lines != [None; 2]
    }

    /// Appends what is to be sent now.
    pub(crate) fn poll(&mut self, to_robot: &mut Vec<u8>) {
        to_robot.append(&mut self.waiting);
    }

    /// Takes a byte from the robot; gives the row that it ends, as a frame, and the mode that it names.
    pub(crate) fn hear(&mut self, byte: u8) -> Option<(Telemetry, Option<ModeId>)> {
        if byte != b'\n' {
            if self.line.len() < LONGEST {
                self.line.push(byte);
            }
            return None;
        }
        let line = std::mem::take(&mut self.line);
        let row = Row::parse(str::from_utf8(&line).ok()?.trim()).ok()?;
        self.clock_ms = self.clock_ms.wrapping_add(row.dt_ms());
        let t_ms = (self.clock_ms & 0xffff) as u16;
        let mode = row.mode().and_then(ModeId::from_number);
        Some((row.telemetry(t_ms, self.armed), mode))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_becomes_a_frame_and_names_its_mode() {
        let mut terminal = Terminal::new();
        let mut told = Vec::new();
        for byte in b"garbage\r\n68, 106.16, 88.00, 30, 1, 115, -20\r\n" {
            told.extend(terminal.hear(*byte));
        }
        let [(telemetry, mode)] = told[..] else {
            panic!("{told:?}")
        };
        assert_eq!(mode, Some(ModeId::FrontDistance));
        assert_eq!((telemetry.t_ms, telemetry.duty.left.counts()), (68, -20));
    }

    #[test]
    fn off_goes_out_before_anything_that_waits() {
        let mut terminal = Terminal::new();
        assert!(terminal.submit(&Command::Arm, ModeId::WheelSpeed));
        assert!(terminal.submit(&Command::Stop, ModeId::WheelSpeed));
        assert!(!terminal.submit(&Command::Lane, ModeId::Mission));
        let mut bytes = Vec::new();
        terminal.poll(&mut bytes);
        assert_eq!(bytes, b"OFF\n");
    }
}
