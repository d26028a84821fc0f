//! What the link's events say of the robot: samples, what happened in words, the outcomes of commands.

use super::{Observer, unread_parameters};
use crate::client::{LinkEvent, RobotClient};
use crate::commands::{CommandOutcome, Fate};
use crate::task;
use crate::terminal;
use crate::words;
use rumbo_control::params::Params;
use rumbo_log::{EARLIER_MS, Level, Sample};
use rumbo_wire::{Command, EventKind, Hello, Recalled, Telemetry};

/// Restarts are reported at most this often \[ms\].
const RESTARTS_MS: i64 = 2_000;

impl Observer {
    /// Processes the link events up to `now_ms`.
    pub(crate) fn digest(
        &mut self,
        events: &mut Vec<LinkEvent>,
        client: &mut RobotClient,
        now_ms: i64,
    ) {
        for item in events.drain(..) {
            match item {
                LinkEvent::Telemetry(t_ms, telemetry) => self.sample(t_ms, telemetry, client),
                LinkEvent::Status(status) => {
                    self.urgent |= self.rig != Some(status.rig);
                    self.rig = Some(status.rig);
                    self.status = status;
                }
                LinkEvent::Event(t_ms, kind) => {
                    task::happened(&mut self.task, kind, self.pose);
                    self.event(t_ms, kind);
                }
                LinkEvent::Ended(outcome) => self.end_command(&outcome, client, now_ms),
                LinkEvent::Connected(hello) => {
                    self.connected(hello, client.table_matches(), now_ms)
                }
                LinkEvent::Text => {
                    let text = "connected; the robot speaks the original program's text: nothing is acknowledged, and it goes on by itself when the link is lost";
                    self.note(now_ms, Level::Good, text.into());
                }
                LinkEvent::Restarted(hello) => {
                    self.parameters = unread_parameters();
                    self.believed = Params::default();
                    self.show_parameters();
                    self.restarted(hello, now_ms);
                }
                LinkEvent::OtherProtocol(hello) => {
                    self.note(now_ms, Level::Fault, words::other_protocol(hello.protocol));
                }
                LinkEvent::StopUnconfirmed => {
                    self.note(now_ms, Level::Fault, words::STOP_UNCONFIRMED.into());
                }
                LinkEvent::Anomaly(anomaly) => {
                    self.note(now_ms, Level::Fault, words::alarm(anomaly))
                }
                LinkEvent::Lost if client.speaks_text() => {
                    let text = "nothing received from the robot for some seconds, though it is on";
                    self.note(now_ms, Level::Warning, text.into());
                }
                LinkEvent::Lost => {
                    let text =
                        "link lost: nothing received from the robot for a second; trying again";
                    self.note(now_ms, Level::Fault, text.into());
                }
            }
        }
    }

    fn sample(&mut self, t_ms: i64, telemetry: Telemetry, client: &RobotClient) {
        // Arrives long before the next status.
        self.urgent |= self.status.armed != telemetry.armed;
        self.status.armed = telemetry.armed;
        self.servo_rad = telemetry.servo_rad;
        self.pose = telemetry.pose;
        let truth = self.truths.at(t_ms - EARLIER_MS).zip(self.truths.at(t_ms));
        let true_pose = truth.map(|(_, at)| at.pose);
        let errors = self.believed.odometry_errors();
        let origin = self.origin.follow(t_ms, telemetry.pose, true_pose, &errors);
        let sample = Sample {
            t_ms,
            mode: client.mode(),
            reference: client.reference(),
            heading_ref_rad: client.heading_ref_rad(),
            telemetry,
            origin,
            spread: self.origin.spread(&errors),
            truth: truth.map(|(before, at)| [before, at]),
            ghost: self.ghosts.at(t_ms),
        };
        let mut row = sample.row();
        let absent_signals = client
            .row_kind()
            .into_iter()
            .flat_map(terminal::absent_signals);
        absent_signals.for_each(|name| row.set(name, f64::NAN));
        self.samples.push(row);
    }

    fn event(&mut self, t_ms: i64, kind: EventKind) {
        let level = match kind {
            EventKind::Armed | EventKind::Reached | EventKind::Saved => Level::Good,
            EventKind::Recalled(Recalled::First | Recalled::Second) => Level::Info,
            EventKind::Recalled(_) => Level::Warning,
            EventKind::Disarmed | EventKind::ModeChanged(_) => Level::Info,
            EventKind::Faulted(fault) => {
                self.status.fault = Some(fault);
                Level::Fault
            }
            EventKind::Unreachable | EventKind::GaveUp { .. } => Level::Warning,
            EventKind::Cleared(_) => {
                self.status.fault = None;
                Level::Info
            }
        };
        let text = match (kind, kind.detail()) {
            (EventKind::GaveUp { after_s }, Some(detail)) => {
                format!("gave up after {after_s} s: {detail}")
            }
            (_, Some(detail)) => format!("{}: {detail}", kind.title()),
            (_, None) => kind.title().into(),
        };
        self.note(t_ms, level, text);
    }

    /// Reports a restart, at most once in `RESTARTS_MS`.
    fn restarted(&mut self, hello: Hello, now_ms: i64) {
        let recently = |at_ms: i64| now_ms < at_ms + RESTARTS_MS;
        if self.restart_ms.is_some_and(recently) {
            return;
        }
        self.restart_ms = Some(now_ms);
        let why = hello.reset.explanation();
        let text = format!("the robot's program started again: {why}; it needs a new ON");
        self.note(now_ms, Level::Fault, text);
    }

    fn connected(&mut self, hello: Hello, table_matches: bool, now_ms: i64) {
        let why = hello.reset.explanation();
        let text = format!("connected; the robot's program started after: {why}");
        self.note(now_ms, Level::Good, text);
        if !table_matches {
            let text =
                "the robot has another parameter table: parameters are neither shown nor written";
            self.note(now_ms, Level::Warning, text.into());
        }
    }

    fn end_command(&mut self, ended: &CommandOutcome, client: &mut RobotClient, now_ms: i64) {
        if matches!(ended.fate, Fate::Applied(_)) {
            task::applied(&mut self.task, &ended.command, client.mode());
        }
        match (ended.command, ended.fate) {
            (Command::ResetPose, Fate::Applied(_)) => self.origin.settle(),
            (Command::SetParam { id, .. } | Command::GetParam { id }, fate) => {
                if let Some(parameter) = self.parameters.get_mut(usize::from(id)) {
                    parameter.pending = false;
                    parameter.refused = match fate {
                        Fate::Applied(_) => None,
                        Fate::Refused(why) => {
                            Some(words::refusal(why, &ended.command, client.mode()))
                        }
                        Fate::Superseded
                        | Fate::Expired
                        | Fate::RobotRestarted
                        | Fate::LinkLost => Some("not confirmed".into()),
                    };
                    match fate {
                        Fate::Applied(value) => self.know_parameter(id, value),
                        _ => self.show_parameters(),
                    }
                }
            }
            (Command::ResetParams, Fate::Applied(_)) => client.read_parameters(),
            _ => {}
        }
        let text = words::outcome(ended, client.mode());
        match (ended.command, ended.fate) {
            // Neither the reading of a value nor each waypoint of a route is an event.
            (Command::GetParam { .. } | Command::Waypoint(_), Fate::Applied(_)) => {}
            (_, Fate::Applied(_)) => self.note(now_ms, Level::Info, text),
            // Shown beside the parameter.
            (Command::GetParam { .. } | Command::SetParam { .. }, _) => {
                self.note(now_ms, Level::Warning, text);
            }
            _ => self.refuse(now_ms, text),
        }
    }
}
