//! The client of a robot that speaks the original's text: how it is recognised, and how commands reach it.

use super::{LinkEvent, RobotClient};
use crate::terminal::ParsedRow;
use rumbo_wire::Command;
use rumbo_wire::text::RowKind;

/// After this many unanswered HELLOs the robot does not speak frames.
const HELLOS_UNANSWERED: u32 = 4;
/// After this many rows of text it speaks text; after as many frames it speaks frames after all.
const WORDS_KNOWN: u32 = 2;

impl RobotClient {
    /// The robot speaks the original's text.
    pub fn speaks_text(&self) -> bool {
        self.text
    }

    /// The columns of the last row, where the robot speaks text.
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

    /// Takes what a person typed for a robot that speaks text, with the end of its line.
    pub fn type_in(&mut self, text: &str) {
        self.terminal.type_in(text);
    }

    /// The port is gone, and the robot with it. Another one may be there when it is back: its protocol is detected
    /// then, unless it was given.
    pub fn port_is_gone(&mut self) {
        (self.received_bytes, self.unread_bytes) = (0, 0);
        self.terminal.forget();
        if self.undecided {
            self.text = false;
        }
        if !self.text {
            self.lose();
        }
    }

    /// Takes a row of text, which may show that the robot does not speak frames.
    pub(super) fn receive_row(&mut self, row: ParsedRow, now_us: u64, events: &mut Vec<LinkEvent>) {
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
        self.last_received_us = now_us;
        if !std::mem::replace(&mut self.connected, true) {
            events.push(LinkEvent::Text);
        }
        self.mode = row.mode.unwrap_or(self.mode);
        self.reference = row.reference.unwrap_or(self.reference);
        self.heading_ref_rad = row.heading_ref_rad.unwrap_or_default();
        self.row_kind = Some(row.kind);
        self.frames.add(1, now_us);
        events.push(LinkEvent::Telemetry(row.t_ms, row.telemetry));
    }

    /// A frame from a robot that was taken for one that speaks text.
    pub(super) fn receive_frame_in_text(&mut self) {
        self.words += 1;
        if self.undecided && self.words >= WORDS_KNOWN {
            self.text = false;
            self.connected = false;
            self.hello_sent_us = None;
            (self.hellos, self.words) = (0, 0);
        }
    }
}
