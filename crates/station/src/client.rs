//! The station's end of the link: bytes from the robot become what was heard, commands become bytes.
//!
//! Knows the protocol and nothing of browsers, threads or wall clocks: time is an argument, in the target's time. It asks for
//! HELLO until the robot answers, then reads the parameters, sends heartbeats, and notices silence and restarts. It
//! never arms. A robot that leaves HELLO unanswered and sends rows of the original's text is talked to in text.

mod heard;
mod text;

pub use heard::{Heard, KnownTable, LinkFigures};

use crate::commands::{CommandManager, Fate, QueueFull};
use crate::meter::Meter;
use crate::robot_clock::RobotClock;
use crate::terminal::Terminal;
use rumbo_control::Wheels;
use rumbo_control::mode::ModeId;
use rumbo_control::params::ParamId;
use rumbo_wire::text::RowKind;
use rumbo_wire::{
    Ack, Command, Decoder, EventKind, FromRobot, Hello, Message, PROTOCOL_VERSION, Received,
    ToRobot,
};

/// Room for a line of the original's text, the longest thing a robot says.
const LINE_BYTES: usize = 128;
/// HELLO is repeated this often until answered \[us\].
const HELLO_PERIOD_US: u64 = 300_000;
/// An answer to HELLO comes within this time; a later HELLO is a robot that started again \[us\].
const HELLO_ANSWER_US: u64 = 1_000_000;
/// A sign of life goes out this often, a third of the 500 ms after which the robot stops \[us\].
const HEARTBEAT_PERIOD_US: u64 = 150_000;
/// The original program is silent for up to 4 s while it drives \[us\].
const TEXT_SILENCE_US: u64 = 6_000_000;
/// The link counts as lost after this long without a frame: 25 telemetry frames \[us\].
const SILENCE_US: u64 = 1_000_000;

/// Speaks with one robot.
#[derive(Debug)]
pub struct RobotClient {
    table: KnownTable,
    clock: RobotClock,
    decoder: Decoder<LINE_BYTES>,
    /// What is heard and said in text.
    terminal: Terminal,
    /// The robot speaks text.
    text: bool,
    /// It may turn out to speak the other language.
    undecided: bool,
    /// HELLOs since the robot last answered one, or was last lost.
    hellos: u32,
    /// Bytes heard at this port.
    heard_bytes: u64,
    /// Words of the other language heard in a row.
    words: u32,
    /// Columns of the row heard last.
    row_kind: Option<RowKind>,
    manager: CommandManager,
    sequence: u8,
    hello: Option<Hello>,
    connected: bool,
    hello_sent_us: Option<u64>,
    last_sent_us: Option<u64>,
    last_heard_us: u64,
    mode: ModeId,
    reference: Wheels<f32>,
    heading_ref_rad: f32,
    malformed: u32,
    /// Errors before the first good frame, one at most: who begins to listen in the middle of a frame cannot read its rest.
    cut_off: Option<u16>,
    up: Meter,
    down: Meter,
    frames: Meter,
}

impl RobotClient {
    /// A client for a robot not heard yet. `session` is to be random. `clock_known`: the robot's clock started with the session's.
    pub fn new(session: u8, clock_known: bool, table: KnownTable) -> Self {
        let clock = if clock_known {
            RobotClock::STARTED_WITH_SESSION
        } else {
            RobotClock::UNKNOWN
        };
        Self {
            table,
            clock,
            decoder: Decoder::default(),
            terminal: Terminal::new(),
            text: false,
            undecided: true,
            hellos: 0,
            heard_bytes: 0,
            words: 0,
            row_kind: None,
            manager: CommandManager::new(session),
            sequence: 0,
            hello: None,
            connected: false,
            hello_sent_us: None,
            last_sent_us: None,
            last_heard_us: 0,
            mode: ModeId::default(),
            reference: Wheels::both(0.0),
            heading_ref_rad: 0.0,
            malformed: 0,
            cut_off: None,
            up: Meter::default(),
            down: Meter::default(),
            frames: Meter::default(),
        }
    }

    /// A client for a robot that speaks the original's text and is in this mode: it needs no greeting.
    pub fn of_text(mode: ModeId, clock_known: bool) -> Self {
        Self {
            text: true,
            undecided: false,
            connected: true,
            mode,
            ..Self::new(0, clock_known, KnownTable::OURS)
        }
    }

    /// Takes a command from the operator.
    ///
    /// # Errors
    /// [`QueueFull`]; never for STOP.
    pub fn submit(&mut self, command: Command, now_us: u64) -> Result<(), QueueFull> {
        self.manager.submit(command, now_us)
    }

    /// Appends the bytes to be sent now. To be called after every step of time.
    pub fn poll(&mut self, now_us: u64, to_robot: &mut Vec<u8>, heard: &mut Vec<Heard>) {
        let before = to_robot.len();
        self.terminal.poll(to_robot);
        self.up.add(to_robot.len() - before, now_us);
        if self.text {
            let quiet_us = now_us.saturating_sub(self.last_heard_us);
            if self.undecided
                && self.connected
                && self.terminal.armed()
                && quiet_us > TEXT_SILENCE_US
            {
                self.connected = false;
                heard.push(Heard::Lost);
            }
            return;
        }
        if self.connected && now_us.saturating_sub(self.last_heard_us) > SILENCE_US {
            self.connected = false;
            self.hello_sent_us = None;
            (self.hellos, self.words) = (0, 0);
            heard.push(Heard::Lost);
        }
        let hello_due = self
            .hello_sent_us
            .is_none_or(|sent_us| now_us >= sent_us + HELLO_PERIOD_US);
        if !self.connected && hello_due {
            self.hello_sent_us = Some(now_us);
            self.hellos = self.hellos.saturating_add(1);
            self.say(ToRobot::Hello, now_us, to_robot);
        }
        if let Some(command) = self.manager.poll(now_us) {
            self.say(command, now_us, to_robot);
        }
        if self
            .last_sent_us
            .is_none_or(|sent_us| now_us >= sent_us + HEARTBEAT_PERIOD_US)
        {
            self.say(ToRobot::Heartbeat, now_us, to_robot);
        }
        self.report_outcomes(heard);
    }

    fn say(&mut self, message: ToRobot, now_us: u64, to_robot: &mut Vec<u8>) {
        let frame = message.frame(self.sequence);
        self.sequence = self.sequence.wrapping_add(1);
        self.last_sent_us = Some(now_us);
        self.terminal.frames_sent();
        self.up.add(frame.bytes().len(), now_us);
        to_robot.extend_from_slice(frame.bytes());
    }

    /// Notes that somebody else sent bytes to the robot.
    pub(crate) fn said(&mut self, bytes: usize, now_us: u64) {
        self.up.add(bytes, now_us);
    }

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
        match message {
            FromRobot::Hello(hello) => self.greet(hello, now_us, heard),
            FromRobot::Telemetry(telemetry) => {
                let t_ms = self.clock.session_ms(telemetry.t_ms, now_ms, way_ms);
                heard.push(Heard::Telemetry(t_ms, telemetry));
            }
            FromRobot::Status(status) => {
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
            FromRobot::Ack(ack) => self.acknowledge(&ack, now_us),
            FromRobot::HeadingRef(heading_rad) => self.heading_ref_rad = heading_rad,
        }
    }

    fn greet(&mut self, hello: Hello, now_us: u64, heard: &mut Vec<Heard>) {
        let answer = self
            .hello_sent_us
            .is_some_and(|sent_us| now_us < sent_us + HELLO_ANSWER_US);
        (self.hellos, self.words) = (0, 0);
        let known = self.hello.replace(hello).is_some();
        if known && !answer {
            self.manager.robot_restarted();
            self.clock = RobotClock::UNKNOWN;
            heard.push(Heard::Restarted(hello));
        } else if !self.connected {
            heard.push(Heard::Connected(hello));
        } else {
            return;
        }
        self.connected = true;
        self.read_parameters();
    }

    /// Asks for the value of every parameter, if the robot's table is the one known here.
    pub fn read_parameters(&mut self) {
        if self.table_matches() {
            (0..self.table.len)
                .for_each(|id| self.manager.submit_background(Command::GetParam { id }));
            self.read_own_first();
        }
    }

    /// The parameters of the robot's mode are read first, then those of all modes: they are what people look at.
    fn read_own_first(&mut self) {
        let mode = self.mode;
        self.manager.read_first(|command| {
            let Command::GetParam { id } = command else {
                return 0;
            };
            match ParamId::from_number(*id).and_then(ParamId::mode) {
                Some(own) if own == mode => 1,
                None => 2,
                Some(_) => 3,
            }
        });
    }

    /// The robot is in this mode.
    fn enter(&mut self, mode: ModeId) {
        if self.mode != mode {
            self.mode = mode;
            self.read_own_first();
        }
    }

    fn acknowledge(&mut self, ack: &Ack, now_us: u64) {
        self.manager.acknowledge(ack, now_us);
    }

    fn report_outcomes(&mut self, heard: &mut Vec<Heard>) {
        for outcome in self.manager.take_outcomes() {
            // The acknowledgement knows before the next status does.
            if let Fate::Applied(value) = outcome.fate {
                match outcome.command {
                    Command::Reference(_) => self.reference = Wheels::both(value),
                    Command::WheelReference(wheels) => self.reference = wheels,
                    Command::Goal { x_m, y_m } if self.mode == ModeId::Mission => {
                        self.reference = Wheels {
                            left: x_m,
                            right: y_m,
                        };
                    }
                    Command::Mode(mode) => self.enter(mode),
                    _ => {}
                }
            }
            heard.push(Heard::Ended(outcome));
        }
    }

    /// The robot is heard.
    pub fn connected(&self) -> bool {
        self.connected
    }

    /// Who the robot says it is.
    pub fn hello(&self) -> Option<Hello> {
        self.hello
    }

    /// The robot has the parameter table known here, and speaks this protocol.
    pub fn table_matches(&self) -> bool {
        self.hello.is_some_and(|hello| {
            hello.schema == self.table.schema && hello.protocol == PROTOCOL_VERSION
        })
    }

    /// The mode last reported.
    pub fn mode(&self) -> ModeId {
        self.mode
    }

    /// The mode's reference last reported; units as in [`Status::reference`].
    pub fn reference(&self) -> Wheels<f32> {
        self.reference
    }

    /// The heading that the mode wants, last reported [rad]; 0 where it wants none.
    pub fn heading_ref_rad(&self) -> f32 {
        self.heading_ref_rad
    }

    /// Load and quality of the link.
    pub fn link(&mut self, now_us: u64) -> LinkFigures {
        LinkFigures {
            up_bytes_s: self.up.per_second(now_us),
            down_bytes_s: self.down.per_second(now_us),
            telemetry_hz: self.frames.per_second(now_us),
            heard_bytes: self.heard_bytes,
            crc_errors: self
                .decoder
                .crc_errors()
                .wrapping_sub(self.cut_off.unwrap_or(0)),
            frames_lost: self.decoder.frames_lost(),
            malformed: self.malformed,
            round_trip_us: self.manager.round_trip_us(),
            unacknowledged: self.manager.unacknowledged(),
            clock_offset_ms: self.clock.offset_ms(),
            clock_fast_ppm: self.clock.fast_ppm((now_us / 1_000) as i64),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_joins_in_the_middle_of_a_frame_sees_no_error_and_each_damaged_frame_after() {
        let mut client = RobotClient::new(7, false, KnownTable::OURS);
        let (mut heard, mut now_us) = (Vec::new(), 0);
        let mut hear = |client: &mut RobotClient, bytes: &[u8]| {
            now_us += 40_000;
            client.hear(bytes, now_us, &mut heard);
            client.link(now_us).crc_errors
        };
        let frame = |sequence| FromRobot::HeadingRef(0.5).frame(sequence).bytes().to_vec();
        assert_eq!(hear(&mut client, &frame(0)[2..]), 1);
        assert_eq!(hear(&mut client, &frame(1)), 0);
        let mut damaged = frame(2);
        damaged[2] ^= 0x10;
        assert_eq!(hear(&mut client, &damaged), 1);
    }
}
