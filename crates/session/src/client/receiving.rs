//! Messages from the robot: its identity, its time, acknowledgements; and the loss of the link.

use super::handshake::Clock;
use super::{LinkEvent, RobotClient};
use crate::commands::Fate;
use crate::robot_clock::RobotClock;
use rumbo_control::mode::ModeId;
use rumbo_wire::{
    EventKind, FrameMessage, FromRobot, Hello, PROTOCOL_VERSION, Received, RobotTime,
};

impl RobotClient {
    /// Decodes bytes from the robot and appends the events.
    pub fn receive(&mut self, bytes: &[u8], now_us: u64, events: &mut Vec<LinkEvent>) {
        self.down.add(bytes.len(), now_us);
        self.received_bytes += bytes.len() as u64;
        for byte in bytes {
            self.unread_bytes += 1;
            if let Some(row) = self.terminal.receive(*byte, (now_us / 1_000) as i64) {
                self.unread_bytes = 0;
                self.receive_row(row, now_us, events);
            }
            let body = match self.decoder.push(*byte) {
                Some(Received::Frame(body)) => body,
                // A robot addressed in binary answers in binary; a line is left from before.
                Some(Received::Line(_)) | None => continue,
            };
            self.unread_bytes = 0;
            let errors = self.decoder.crc_errors();
            self.cut_off.get_or_insert(errors.min(1));
            match FromRobot::from_body(&body) {
                Ok(_) if self.text => self.receive_frame_in_text(),
                Ok(message) => self.handle(message, now_us, events),
                Err(_) => self.malformed = self.malformed.wrapping_add(1),
            }
        }
        self.report_outcomes(events);
    }

    /// Handles a message from the robot and appends the events.
    pub(crate) fn handle(&mut self, message: FromRobot, now_us: u64, events: &mut Vec<LinkEvent>) {
        self.last_received_us = now_us;
        self.frames.add(
            usize::from(matches!(message, FromRobot::Telemetry(_))),
            now_us,
        );
        let now_ms = (now_us / 1_000) as i64;
        let way_ms = (self.manager.way_us() / 1_000) as i64;
        if self.connected && !matches!(message, FromRobot::Ack(_)) {
            self.anomalies.frame(now_us);
        }
        match message {
            FromRobot::Hello(hello) => self.hello_received(hello, events),
            FromRobot::Telemetry(telemetry) => {
                self.handshake.update_low(telemetry.t_ms);
                if !telemetry.armed {
                    (self.stopping, self.still_armed_us) = (false, None);
                } else if self.stopping {
                    self.still_armed_us.get_or_insert(now_us);
                }
                if self.connected {
                    self.anomalies.telemetry(&telemetry, now_us);
                }
                let t_ms = self.clock.session_ms(telemetry.t_ms, now_ms, way_ms);
                events.push(LinkEvent::Telemetry(t_ms, telemetry));
            }
            FromRobot::Status(status) => {
                self.time_reported(status.at, now_us, events);
                self.enter(status.mode);
                self.reference = status.reference;
                events.push(LinkEvent::Status(status));
            }
            FromRobot::Event(event) => {
                if let EventKind::ModeChanged(mode) = event.kind {
                    self.enter(mode);
                }
                events.push(LinkEvent::Event(
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
        events.extend(self.anomalies.drain().map(LinkEvent::Anomaly));
    }

    fn hello_received(&mut self, hello: Hello, events: &mut Vec<LinkEvent>) {
        (self.hellos, self.words) = (0, 0);
        let before = self.handshake.hello_received(hello);
        if hello.protocol == PROTOCOL_VERSION {
            return self.meet(events);
        }
        // Nothing else of it can be decoded: nothing is guessed or requested.
        self.lose();
        if before != Some(hello) {
            events.push(LinkEvent::OtherProtocol(hello));
        }
    }

    fn time_reported(&mut self, at: RobotTime, now_us: u64, events: &mut Vec<LinkEvent>) {
        let clock = self.handshake.update(at);
        if clock != Clock::On {
            // Pending requests are void, and the new clock is unrelated to the old one.
            self.connected = false;
            self.hello_sent_us = None;
            self.manager.give_up(Fate::RobotRestarted);
            self.clock = RobotClock::UNKNOWN;
        }
        match clock {
            Clock::Restarted => self.anomalies.begin(),
            Clock::On | Clock::Back => self.anomalies.status(at, now_us),
        }
        self.meet(events);
    }

    /// Connects the robot once its HELLO and its time are known.
    fn meet(&mut self, events: &mut Vec<LinkEvent>) {
        if self.connected {
            return;
        }
        let Some((hello, restarted)) = self.handshake.complete() else {
            return;
        };
        self.connected = true;
        events.push(match restarted {
            true => LinkEvent::Restarted(hello),
            false => LinkEvent::Connected(hello),
        });
        self.read_parameters();
    }

    /// The robot is gone: no pending request is sent when it is back, except STOP.
    pub(super) fn lose(&mut self) {
        self.connected = false;
        self.handshake.reset();
        self.anomalies.begin();
        self.manager.give_up(Fate::LinkLost);
        (self.stopping, self.still_armed_us) = (false, None);
        self.hello_sent_us = None;
        (self.hellos, self.words) = (0, 0);
    }

    /// Notes the robot's mode.
    pub(super) fn enter(&mut self, mode: ModeId) {
        if self.mode != mode {
            self.mode = mode;
            self.read_own_first();
        }
    }
}
