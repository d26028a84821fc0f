//! The log of a headless run, written when the run is over: the link's bytes take the same path as in a live session.

use crate::client::{KnownTable, LinkEvent, RobotClient};
use crate::event::Event;
use crate::observer::Observer;
use crate::observer::describe::{Around, describe};
use crate::target::Shown;
use rumbo_control::mode::{ModeId, ReferenceKind};
use rumbo_control::params::Params;
use rumbo_log::{Burst, Entry, Level, LogWriter, Manifest, Outcome, Said, Scene, Truth};
use rumbo_wire::{Ack, Command, Decoder, FrameMessage, FromRobot, Received, ToRobot};
use std::io::{self, Write};

/// The state is noted this often \[us\].
const STATE_PERIOD_US: u64 = 200_000;
/// Longest line of text that the decoder must skip.
const LINE: usize = 160;

/// The records of a run.
#[derive(Debug, Default)]
pub struct RunRecords<'a> {
    /// What surrounds the robot.
    pub scene: Option<Scene>,
    /// The robot's parameters at the start; `None` if it has no table of them.
    pub parameters: Option<Params>,
    /// A goal that the robot's own mode does not know, as seen from its start: ahead, left \[m\].
    pub goal_m: Option<[f32; 2]>,
    /// Ground truth with its time \[us\], in order.
    pub truths: &'a [(u64, Truth)],
    /// What crossed the link, in order.
    pub link: &'a [Burst],
    /// What crossed the USARTs of an emulated chip, in order.
    pub said: &'a [Said],
    /// What was shown of it beside its telemetry, with its time \[us\], in order.
    pub shown: &'a [(u64, Shown)],
    /// Messages of a program that does not use our link, with their time \[us\], in order.
    pub messages: &'a [(u64, FromRobot)],
    /// How it ended, if it was judged.
    pub outcome: Option<Outcome>,
}

/// Writes the log of a run.
///
/// # Errors
/// If it cannot be written.
pub fn record_run<W: Write>(into: W, manifest: &Manifest, run: RunRecords<'_>) -> io::Result<W> {
    let mut log = LogWriter::new(into, manifest)?;
    let baud = manifest.baud;
    let mut recorder = RunRecorder {
        observer: Observer::new(),
        client: RobotClient::new(0, true, KnownTable::OURS),
        link_events: Vec::new(),
        decoder: Decoder::default(),
        answers: Decoder::default(),
        sent: None,
        baud,
        battery_v: None,
        goal_m: run.goal_m,
    };
    recorder.observer.show_scene(run.scene.clone());
    if let Some(parameters) = run.parameters {
        recorder.observer.know_parameters(&parameters);
    }
    let (mut link, mut messages) = (run.link.iter().peekable(), run.messages.iter().peekable());
    let (mut said, mut shown) = (run.said.iter().peekable(), run.shown.iter().peekable());
    let mut state_due_us = 0;
    for (t_us, truth) in run.truths {
        // Before what is said at its instant: a robot without a link does not wait for one.
        recorder.observer.truth(to_ms(*t_us), *truth);
        while let Some(burst) = link.next_if(|burst| burst.t_us <= *t_us) {
            recorder.burst(burst);
        }
        while let Some(said) = said.next_if(|said| said.t_us <= *t_us) {
            recorder.observer.said(said.clone());
        }
        while let Some((at_us, signals)) = shown.next_if(|(at_us, _)| at_us <= t_us) {
            recorder.observer.shown(to_ms(*at_us), [signals.clone()]);
        }
        while let Some((at_us, message)) = messages.next_if(|(at_us, _)| at_us <= t_us) {
            recorder
                .client
                .handle(*message, *at_us, &mut recorder.link_events);
            recorder.digest(*at_us);
        }
        recorder.battery_v = Some(truth.battery_v);
        recorder.observer.publish(0);
        if *t_us >= state_due_us {
            recorder.state(*t_us);
            state_due_us = *t_us + STATE_PERIOD_US;
        }
        recorder.keep(&mut log)?;
    }
    for said in said {
        recorder.observer.said(said.clone());
    }
    recorder.keep(&mut log)?;
    if let Some(outcome) = run.outcome {
        log.record(&Entry::Outcome(outcome))?;
    }
    log.finish()
}

/// Writes the log of the traffic between a robot with the original program and its terminal.
///
/// # Errors
/// If it cannot be written.
pub fn record_text<W: Write>(into: W, manifest: &Manifest, link: &[Burst]) -> io::Result<W> {
    let mut log = LogWriter::new(into, manifest)?;
    let mut observer = Observer::new();
    let mut client = RobotClient::of_text(ModeId::default(), true);
    let (mut events, mut state_due_us) = (Vec::new(), 0);
    for burst in link {
        observer.link(burst.clone());
        let t_ms = to_ms(burst.t_us);
        if burst.to_robot {
            let line = String::from_utf8_lossy(&burst.bytes);
            client.type_in(&line);
            observer.note(t_ms, Level::Info, format!("sent: {}", line.trim_end()));
        } else {
            client.receive(&burst.bytes, burst.t_us, &mut events);
            observer.digest(&mut events, &mut client, t_ms);
        }
        observer.publish(t_ms);
        if burst.t_us >= state_due_us {
            let around = Around {
                t_us: burst.t_us,
                simulated: false,
                speed: 1.0,
                achieved_speed: 1.0,
                baud: manifest.baud,
                true_battery_v: None,
            };
            observer.show_state(describe(&around, &mut client, &observer));
            state_due_us = burst.t_us + STATE_PERIOD_US;
        }
        keep(&mut observer, &mut log)?;
    }
    log.finish()
}

/// Records the observer's entries.
fn keep<W: Write>(observer: &mut Observer, log: &mut LogWriter<W>) -> io::Result<()> {
    for event in observer.take_events() {
        if let Event::Entry(entry) = event {
            log.record(&entry)?;
        }
    }
    Ok(())
}

fn to_ms(us: u64) -> i64 {
    (us / 1_000) as i64
}

/// A command in flight.
#[derive(Clone, Copy)]
struct Sent {
    session: u8,
    number: u16,
    command: Command,
}

struct RunRecorder {
    observer: Observer,
    client: RobotClient,
    link_events: Vec<LinkEvent>,
    decoder: Decoder<LINE>,
    /// The same for the other direction.
    answers: Decoder<LINE>,
    /// The command sent last: a repetition is not noted.
    sent: Option<Sent>,
    baud: u32,
    battery_v: Option<f64>,
    goal_m: Option<[f32; 2]>,
}

impl RunRecorder {
    fn keep<W: Write>(&mut self, log: &mut LogWriter<W>) -> io::Result<()> {
        keep(&mut self.observer, log)
    }

    fn burst(&mut self, burst: &Burst) {
        self.observer.link(burst.clone());
        if burst.to_robot {
            self.client.said(burst.bytes.len(), burst.t_us);
            return self.sent(burst);
        }
        self.client
            .receive(&burst.bytes, burst.t_us, &mut self.link_events);
        self.digest(burst.t_us);
        self.answered(burst);
    }

    fn digest(&mut self, t_us: u64) {
        self.observer
            .digest(&mut self.link_events, &mut self.client, to_ms(t_us));
    }

    /// Notes the commands in what was sent.
    fn sent(&mut self, burst: &Burst) {
        for byte in &burst.bytes {
            let message = match self.decoder.push(*byte) {
                Some(Received::Frame(body)) => ToRobot::from_body(&body),
                Some(Received::Line(_)) | None => continue,
            };
            let Ok(ToRobot::Command {
                session,
                number,
                command,
                ..
            }) = message
            else {
                continue;
            };
            let sent = Sent {
                session,
                number,
                command,
            };
            let before = self.sent.replace(sent);
            if before.map(|sent| (sent.session, sent.number)) != Some((session, number)) {
                let mode = self.mode(&command);
                self.observer.note(
                    to_ms(burst.t_us),
                    Level::Info,
                    format!("sent: {}", command.in_words(mode)),
                );
            }
        }
    }

    /// Notes what the robot acknowledges: values of parameters, and its task.
    fn answered(&mut self, burst: &Burst) {
        for byte in &burst.bytes {
            let Some(Received::Frame(body)) = self.answers.push(*byte) else {
                continue;
            };
            let Ok(FromRobot::Ack(Ack {
                session,
                number,
                result: Ok(value),
            })) = FromRobot::from_body(&body)
            else {
                continue;
            };
            let sent = self
                .sent
                .filter(|sent| (sent.session, sent.number) == (session, number));
            match sent.map(|sent| sent.command) {
                Some(Command::SetParam { id, .. }) => self.observer.know_parameter(id, value),
                Some(command) => self.observer.take_on(&command, self.client.mode()),
                None => {}
            }
        }
    }

    fn mode(&self, command: &Command) -> ModeId {
        match command {
            Command::Mode(mode) => *mode,
            _ => self.client.mode(),
        }
    }

    fn state(&mut self, t_us: u64) {
        let around = Around {
            t_us,
            simulated: true,
            speed: 1.0,
            achieved_speed: 1.0,
            baud: self.baud,
            true_battery_v: self.battery_v,
        };
        let mut state = describe(&around, &mut self.client, &self.observer);
        let reference = self.client.mode().description().reference;
        if reference.is_none_or(|reference| reference.kind != ReferenceKind::Goal) {
            state.robot.task.goal = state.robot.task.goal.or(self.goal_m);
        }
        self.observer.show_state(state);
    }
}
