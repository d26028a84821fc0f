//! The station's end of the link: bytes from the robot become events, commands become bytes.
//!
//! Knows the protocol and nothing of browsers, threads or wall clocks: time is an argument, in the target's time. It
//! asks for HELLO until the robot answers, then reads the parameters, sends heartbeats, and detects silence and
//! restarts. It never arms, and accepts no order while no robot is connected. A robot that leaves HELLO unanswered and
//! sends rows of the original's text is addressed in text.

mod events;
mod handshake;
mod receiving;
mod text;

pub use events::{KnownTable, LinkEvent, LinkFigures, NotTaken};

use crate::anomaly::{Anomaly, AnomalyDetector};
use crate::commands::{CommandManager, Fate};
use crate::meter::Meter;
use crate::robot_clock::RobotClock;
use crate::terminal::Terminal;
use handshake::Handshake;
use rumbo_control::Velocity;
use rumbo_control::mode::{ModeId, Reference};
use rumbo_control::params::ParamId;
use rumbo_wire::text::RowKind;
use rumbo_wire::{Command, Decoder, FrameMessage, Hello, PROTOCOL_VERSION, ToRobot};

/// Room for a line of the original's text, the longest thing a robot says.
const LINE_BYTES: usize = 128;
/// HELLO is repeated this often until answered \[us\].
const HELLO_PERIOD_US: u64 = 300_000;
/// A sign of life goes out this often, a third of the 500 ms after which the robot stops \[us\].
const HEARTBEAT_PERIOD_US: u64 = 150_000;
/// The original program is silent for up to 4 s while it drives \[us\].
const TEXT_SILENCE_US: u64 = 6_000_000;
/// The link counts as lost after this long without a frame: 25 telemetry frames \[us\].
const SILENCE_US: u64 = 1_000_000;
/// STOP that is not confirmed for this long is an alarm \[us\].
const STOP_PATIENCE_US: u64 = 1_000_000;
/// The alarm is repeated this often \[us\].
const STOP_AGAIN_US: u64 = 10_000_000;

/// The connection to one robot.
#[derive(Debug)]
pub struct RobotClient {
    table: KnownTable,
    clock: RobotClock,
    decoder: Decoder<LINE_BYTES>,
    /// The text protocol.
    terminal: Terminal,
    /// The robot speaks text.
    text: bool,
    /// It may turn out to speak the other protocol.
    undecided: bool,
    /// HELLOs since the robot last answered one, or was last lost.
    hellos: u32,
    /// Bytes received at this port.
    received_bytes: u64,
    unread_bytes: u64,
    /// Consecutive rows or frames of the other protocol.
    words: u32,
    /// Columns of the last row.
    row_kind: Option<RowKind>,
    manager: CommandManager,
    sequence: u8,
    handshake: Handshake,
    anomalies: AnomalyDetector,
    connected: bool,
    /// The robot has acknowledged STOP, and not said since that it is disarmed; since when it has said that it is
    /// armed \[us\].
    stopping: bool,
    still_armed_us: Option<u64>,
    /// When it was last reported that STOP is not confirmed.
    stop_reported_us: Option<u64>,
    hello_sent_us: Option<u64>,
    last_sent_us: Option<u64>,
    last_received_us: u64,
    mode: ModeId,
    reference: Reference,
    heading_ref_rad: f32,
    malformed: u32,
    /// Errors before the first good frame, at most one: a receiver that joins within a frame cannot read its rest.
    cut_off: Option<u16>,
    up: Meter,
    down: Meter,
    frames: Meter,
}

impl RobotClient {
    /// A client for a robot not connected yet. `session` is to be random. `clock_known`: the robot's clock started with
    /// the session's.
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
            received_bytes: 0,
            unread_bytes: 0,
            words: 0,
            row_kind: None,
            manager: CommandManager::new(session),
            sequence: 0,
            handshake: Handshake::default(),
            anomalies: AnomalyDetector::default(),
            connected: false,
            stopping: false,
            still_armed_us: None,
            stop_reported_us: None,
            hello_sent_us: None,
            last_sent_us: None,
            last_received_us: 0,
            mode: ModeId::default(),
            reference: Reference::None,
            heading_ref_rad: 0.0,
            malformed: 0,
            cut_off: None,
            up: Meter::default(),
            down: Meter::default(),
            frames: Meter::default(),
        }
    }

    /// A client for a robot that speaks the original's text and is in this mode: it needs no greeting. `clock_known`:
    /// as above; such a robot counts as connected at once, any other with its first row.
    pub fn of_text(mode: ModeId, clock_known: bool) -> Self {
        Self {
            text: true,
            undecided: false,
            connected: clock_known,
            mode,
            ..Self::new(0, clock_known, KnownTable::OURS)
        }
    }

    /// Takes a command from the operator.
    ///
    /// # Errors
    /// [`NotTaken`]; never for STOP.
    pub fn submit(&mut self, command: Command, now_us: u64) -> Result<(), NotTaken> {
        if !self.connected && command != Command::Stop {
            return Err(NotTaken::NotConnected);
        }
        if command == Command::Arm {
            (self.stopping, self.still_armed_us) = (false, None);
        }
        let seen = self.handshake.newest();
        let taken = self.manager.submit(command, seen, now_us);
        taken.map_err(|_| NotTaken::QueueFull)
    }

    /// Takes commands that belong together, such as a route. Each expires by the time since its turn.
    ///
    /// # Errors
    /// [`NotTaken`].
    pub fn submit_in_turn(
        &mut self,
        commands: impl IntoIterator<Item = Command>,
    ) -> Result<(), NotTaken> {
        if !self.connected {
            return Err(NotTaken::NotConnected);
        }
        self.manager.submit_in_turn(commands);
        Ok(())
    }

    /// Takes a velocity for mode 10; an earlier one that has not left yet is dropped.
    ///
    /// # Errors
    /// [`NotTaken::NotConnected`].
    pub fn submit_velocity(&mut self, velocity: Velocity) -> Result<(), NotTaken> {
        if !self.connected {
            return Err(NotTaken::NotConnected);
        }
        self.manager
            .submit_velocity(velocity, self.handshake.newest());
        Ok(())
    }

    /// Appends the bytes to be sent now. To be called after every step of time.
    pub fn poll(&mut self, now_us: u64, to_robot: &mut Vec<u8>, events: &mut Vec<LinkEvent>) {
        let before = to_robot.len();
        self.terminal.poll(to_robot);
        self.up.add(to_robot.len() - before, now_us);
        if self.text {
            let quiet_us = now_us.saturating_sub(self.last_received_us);
            if self.undecided
                && self.connected
                && self.terminal.armed()
                && quiet_us > TEXT_SILENCE_US
            {
                self.connected = false;
                events.push(LinkEvent::Lost);
            }
            return;
        }
        if self.connected && now_us.saturating_sub(self.last_received_us) > SILENCE_US {
            self.lose();
            events.push(LinkEvent::Lost);
        }
        let hello_due = self
            .hello_sent_us
            .is_none_or(|sent_us| now_us >= sent_us + HELLO_PERIOD_US);
        if !self.connected && hello_due {
            self.hello_sent_us = Some(now_us);
            self.hellos = self.hellos.saturating_add(1);
            self.say(ToRobot::Hello, now_us, to_robot);
        }
        // Reads included: their answers would be taken for the previous robot's.
        let stops = self.manager.stop_since_us().is_some();
        if (self.connected || stops)
            && let Some(command) = self.manager.poll(self.handshake.newest(), now_us)
        {
            self.say(command, now_us, to_robot);
        }
        if let Some(velocity) = self.manager.poll_velocity(now_us) {
            self.say(velocity, now_us, to_robot);
        }
        self.watch_stop(now_us, events);
        if self
            .last_sent_us
            .is_none_or(|sent_us| now_us >= sent_us + HEARTBEAT_PERIOD_US)
        {
            self.say(ToRobot::Heartbeat, now_us, to_robot);
        }
        self.report_outcomes(events);
    }

    /// STOP that is not confirmed is reported, and again from time to time.
    fn watch_stop(&mut self, now_us: u64, events: &mut Vec<LinkEvent>) {
        if !self.stop_unconfirmed(now_us) {
            self.stop_reported_us = None;
        } else if self
            .stop_reported_us
            .is_none_or(|at_us| now_us >= at_us + STOP_AGAIN_US)
        {
            self.stop_reported_us = Some(now_us);
            events.push(LinkEvent::StopUnconfirmed);
        }
    }

    /// STOP was sent, and the robot has not acknowledged it in time, or says since that it is armed.
    pub fn stop_unconfirmed(&self, now_us: u64) -> bool {
        let since_us = self.manager.stop_since_us().or(self.still_armed_us);
        since_us.is_some_and(|since_us| now_us >= since_us + STOP_PATIENCE_US)
    }

    /// The anomalies seen recently.
    pub fn anomalies(&self, now_us: u64) -> impl Iterator<Item = Anomaly> {
        self.anomalies.present(now_us)
    }

    fn say(&mut self, message: ToRobot, now_us: u64, to_robot: &mut Vec<u8>) {
        let frame = message.frame(self.sequence);
        self.sequence = self.sequence.wrapping_add(1);
        self.last_sent_us = Some(now_us);
        self.terminal.frames_sent();
        self.up.add(frame.bytes().len(), now_us);
        to_robot.extend_from_slice(frame.bytes());
    }

    /// Counts bytes that another sender sent to the robot.
    pub(crate) fn said(&mut self, bytes: usize, now_us: u64) {
        self.up.add(bytes, now_us);
    }

    /// Asks for the value of every parameter, if the robot's table is the one known here.
    pub fn read_parameters(&mut self) {
        if self.table_matches() {
            (0..self.table.len)
                .for_each(|id| self.manager.submit_background(Command::GetParam { id }));
            self.read_own_first();
        }
    }

    /// Reads the parameters of the robot's mode first, group by group, then those of the robot: people look at these.
    fn read_own_first(&mut self) {
        let mode = self.mode;
        self.manager.read_first(|command| {
            let Command::GetParam { id } = command else {
                return 0;
            };
            let Some(id) = ParamId::from_number(*id) else {
                return 0;
            };
            let mut groups = mode.description().parameters.iter();
            // In the order of its groups.
            match groups.position(|group| group.parameters.contains(&id)) {
                Some(group) => 1 + group as u8,
                None if id.modes().next().is_none() => u8::MAX - 1,
                None => u8::MAX,
            }
        });
    }

    fn report_outcomes(&mut self, events: &mut Vec<LinkEvent>) {
        for outcome in self.manager.take_outcomes() {
            // The acknowledgement arrives before the next status.
            if let Fate::Applied(value) = outcome.fate {
                match outcome.command {
                    Command::Reference(_) => {
                        let kind = self.mode.reference_kind();
                        self.reference = Reference::new(kind, [value; 2]);
                    }
                    Command::WheelReference(wheels) => self.reference = Reference::Wheels(wheels),
                    Command::Goal { x_m, y_m }
                        if matches!(self.mode, ModeId::Mission | ModeId::Policy) =>
                    {
                        self.reference = Reference::Goal { x_m, y_m };
                    }
                    Command::Mode(mode) => self.enter(mode),
                    _ => {}
                }
            }
            events.push(LinkEvent::Ended(outcome));
        }
    }

    /// The robot is connected.
    pub fn connected(&self) -> bool {
        self.connected
    }

    /// The robot's HELLO.
    pub fn hello(&self) -> Option<Hello> {
        self.handshake.hello()
    }

    /// The robot's protocol version, if it differs from ours.
    pub fn other_protocol(&self) -> Option<u8> {
        let protocol = self.hello()?.protocol;
        (protocol != PROTOCOL_VERSION).then_some(protocol)
    }

    /// The robot has the parameter table known here, and speaks this protocol.
    pub fn table_matches(&self) -> bool {
        self.hello().is_some_and(|hello| {
            hello.schema == self.table.schema && hello.protocol == PROTOCOL_VERSION
        })
    }

    /// The mode last reported.
    pub fn mode(&self) -> ModeId {
        self.mode
    }

    /// The mode's reference last reported.
    pub fn reference(&self) -> Reference {
        self.reference
    }

    /// The heading setpoint last reported [rad]; 0 where the mode has none.
    pub fn heading_ref_rad(&self) -> f32 {
        self.heading_ref_rad
    }

    /// Load and quality of the link.
    pub fn link(&mut self, now_us: u64) -> LinkFigures {
        LinkFigures {
            up_bytes_s: self.up.per_second(now_us),
            down_bytes_s: self.down.per_second(now_us),
            telemetry_hz: self.frames.per_second(now_us),
            received_bytes: self.received_bytes,
            unread_bytes: self.unread_bytes,
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
    use crate::watch::LinkWatch;
    use rumbo_wire::FromRobot;

    #[test]
    fn a_client_that_joins_in_the_middle_of_a_frame_counts_no_error_but_each_damaged_frame_after() {
        let mut client = RobotClient::new(7, false, KnownTable::OURS);
        let (mut events, mut now_us) = (Vec::new(), 0);
        let mut receive = |client: &mut RobotClient, bytes: &[u8]| {
            now_us += 40_000;
            client.receive(bytes, now_us, &mut events);
            client.link(now_us).crc_errors
        };
        let frame = |sequence| FromRobot::HeadingRef(0.5).frame(sequence).bytes().to_vec();
        assert_eq!(receive(&mut client, &frame(0)[2..]), 1);
        assert_eq!(receive(&mut client, &frame(1)), 0);
        let mut damaged = frame(2);
        damaged[2] ^= 0x10;
        assert_eq!(receive(&mut client, &damaged), 1);
    }

    #[test]
    fn a_port_that_comes_back_in_the_middle_of_a_frame_is_not_said_to_have_another_speed() {
        let mut client = RobotClient::new(7, false, KnownTable::OURS);
        let (mut watch, mut events, mut now_us) = (LinkWatch::default(), Vec::new(), 0);
        let mut receive = |client: &mut RobotClient, bytes: &[u8]| {
            now_us += 40_000;
            client.receive(bytes, now_us, &mut events);
            let figures = client.link(now_us);
            watch.look(now_us, &figures, client.connected(), 0, 9_600, false)
        };
        // The robot sends on until it is asked who it is.
        for _ in 0..2 {
            let frame = |sequence| FromRobot::HeadingRef(0.5).frame(sequence).bytes().to_vec();
            assert_eq!(receive(&mut client, &frame(0)[3..]), None);
            for sequence in 1..60 {
                assert_eq!(receive(&mut client, &frame(sequence)), None);
            }
            client.port_is_gone();
        }
        // Bytes of another speed are no frames.
        let said = (0..30).find_map(|number| receive(&mut client, &[0x9c ^ number; 8]));
        assert!(said.is_some_and(|said| said.contains("9600 baud")));
    }
}
