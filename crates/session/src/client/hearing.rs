//! What the robot says, taken in: who it is, what time it has, what became of commands; and that it says nothing any
//! more.

use super::meeting::Clock;
use super::{Heard, RobotClient};
use crate::commands::Fate;
use crate::robot_clock::RobotClock;
use rumbo_control::mode::ModeId;
use rumbo_wire::{EventKind, FromRobot, Hello, Message, PROTOCOL_VERSION, Received, RobotTime};

impl RobotClient {
    /// Takes bytes that arrived from the robot and appends what they say.
    pub fn hear(&mut self, bytes: &[u8], now_us: u64, heard: &mut Vec<Heard>) {
        self.down.add(bytes.len(), now_us);
        self.heard_bytes += bytes.len() as u64;
        for byte in bytes {
            if let Some(told) = self.terminal.hear(*byte, (now_us / 1_000) as i64) {
                self.hear_row(told, now_us, heard);
            }
            let body = match self.decoder.push(*byte) {
                Some(Received::Frame(body)) => body,
                // A robot addressed in binary answers so; a line is left from before.
                Some(Received::Line(_)) | None => continue,
            };
            let errors = self.decoder.crc_errors();
            self.cut_off.get_or_insert(errors.min(1));
            match FromRobot::from_body(&body) {
                Ok(_) if self.text => self.hear_frame_in_text(),
                Ok(message) => self.understand(message, now_us, heard),
                Err(_) => self.malformed = self.malformed.wrapping_add(1),
            }
        }
        self.report_outcomes(heard);
    }

    /// Takes a message from the robot and appends what it says.
    pub(crate) fn understand(&mut self, message: FromRobot, now_us: u64, heard: &mut Vec<Heard>) {
        self.last_heard_us = now_us;
        self.frames.add(
            usize::from(matches!(message, FromRobot::Telemetry(_))),
            now_us,
        );
        let now_ms = (now_us / 1_000) as i64;
        let way_ms = (self.manager.way_us() / 1_000) as i64;
        if self.connected && !matches!(message, FromRobot::Ack(_)) {
            self.oddities.frame(now_us);
        }
        match message {
            FromRobot::Hello(hello) => self.greet(hello, heard),
            FromRobot::Telemetry(telemetry) => {
                self.meeting.tell_low(telemetry.t_ms);
                if !telemetry.armed {
                    (self.stopping, self.still_armed_us) = (false, None);
                } else if self.stopping {
                    self.still_armed_us.get_or_insert(now_us);
                }
                if self.connected {
                    self.oddities.telemetry(telemetry.t_ms, now_us);
                }
                let t_ms = self.clock.session_ms(telemetry.t_ms, now_ms, way_ms);
                heard.push(Heard::Telemetry(t_ms, telemetry));
            }
            FromRobot::Status(status) => {
                self.tell_time(status.at, now_us, heard);
                self.enter(status.mode);
                self.reference = status.reference;
                heard.push(Heard::Status(status));
            }
            FromRobot::Event(event) => {
                if let EventKind::ModeChanged(mode) = event.kind {
                    self.enter(mode);
                }
                heard.push(Heard::Event(
                    self.clock.session_ms(event.t_ms, now_ms, way_ms),
                    event.kind,
                ));
            }
            FromRobot::Ack(ack) => {
                let stopping = self.manager.stop_since_us().is_some();
                self.manager.acknowledge(&ack, now_us);
                self.stopping |= stopping && self.manager.stop_since_us().is_none();
            }
            FromRobot::HeadingRef(heading_rad) => self.heading_ref_rad = heading_rad,
        }
        heard.extend(self.oddities.take().map(Heard::Odd));
    }

    fn greet(&mut self, hello: Hello, heard: &mut Vec<Heard>) {
        (self.hellos, self.words) = (0, 0);
        let before = self.meeting.greet(hello);
        if hello.protocol == PROTOCOL_VERSION {
            return self.meet(heard);
        }
        // Nothing but this is understood of it: nothing is guessed, nothing is asked.
        self.lose();
        if before != Some(hello) {
            heard.push(Heard::OtherProtocol(hello));
        }
    }

    fn tell_time(&mut self, at: RobotTime, now_us: u64, heard: &mut Vec<Heard>) {
        let clock = self.meeting.tell(at);
        if clock != Clock::On {
            // What was asked of it is over, and its clock says nothing about the one before.
            self.connected = false;
            self.hello_sent_us = None;
            self.manager.give_up(Fate::RobotRestarted);
            self.clock = RobotClock::UNKNOWN;
        }
        match clock {
            Clock::Restarted => self.oddities.begin(),
            Clock::On | Clock::Back => self.oddities.status(at, now_us),
        }
        self.meet(heard);
    }

    /// The robot is connected, once it is known well enough.
    fn meet(&mut self, heard: &mut Vec<Heard>) {
        if self.connected {
            return;
        }
        let Some((hello, restarted)) = self.meeting.complete() else {
            return;
        };
        self.connected = true;
        heard.push(match restarted {
            true => Heard::Restarted(hello),
            false => Heard::Connected(hello),
        });
        self.read_parameters();
    }

    /// The robot is not there any more: nothing that was asked of it is asked of it when it is back, except STOP.
    pub(super) fn lose(&mut self) {
        self.connected = false;
        self.meeting.lose();
        self.oddities.begin();
        self.manager.give_up(Fate::LinkLost);
        (self.stopping, self.still_armed_us) = (false, None);
        self.hello_sent_us = None;
        (self.hellos, self.words) = (0, 0);
    }

    /// The robot is in this mode.
    pub(super) fn enter(&mut self, mode: ModeId) {
        if self.mode != mode {
            self.mode = mode;
            self.read_own_first();
        }
    }
}
