//! `rumbo rerun`: reruns the run of a log, and compares every byte that the robot sends.
//!
//! A headless run is simply repeated. A session of the lab is driven by the recorded bytes to the robot, each at the
//! simulated instant at which it was sent. The output of the USARTs of an emulated Mega is compared as well.

mod recorder;

use crate::args::RerunArgs;
use crate::export::warn_if_cut;
use crate::failure::Failure;
use crate::logs;
use crate::manifest;
use crate::output;
use crate::run_log;
use recorder::Recorder;
use rumbo_experiment::files::{FileError, Setup};
use rumbo_experiment::run::{self, RunResult};
use rumbo_experiment::{MODEL, calibration_run};
use rumbo_log::{Burst, Log, LogKind, Manifest, Row, Said, Sample, Sent};
use rumbo_sim::mega::{CONSOLES, PARTS};
use rumbo_sim::{Config, Sim};
use rumbo_station::log_file;
use rumbo_wire::text::TextCommand;
use rumbo_wire::{Decoder, FrameMessage, FromRobot, PROTOCOL_VERSION, Received, Telemetry};
use serde_json::json;
use std::path::Path;

/// Longest line of text from a robot that is put together.
const LINE: usize = 160;

/// The result of the comparison.
enum Verdict {
    Equal,
    /// First difference: time \[s\], and what was and is there.
    Differs(f64, String),
}

/// Runs the log's run again and returns whether it is the same.
pub(crate) fn rerun(args: &RerunArgs) -> Result<(), Failure> {
    logs::mend(&args.log);
    let log = log_file::read(&args.log).map_err(Failure::input)?;
    let shown = args.log.display();
    let Some(recorded) = &log.manifest else {
        return Err(Failure::Input(format!(
            "{shown}: has no manifest; only logs of `rumbo lab`, `rumbo run` and `rumbo calibrate` can be run again"
        )));
    };
    warn_if_cut(&args.log, &log)?;
    if log.has_holes {
        return Err(Failure::Input(format!(
            "{shown}: parts of it are missing, so its run cannot be compared"
        )));
    }
    let recorder = Recorder::of(&log, recorded);
    let verdict = run_again(&args.log, &log, recorded, &recorder)?;
    print(args, &log, recorded, &recorder, &verdict)?;
    match verdict {
        Verdict::Equal => Ok(()),
        Verdict::Differs(..) => Err(Failure::LimitMissed),
    }
}

/// Runs what the manifest names, and compares it with the log.
fn run_again(
    path: &Path,
    log: &Log,
    recorded: &Manifest,
    recorder: &Recorder,
) -> Result<Verdict, Failure> {
    let refused = |why: String| Err(Failure::Input(format!("{}: {why}", path.display())));
    // What another program has written may not even be read: then that is the reason.
    let (setup, seed) = manifest::setup(path, recorded).map_err(|failure| match failure {
        failure if recorder.table.is_none() && recorder.version.is_empty() => failure,
        failure => {
            let table = recorder.table.as_ref();
            let table = table.map_or_else(String::new, |table| format!("; {table}"));
            Failure::Input(format!("{failure}{table}{}", recorder.version))
        }
    })?;
    match recorded.kind {
        LogKind::Run => {
            let result = run::run(&setup, seed)?;
            let own = match &recorded.member {
                Some(name) => result.robots.iter().find(|robot| robot.scenario == *name),
                None => Some(&result),
            };
            match own {
                Some(own) => Ok(same(log, own, recorder.protocol)),
                None => refused(
                    "its robot is none of its scenario; the log is damaged or forged".into(),
                ),
            }
        }
        LogKind::Calibration => {
            let again = calibration_run::run_calibration(&setup, seed)?;
            Ok(same(log, &again.result, recorder.protocol))
        }
        LogKind::Lab if let Some(protocol) = recorder.protocol => refused(format!(
            "a session in protocol {protocol}, of which only the bytes could be compared, and this program speaks protocol \
             {PROTOCOL_VERSION}; run it again with the program that recorded it{}",
            recorder.version
        )),
        LogKind::Lab if recorded.member.is_some() => refused(
            "a session of one of several robots, which depends on what was done with the others; only a log of `rumbo run` can be run \
             again with several robots"
                .into(),
        ),
        LogKind::Lab => session(log, &setup, seed, recorded),
        LogKind::Robot => {
            refused("is of a real robot; only simulated runs can be run again".into())
        }
        LogKind::Episode => refused(format!(
            "an episode, whose robot a program in Python drove; run that program again, its seed is {seed}"
        )),
    }
}

/// Prints what the comparison found.
fn print(
    args: &RerunArgs,
    log: &Log,
    recorded: &Manifest,
    recorder: &Recorder,
    verdict: &Verdict,
) -> Result<(), Failure> {
    let from_robot = log.link.iter().filter(|burst| !burst.to_robot);
    let bytes: usize = from_robot.map(|burst| burst.bytes.len()).sum();
    let first = match verdict {
        Verdict::Equal => None,
        Verdict::Differs(t_s, what) => Some((t_s, recorder.table.as_ref().unwrap_or(what))),
    };
    if args.json {
        return output::json(
            &json!({ "log": output::shown(&args.log), "equal": first.is_none(), "duration_s": log.duration_s(), "bytes": bytes,
            "recorded_by": recorded.version, "run_by": env!("CARGO_PKG_VERSION"),
            "recorded_model": recorded.model, "run_model": MODEL,
            "first_difference_s": first.map(|(t_s, _)| t_s), "difference": first.map(|(_, what)| what) }),
        );
    }
    let shown = args.log.display();
    let compared = match recorder.protocol {
        Some(_) => recorder.protocol_words(),
        None => format!(", {bytes} bytes from the robot"),
    };
    output::line(&match first {
        None => format!(
            "{shown}: equal{compared} in {:.2} s{}",
            log.duration_s(),
            recorder.version
        ),
        Some((t_s, what)) => format!(
            "{shown}: {}differs first at {t_s:.3} s: {what}{}{}",
            recorder.model_words(),
            recorder.protocol_words(),
            recorder.version
        ),
    })
}

/// Compares a run without a window, which was done again, with its log.
fn same(log: &Log, result: &RunResult, other_protocol: Option<u8>) -> Verdict {
    let link: Vec<Burst> = result.trace.link.iter().map(run_log::burst).collect();
    let said: Vec<Said> = result.trace.consoles.iter().map(run_log::said).collect();
    let cut = log.cut.is_some();
    if other_protocol.is_none() {
        let parted = first_difference(&log.link, &link, cut);
        let parted = parted.or_else(|| first_difference(&log.said, &said, cut));
        if let Some(difference) = parted {
            return difference;
        }
    }
    let Some(outcome) = &log.outcome else {
        return Verdict::Equal;
    };
    // To the last digit: metrics are from ground truth, of which telemetry is only a part.
    let differs = |(name, value): (&String, &f64)| {
        let other = result.metrics.get(name).copied().unwrap_or(f64::NAN);
        (value.to_bits() != other.to_bits() && !(value.is_nan() && other.is_nan()))
            .then(|| format!("{name} was {value}, is {other}"))
    };
    match outcome.metrics.iter().find_map(differs) {
        Some(what) => Verdict::Differs(log.duration_s(), what),
        None => Verdict::Equal,
    }
}

fn session(log: &Log, setup: &Setup, seed: u64, recorded: &Manifest) -> Result<Verdict, Failure> {
    let mut sim = Sim::new(Config {
        memory: recorded.memory(),
        ..run::prepare(setup, seed)?.config(seed)?
    })
    .map_err(FileError::from)?;
    let last = [
        log.link.last().map(|burst| burst.t_us),
        log.said.last().map(|said| said.t_us),
    ];
    let Some(end_us) = last.into_iter().flatten().max() else {
        return Ok(Verdict::Equal);
    };
    let mut sent = log.sent().peekable();
    let mut said = Vec::new();
    let mut link = Vec::new();
    loop {
        let t_us = sim.now_us();
        let mut bytes = Vec::new();
        sim.receive(&mut bytes);
        if !bytes.is_empty() {
            link.push(Burst {
                t_us,
                to_robot: false,
                bytes,
            });
        }
        said.extend(consoles(&mut sim, t_us));
        // In their order: a line typed to the link's USART goes the same way as the commands.
        while let Some(next) = sent.next_if(|sent| sent.t_us() <= t_us) {
            match next {
                Sent::Link(burst) => {
                    sim.send(&burst.bytes);
                    if log.speaks_text()
                        && let Some(on) = supplies(&burst.bytes)
                    {
                        sim.supply_motors(on);
                    }
                }
                Sent::Typed(line) => {
                    rumbo_lab::type_to(&mut sim, line.usart, &line.bytes);
                }
            }
        }
        if t_us >= end_us {
            break;
        }
        sim.advance(t_us + recorded.step_us);
    }
    let from_robot = log.link.iter().filter(|burst| !burst.to_robot);
    let was: Vec<Burst> = from_robot.cloned().collect();
    let from_chip = log.said.iter().filter(|said| !said.to_chip);
    let had_said: Vec<Said> = from_chip.cloned().collect();
    Ok(first_difference(&was, &link, true)
        .or_else(|| first_difference(&had_said, &said, true))
        .unwrap_or(Verdict::Equal))
}

/// What STOP, OFF or ON among lines of the session did to the supply of the motors.
fn supplies(bytes: &[u8]) -> Option<bool> {
    let lines = str::from_utf8(bytes).ok()?.lines().rev();
    let mut commands = lines.filter_map(|line| TextCommand::parse(line).ok());
    commands.find_map(|command| match command {
        TextCommand::On => Some(true),
        TextCommand::Off => Some(false),
        _ => None,
    })
}

/// Drains the output of the USARTs of an emulated Mega.
fn consoles(sim: &mut Sim, t_us: u64) -> Vec<Said> {
    let Some(mega) = sim.mega_mut() else {
        return Vec::new();
    };
    let said = (0..CONSOLES).map(|usart| Said {
        t_us,
        usart,
        to_chip: false,
        bytes: mega.take_console(usart),
    });
    said.filter(|said| !said.bytes.is_empty()).collect()
}

/// A recorded item that can be compared.
trait Recorded: PartialEq {
    /// When \[us\].
    fn t_us(&self) -> u64;
    /// What, for people.
    fn words(&self) -> String;
    /// In what another one differs, for people.
    fn difference(&self, other: &Self) -> String {
        format!("was {}, is {}", self.words(), other.words())
    }
}

impl Recorded for Burst {
    fn t_us(&self) -> u64 {
        self.t_us
    }

    fn words(&self) -> String {
        words(self)
    }

    fn difference(&self, other: &Self) -> String {
        let differing = match (completed(self), completed(other)) {
            (Some(FromRobot::Telemetry(was)), Some(FromRobot::Telemetry(is)))
                if self.t_us == other.t_us =>
            {
                differing_signals(was, is)
            }
            _ => Vec::new(),
        };
        match differing.is_empty() {
            true => format!("was {}, is {}", words(self), words(other)),
            false => format!(
                "telemetry at {:.3} s: {}",
                self.t_us as f64 / 1e6,
                differing.join("; ")
            ),
        }
    }
}

impl Recorded for Said {
    fn t_us(&self) -> u64 {
        self.t_us
    }

    fn words(&self) -> String {
        let text = rumbo_session::readable(&self.bytes);
        let port = match self.usart {
            PARTS => "displays".to_owned(),
            usart => format!("serial port {usart}"),
        };
        format!("{port} `{}`", text.replace('\n', "\\n"))
    }
}

/// The first difference of two records of a link; a truncated record may end first.
fn first_difference<T: Recorded>(was: &[T], is: &[T], cut: bool) -> Option<Verdict> {
    let parted = was.iter().zip(is).find(|(was, is)| was != is);
    if let Some((was, is)) = parted {
        let t_s = was.t_us().min(is.t_us()) as f64 / 1e6;
        return Some(Verdict::Differs(t_s, was.difference(is)));
    }
    if was.len() > is.len() || (was.len() < is.len() && !cut) {
        let longer = if was.len() > is.len() { was } else { is };
        let next = longer.get(was.len().min(is.len()))?;
        let which = if was.len() > is.len() {
            "the recorded run goes on with"
        } else {
            "the run goes on now with"
        };
        return Some(Verdict::Differs(
            next.t_us() as f64 / 1e6,
            format!("{which} {}", next.words()),
        ));
    }
    None
}

/// A burst for people: who, when, and the message that it completes, else its bytes.
fn words(burst: &Burst) -> String {
    let who = if burst.to_robot {
        "to the robot"
    } else {
        "from the robot"
    };
    let message = completed(burst).map(|message| format!("{message:?}"));
    let content = message.unwrap_or_else(|| {
        burst
            .bytes
            .iter()
            .map(|byte| format!("{byte:02x}"))
            .collect()
    });
    format!("{who} at {:.3} s {content}", burst.t_us as f64 / 1e6)
}

/// The message from the robot that a burst completes.
fn completed(burst: &Burst) -> Option<FromRobot> {
    let mut decoder = Decoder::<LINE>::default();
    burst
        .bytes
        .iter()
        .find_map(|byte| match decoder.push(*byte) {
            Some(Received::Frame(body)) => FromRobot::from_body(&body).ok(),
            Some(Received::Line(_)) | None => None,
        })
}

/// The signals in which two frames of telemetry differ, as in a log's table.
fn differing_signals(was: Telemetry, is: Telemetry) -> Vec<String> {
    let [was, is] = [was, is].map(|telemetry| Sample::of(telemetry).row());
    let shown =
        |value: Option<f64>| value.map_or_else(|| "unknown".to_owned(), |it| it.to_string());
    let differing = Row::names().enumerate().filter_map(|(column, name)| {
        let (was, is) = (was.get(column), is.get(column));
        (was != is).then(|| format!("{name} was {}, is {}", shown(was), shown(is)))
    });
    differing.collect()
}

#[cfg(test)]
mod tests;
