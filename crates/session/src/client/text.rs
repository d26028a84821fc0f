//! The client of a robot that speaks the original's text: how it is recognised, and what is asked of it.

use super::{Heard, RobotClient};
use crate::terminal::Told;
use rumbo_wire::Command;
use rumbo_wire::text::RowKind;

/// So many HELLOs without an answer, and the robot does not speak frames.
const HELLOS_UNANSWERED: u32 = 4;
/// So many rows of text, and it speaks text. As many frames, and it speaks frames after all.
const WORDS_KNOWN: u32 = 2;

impl RobotClient {
    /// The robot speaks the original's text.
    pub fn speaks_text(&self) -> bool {
        self.text
    }

    /// Which columns the row heard last had, where the robot speaks text.
    pub(crate) fn row_kind(&self) -> Option<RowKind> {
        self.row_kind.filter(|_| self.text)
    }

    /// Takes a command from the operator for a robot that speaks text; false if text has no words for it.
    pub fn submit_text(&mut self, command: &Command) -> bool {
        let mode = match *command {
            Command::Mode(mode) => mode,
            _ => self.mode,
        };
        self.terminal.submit(command, mode)
    }

    /// Takes a line that a person typed for a robot that speaks text.
    pub fn type_in(&mut self, line: &str) {
        self.terminal.type_in(line);
    }

    /// The port is gone, and the robot with it. Another one may be there when it is back: which language that speaks
    /// is to be found out, unless it is known from elsewhere.
    pub fn port_is_gone(&mut self) {
        self.heard_bytes = 0;
        self.terminal.forget();
        if self.undecided {
            self.text = false;
        }
        if !self.text {
            self.lose();
        }
    }

    /// Takes a row of text, which may tell that the robot speaks no frames.
    pub(super) fn hear_row(&mut self, told: Told, now_us: u64, heard: &mut Vec<Heard>) {
        if !self.text {
            self.words = self.words.saturating_add(1);
            let no_frames = !self.connected && self.hellos >= HELLOS_UNANSWERED;
            if !(no_frames && self.words >= WORDS_KNOWN) {
                return;
            }
            self.text = true;
            self.manager.forget();
        }
        self.words = 0;
        self.last_heard_us = now_us;
        if !std::mem::replace(&mut self.connected, true) {
            heard.push(Heard::Text);
        }
        self.mode = told.mode.unwrap_or(self.mode);
        self.reference = told.reference.unwrap_or(self.reference);
        self.heading_ref_rad = told.heading_ref_rad.unwrap_or_default();
        self.row_kind = Some(told.kind);
        self.frames.add(1, now_us);
        heard.push(Heard::Telemetry(told.t_ms, told.telemetry));
    }

    /// A robot that was taken for one of text, and speaks frames.
    pub(super) fn hear_frame_in_text(&mut self) {
        self.words += 1;
        if self.undecided && self.words >= WORDS_KNOWN {
            self.text = false;
            self.connected = false;
            self.hello_sent_us = None;
            (self.hellos, self.words) = (0, 0);
        }
    }
}
