//! The log of a run without a window, made when the run is over: what crossed the link goes the way that it takes in a
//! live session.

use crate::client::{Heard, KnownTable, RobotClient};
use crate::event::Event;
use crate::observer::Observer;
use crate::observer::describe::{Around, describe};
use crate::words;
use rumbo_control::mode::ModeId;
use rumbo_control::params::Params;
use rumbo_log::{
    Burst, Entry, Level, LogWriter, Manifest, Outcome, Said, Scene, Truth, WriteError,
};
use rumbo_wire::{Ack, Command, Decoder, FromRobot, Message, Received, ToRobot};
use std::io::{Seek, Write};

/// The state is noted this often \[us\].
const STATE_PERIOD_US: u64 = 200_000;
/// Longest line of text that the decoder must pass over.
const LINE: usize = 160;

/// What a run left behind.
#[derive(Debug)]
pub struct Run<'a> {
    /// What surrounds the robot.
    pub scene: Option<Scene>,
    /// The robot's parameters at the start; `None` where it has no table of them.
    pub parameters: Option<Params>,
    /// What was really the case, with its time \[us\], in order.
    pub truths: &'a [(u64, Truth)],
    /// What crossed the link, in order.
    pub link: &'a [Burst],
    /// What crossed the USARTs of an emulated chip, in order.
    pub said: &'a [Said],
    /// What a program without a link of ours has told, with its time \[us\], in order.
    pub told: &'a [(u64, FromRobot)],
    /// How it ended.
    pub outcome: Outcome,
}

/// Writes the log of a run.
///
/// # Errors
/// If it cannot be written.
pub fn record_run<W: Write + Seek>(
    into: W,
    manifest: &Manifest,
    run: Run<'_>,
) -> Result<W, WriteError> {
    let mut log = LogWriter::new(into, manifest)?;
    let baud = manifest.baud;
    let mut teller = Teller {
        observer: Observer::new(),
        client: RobotClient::new(0, true, KnownTable::OURS),
        heard: Vec::new(),
        decoder: Decoder::default(),
        answers: Decoder::default(),
        sent: None,
        baud,
        battery_v: None,
    };
    teller.observer.show_scene(run.scene.clone());
    if let Some(parameters) = run.parameters {
        teller.observer.know_parameters(&parameters);
    }
    let (mut link, mut told) = (run.link.iter().peekable(), run.told.iter().peekable());
    let mut said = run.said.iter().peekable();
    let mut state_due_us = 0;
    for (t_us, truth) in run.truths {
        while let Some(burst) = link.next_if(|burst| burst.t_us <= *t_us) {
            teller.burst(burst);
        }
        while let Some(said) = said.next_if(|said| said.t_us <= *t_us) {
            teller.keep(&mut log)?;
            log.record(&Entry::Said(said.clone()))?;
        }
        while let Some((at_us, message)) = told.next_if(|(at_us, _)| at_us <= t_us) {
            teller
                .client
                .understand(*message, *at_us, &mut teller.heard);
            teller.digest(*at_us);
        }
        teller.observer.truth(to_ms(*t_us), *truth);
        teller.battery_v = Some(truth.battery_v);
        teller.observer.publish(0);
        if *t_us >= state_due_us {
            teller.state(*t_us);
            state_due_us = *t_us + STATE_PERIOD_US;
        }
        teller.keep(&mut log)?;
    }
    teller.keep(&mut log)?;
    for said in said {
        log.record(&Entry::Said(said.clone()))?;
    }
    log.record(&Entry::Outcome(run.outcome))?;
    log.finish()
}

/// Writes the log of what a robot of the original program and its terminal have said to each other.
///
/// # Errors
/// If it cannot be written.
pub fn record_text<W: Write + Seek>(
    into: W,
    manifest: &Manifest,
    link: &[Burst],
) -> Result<W, WriteError> {
    let mut log = LogWriter::new(into, manifest)?;
    let mut observer = Observer::new();
    let mut client = RobotClient::of_text(ModeId::default(), true);
    let (mut heard, mut state_due_us) = (Vec::new(), 0);
    for burst in link {
        observer.link(burst.clone());
        let t_ms = to_ms(burst.t_us);
        if burst.to_robot {
            let line = String::from_utf8_lossy(&burst.bytes);
            client.type_in(line.trim_end());
            observer.note(t_ms, Level::Info, format!("sent: {}", line.trim_end()));
        } else {
            client.hear(&burst.bytes, burst.t_us, &mut heard);
            observer.digest(&mut heard, &mut client, t_ms);
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

/// Records what the observer has to tell.
fn keep<W: Write + Seek>(
    observer: &mut Observer,
    log: &mut LogWriter<W>,
) -> Result<(), WriteError> {
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

/// A command on its way.
#[derive(Clone, Copy)]
struct Sent {
    session: u8,
    number: u16,
    command: Command,
}

struct Teller {
    observer: Observer,
    client: RobotClient,
    heard: Vec<Heard>,
    decoder: Decoder<LINE>,
    /// The same for the other direction.
    answers: Decoder<LINE>,
    /// The command sent last: a repetition is no news.
    sent: Option<Sent>,
    baud: u32,
    battery_v: Option<f64>,
}

impl Teller {
    fn keep<W: Write + Seek>(&mut self, log: &mut LogWriter<W>) -> Result<(), WriteError> {
        keep(&mut self.observer, log)
    }

    fn burst(&mut self, burst: &Burst) {
        self.observer.link(burst.clone());
        if burst.to_robot {
            self.client.said(burst.bytes.len(), burst.t_us);
            return self.sent(burst);
        }
        self.client.hear(&burst.bytes, burst.t_us, &mut self.heard);
        self.digest(burst.t_us);
        self.answered(burst);
    }

    fn digest(&mut self, t_us: u64) {
        self.observer
            .digest(&mut self.heard, &mut self.client, to_ms(t_us));
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
                    format!("sent: {}", words::command(&command, mode)),
                );
            }
        }
    }

    /// Notes the values of parameters that the robot acknowledges.
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
            if let Some(Command::SetParam { id, .. }) = sent.map(|sent| sent.command) {
                self.observer.know_parameter(id, value);
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
        let state = describe(&around, &mut self.client, &self.observer);
        self.observer.show_state(state);
    }
}
