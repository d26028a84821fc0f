//! Sends a scenario's commands at their times, as a person at the dashboard would: over the link, one at a time,
//! repeated until they are acknowledged, with a heartbeat in between.

use crate::files::{Program, Setup, TimedCommand};
use crate::sim::Sim;
use crate::trace::Heard;
use rumbo_control::mode::ModeId;
use rumbo_wire::{Command, Decoder, EventKind, FromRobot, Message, Received, ToRobot};

/// Time between heartbeats [us].
const HEARTBEAT_US: u64 = 100_000;
/// Time after which an unanswered command is repeated [us].
const REPEAT_US: u64 = 200_000;
/// Longest line of the original's telemetry.
const LINE: usize = 160;

/// The sending side of a run.
pub(crate) struct Operator<'a> {
    commands: &'a [TimedCommand],
    /// Commands go to the report's program, not over the link.
    direct: bool,
    mode: Option<ModeId>,
    next: usize,
    number: u16,
    seq: u8,
    /// The command that waits for its acknowledgement, and when it was last sent.
    pending: Option<(Command, u64)>,
    heartbeat_due_us: u64,
    /// The robot has said that it reached its goal since the last command was sent.
    reached: bool,
    decoder: Decoder<LINE>,
    buffer: Vec<u8>,
    /// What the robot refused or reported.
    pub(crate) complaints: Vec<String>,
    /// Telemetry and events received.
    pub(crate) heard: Vec<Heard>,
}

impl<'a> Operator<'a> {
    pub(crate) fn new(setup: &'a Setup) -> Self {
        Self {
            commands: &setup.scenario.commands,
            direct: setup.program == Program::Original,
            mode: Some(setup.scenario.mode),
            next: 0,
            number: 0,
            seq: 0,
            pending: None,
            heartbeat_due_us: 0,
            reached: false,
            decoder: Decoder::default(),
            buffer: Vec::new(),
            complaints: Vec::new(),
            heard: Vec::new(),
        }
    }

    /// Listens, then says what is due.
    pub(crate) fn step(&mut self, sim: &mut Sim) {
        let now_us = sim.now_us();
        if self.direct {
            return self.order(sim);
        }
        self.listen(sim);
        if now_us >= self.heartbeat_due_us {
            self.say(sim, &ToRobot::Heartbeat);
            self.heartbeat_due_us = now_us + HEARTBEAT_US;
        }
        if let Some((command, sent_us)) = self.pending {
            if now_us >= sent_us + REPEAT_US {
                self.send(sim, command);
            }
            return;
        }
        let command = match self.mode.take() {
            Some(mode) => Command::Mode(mode),
            None => match self.due(now_us) {
                Some(command) => command,
                None => return,
            },
        };
        self.number = self.number.wrapping_add(1);
        self.send(sim, command);
    }

    /// The next command of the scenario, if it is time for it.
    fn due(&mut self, now_us: u64) -> Option<Command> {
        let timed = self.commands.get(self.next)?;
        let soon = timed.after_reached && self.reached;
        if timed.at_s * 1e6 > now_us as f64 && !soon {
            return None;
        }
        self.next += 1;
        self.reached = false;
        Some(timed.command)
    }

    /// The same with the report's program, which has no link of ours.
    fn order(&mut self, sim: &mut Sim) {
        let t_s = sim.now_us() as f64 * 1e-6;
        let told = sim.told();
        self.reached |= told.iter().any(has_reached);
        self.heard
            .extend(told.into_iter().map(|what| Heard { t_s, what }));
        while let Some(command) = self.due(sim.now_us()) {
            sim.order(command);
        }
    }

    fn send(&mut self, sim: &mut Sim, command: Command) {
        let message = ToRobot::Command {
            session: 1,
            number: self.number,
            command,
        };
        self.say(sim, &message);
        self.pending = Some((command, sim.now_us()));
    }

    fn say(&mut self, sim: &mut Sim, message: &ToRobot) {
        sim.send(message.frame(self.seq).bytes());
        self.seq = self.seq.wrapping_add(1);
    }

    fn listen(&mut self, sim: &mut Sim) {
        let mut buffer = std::mem::take(&mut self.buffer);
        buffer.clear();
        sim.receive(&mut buffer);
        for byte in &buffer {
            let Some(Received::Frame(body)) = self.decoder.push(*byte) else {
                continue;
            };
            let message = FromRobot::from_body(&body);
            if let Ok(what @ (FromRobot::Telemetry(_) | FromRobot::Event(_))) = message {
                let t_s = sim.now_us() as f64 * 1e-6;
                self.reached |= has_reached(&what);
                self.heard.push(Heard { t_s, what });
            }
            match message {
                Ok(FromRobot::Ack(ack)) if ack.number == self.number => {
                    if let (Some((command, _)), Err(refusal)) = (self.pending.take(), ack.result) {
                        let now_s = sim.now_us() as f64 * 1e-6;
                        let why = refusal.explanation();
                        self.complaints
                            .push(format!("at {now_s:.2} s {command:?} was refused: {why}"));
                    }
                }
                Ok(FromRobot::Event(event)) => {
                    if let EventKind::Faulted(fault) = event.kind {
                        let now_s = sim.now_us() as f64 * 1e-6;
                        self.complaints
                            .push(format!("at {now_s:.2} s fault: {}", fault.explanation()));
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
