//! Sends a scenario's commands at their times, as a person at the dashboard would: over the link, in the language of the
//! program at its other end.
//!
//! | program | language |
//! |---|---|
//! | ours, or an image with its frames | one command at a time, repeated until it is acknowledged, with heartbeats |
//! | any other image | lines of the original's text: [`text`] |
//! | the report's, native | handed over directly |
//!
//! Lines that are typed ([`Setup::texts`]) go out as they are, whatever the language.

mod goal;
mod text;

use crate::files::{FileError, Setup, TypedPort};
use crate::note::Note;
use rumbo_control::mode::ModeId;
use rumbo_sim::Sim;
use rumbo_sim::mega::{PARTS, USB};
use rumbo_sim::trace::TimedMessage;
use rumbo_wire::text::TextCommand;
use rumbo_wire::{
    Command, Decoder, EventKind, FrameMessage, FromRobot, Received, RobotTime, ToRobot,
};
use std::ops::Deref;
use text::Terminal;

/// Time between heartbeats [us].
const HEARTBEAT_US: u64 = 100_000;
/// Time after which an unanswered command is repeated [us].
const REPEAT_US: u64 = 200_000;
/// Time-out of the robot's answers before its run begins [us].
const PATIENCE_US: u64 = 3_000_000;
/// Time between two polls of the link before the run [us].
const BRIEF_STEP_US: u64 = 10_000;
/// Longest line of the original's telemetry.
const LINE: usize = 160;

/// The language of the program at the pins.
#[derive(Clone)]
enum Speech {
    Frames,
    Text(Box<Terminal>),
    Direct,
}

/// The sending side of a run, with a reference to its setup of whatever kind.
#[derive(Clone)]
pub(crate) struct Operator<S> {
    setup: S,
    speech: Speech,
    mode: Option<ModeId>,
    /// The next of the scenario's commands, and of the lines of the command line.
    next: usize,
    next_text: usize,
    number: u16,
    seq: u8,
    /// The newest robot time received.
    seen: Option<RobotTime>,
    /// The command that waits for its acknowledgement, the robot time at which it was issued, and when it was last
    /// sent.
    pending: Option<(Command, RobotTime, u64)>,
    heartbeat_due_us: u64,
    /// The robot has reported its goal as reached since the last command was sent.
    reached: bool,
    decoder: Decoder<LINE>,
    buffer: Vec<u8>,
    /// Refusals and faults of the robot.
    pub(crate) complaints: Vec<Note>,
    /// Notes for readers of the result.
    pub(crate) notes: Vec<Note>,
    /// Telemetry, status, events and heading references received.
    pub(crate) received: Vec<TimedMessage>,
}

impl<S: Deref<Target = Setup>> Operator<S> {
    pub(crate) fn new(setup: S) -> Self {
        let speech = if setup.takes_parameters() {
            Speech::Frames
        } else if setup.firmware.is_some() {
            Speech::Text(Box::new(Terminal::new(&setup)))
        } else {
            Speech::Direct
        };
        Self {
            speech,
            mode: Some(setup.scenario.mode),
            setup,
            next: 0,
            next_text: 0,
            number: 0,
            seq: 0,
            seen: None,
            pending: None,
            heartbeat_due_us: 0,
            reached: false,
            decoder: Decoder::default(),
            buffer: Vec::new(),
            complaints: Vec::new(),
            notes: Vec::new(),
            received: Vec::new(),
        }
    }

    /// What it was made with.
    pub(crate) fn setup(&self) -> &Setup {
        &self.setup
    }

    /// Sends the parameters to an image that uses our frames. The clock of the run begins after that, since the native
    /// robot has them from the start.
    ///
    /// # Errors
    /// It does not answer.
    pub(crate) fn brief(&mut self, sim: &mut Sim) -> Result<(), FileError> {
        let (Some(firmware), Speech::Frames) = (self.setup.firmware.clone(), &self.speech) else {
            return Ok(());
        };
        let mute = || {
            FileError::Setting(format!(
                "firmware {}: does not acknowledge commands on the link of wiring {}; choose another wiring",
                firmware.name(),
                firmware.wiring()
            ))
        };
        self.listen_until(sim, mute, |operator| operator.seen.is_some())?;
        for (id, value) in self.setup.control_parameters()? {
            let id = id as u8;
            self.give(sim, Command::SetParam { id, value });
            self.listen_until(sim, mute, |operator| operator.pending.is_none())?;
        }
        sim.restart_clock();
        self.received.clear();
        self.heartbeat_due_us = 0;
        Ok(())
    }

    /// Advances time before the run until the robot has sent the awaited message.
    fn listen_until(
        &mut self,
        sim: &mut Sim,
        mute: impl Fn() -> FileError,
        done: impl Fn(&Self) -> bool,
    ) -> Result<(), FileError> {
        let since_us = sim.now_us();
        while !done(self) {
            sim.advance(sim.now_us() + BRIEF_STEP_US);
            self.receive(sim);
            if let Some(verdict) = sim.verdict() {
                return Err(FileError::Setting(verdict));
            }
            if sim.now_us() >= since_us + PATIENCE_US {
                return Err(mute());
            }
            self.repeat(sim);
        }
        Ok(())
    }

    /// Receives, then sends what is due.
    pub(crate) fn step(&mut self, sim: &mut Sim) {
        let now_us = sim.now_us();
        self.type_texts(sim);
        match &mut self.speech {
            Speech::Direct => return self.order(sim),
            Speech::Text(_) => return self.write(sim),
            Speech::Frames => {}
        }
        self.receive(sim);
        if now_us >= self.heartbeat_due_us {
            self.transmit(sim, &ToRobot::Heartbeat);
            self.heartbeat_due_us = now_us + HEARTBEAT_US;
        }
        if self.pending.is_some() {
            return self.repeat(sim);
        }
        // A command carries the robot's time.
        if self.seen.is_none() {
            return;
        }
        let command = match self.mode.take() {
            Some(mode) => Command::Mode(mode),
            None => match self.due(now_us) {
                Some(command) => command,
                None => return,
            },
        };
        self.give(sim, command);
    }

    /// Issues the next command.
    fn give(&mut self, sim: &mut Sim, command: Command) {
        self.number = self.number.wrapping_add(1);
        self.send(sim, command, self.seen.unwrap_or_default());
    }

    fn repeat(&mut self, sim: &mut Sim) {
        if let Some((command, seen, sent_us)) = self.pending
            && sim.now_us() >= sent_us + REPEAT_US
        {
            self.send(sim, command, seen);
        }
    }

    /// Sends the typed lines that are due.
    fn type_texts(&mut self, sim: &mut Sim) {
        while let Some(timed) = self.setup.texts.get(self.next_text)
            && timed.at_s * 1e6 <= sim.now_us() as f64
        {
            self.next_text += 1;
            let to = match timed.port {
                TypedPort::Hand => {
                    if !crate::hand::act(sim, timed.text.as_bytes()) {
                        let odd = "the hand finds no room there, and leaves everything as it is";
                        let odd = format!("at {} s `{}`: {odd}", timed.at_s, timed.text);
                        self.notes.push(odd.into());
                    }
                    continue;
                }
                TypedPort::Link => None,
                TypedPort::Usb => Some(USB),
                TypedPort::Parts => Some(PARTS),
            };
            if let (Some(to), Some(mega)) = (to, sim.mega_mut()) {
                mega.type_in(to, &timed.bytes());
                continue;
            }
            // An image may have commands of its own.
            let odd = match (timed.port, TextCommand::parse(&timed.text)) {
                (TypedPort::Usb | TypedPort::Parts, _) => {
                    Some("without a sketch or an image there is no USB port".into())
                }
                (TypedPort::Link, Err(error)) if self.setup.firmware.is_none() => {
                    Some(error.to_string())
                }
                (TypedPort::Link | TypedPort::Hand, _) => None,
            };
            let odd = odd.map(|odd: String| format!("at {} s `{}`: {odd}", timed.at_s, timed.text));
            self.notes.extend(odd.map(Note::from));
            if timed.port == TypedPort::Link {
                sim.send(&timed.bytes());
            }
        }
    }

    /// The same with an image that reads lines.
    fn write(&mut self, sim: &mut Sim) {
        self.buffer.clear();
        sim.receive(&mut self.buffer);
        let Speech::Text(terminal) = &mut self.speech else {
            return;
        };
        terminal.read(&self.buffer, sim.now_us(), &mut self.received);
        self.reached |= terminal.watch(sim, &mut self.received);
        while let Some(command) = self.due(sim.now_us()) {
            if let Speech::Text(terminal) = &mut self.speech {
                self.notes
                    .extend(terminal.write(sim, command).map(Note::from));
            }
        }
    }

    /// The next command of the scenario, if it is time for it.
    fn due(&mut self, now_us: u64) -> Option<Command> {
        let timed = self.setup.scenario.commands.get(self.next)?;
        let soon = timed.after_reached && self.reached;
        if timed.at_s * 1e6 > now_us as f64 && !soon {
            return None;
        }
        self.next += 1;
        self.reached = false;
        Some(timed.command)
    }

    /// The same with the report's native program, which has no link.
    fn order(&mut self, sim: &mut Sim) {
        let t_s = sim.now_us() as f64 * 1e-6;
        let messages = sim.drain_messages();
        self.reached |= messages.iter().any(has_reached);
        self.received
            .extend(messages.into_iter().map(|what| TimedMessage { t_s, what }));
        while let Some(command) = self.due(sim.now_us()) {
            sim.order(command);
        }
    }

    fn send(&mut self, sim: &mut Sim, command: Command, seen: RobotTime) {
        let message = ToRobot::Command {
            session: 1,
            number: self.number,
            command,
            seen,
        };
        self.transmit(sim, &message);
        self.pending = Some((command, seen, sim.now_us()));
    }

    fn transmit(&mut self, sim: &mut Sim, message: &ToRobot) {
        sim.send(message.frame(self.seq).bytes());
        self.seq = self.seq.wrapping_add(1);
    }

    fn receive(&mut self, sim: &mut Sim) {
        let mut buffer = std::mem::take(&mut self.buffer);
        buffer.clear();
        sim.receive(&mut buffer);
        for byte in &buffer {
            let Some(Received::Frame(body)) = self.decoder.push(*byte) else {
                continue;
            };
            let message = FromRobot::from_body(&body);
            if let Ok(message) = &message {
                self.seen = RobotTime::after(self.seen, message);
            }
            if let Ok(
                what @ (FromRobot::Telemetry(_)
                | FromRobot::Event(_)
                | FromRobot::Status(_)
                | FromRobot::HeadingRef(_)),
            ) = message
            {
                let t_s = sim.now_us() as f64 * 1e-6;
                self.reached |= has_reached(&what);
                self.received.push(TimedMessage { t_s, what });
            }
            match message {
                Ok(FromRobot::Ack(ack)) if ack.number == self.number => {
                    if let (Some((command, ..)), Err(refusal)) = (self.pending.take(), ack.result) {
                        self.complaints.push(Note::Refused {
                            at_s: sim.now_us() as f64 * 1e-6,
                            command: command.in_words(self.setup.scenario.mode).to_string(),
                            why: refusal,
                        });
                    }
                }
                Ok(FromRobot::Event(event)) => {
                    if let EventKind::Faulted(fault) = event.kind {
                        let at_s = sim.now_us() as f64 * 1e-6;
                        self.complaints.push(Note::Fault { at_s, fault });
                    }
                }
                Ok(_) | Err(_) => {}
            }
        }
        self.buffer = buffer;
    }
}

fn has_reached(message: &FromRobot) -> bool {
    matches!(message, FromRobot::Event(event) if event.kind == EventKind::Reached)
}
