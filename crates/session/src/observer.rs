//! What is known of the robot, as session events: samples, messages in words, the status, the parameters' values.

pub(crate) mod describe;
mod digest;

use crate::console::{ConsoleText, LINK_CONSOLE, PARTS_CONSOLE, readable};
use crate::event::Event;
use crate::origin::Origin;
use crate::printed::Printed;
use crate::target::{Shown, Standing};
use crate::task;
use crate::truth_log::TruthLog;
use rumbo_control::Pose;
use rumbo_control::mode::ModeId;
use rumbo_control::params::{ParamId, Params};
use rumbo_control::rig::Rig;
use rumbo_log::{
    Burst, Entry, Level, LoggedEvent, MapPose, Names, ParameterState, Reading, Row, Said, Scene,
    State, TaskState, Truth, parameters,
};
use rumbo_wire::{Command, StatusReport};
use std::collections::BTreeMap;

/// Touches closer together than this are one collision \[ms\].
const APART_MS: i64 = 1_000;

/// What is known of the robot.
#[derive(Debug)]
pub(crate) struct Observer {
    events: Vec<Event>,
    status: StatusReport,
    servo_rad: f32,
    pose: Pose,
    origin: Origin,
    task: TaskState,
    /// The rig the robot reports.
    rig: Option<Rig>,
    parameters: Vec<ParameterState>,
    /// The robot's parameters as far as they are known, else the table's defaults.
    believed: Params,
    truths: TruthLog,
    ghosts: TruthLog,
    samples: Vec<Row>,
    readings: Vec<Reading>,
    /// Names of what is shown: a target has one source of it.
    names: Names,
    /// What each port prints.
    printed: BTreeMap<u8, Printed>,
    /// The body touches something, or did until then \[ms\].
    touched_ms: Option<i64>,
    /// Why the last order was refused or given up, if it was.
    refused: Option<String>,
    /// When the last restart was reported \[ms\].
    restart_ms: Option<i64>,
    /// The state changed in a way that must be shown at once.
    urgent: bool,
}

impl Observer {
    /// An observer without any data yet.
    pub(crate) fn new() -> Self {
        let mut observer = Self {
            events: Vec::new(),
            status: StatusReport::default(),
            servo_rad: 0.0,
            pose: Pose::default(),
            origin: Origin::default(),
            task: TaskState::default(),
            rig: None,
            parameters: unread_parameters(),
            believed: Params::default(),
            truths: TruthLog::default(),
            ghosts: TruthLog::default(),
            samples: Vec::new(),
            readings: Vec::new(),
            names: Names::default(),
            printed: BTreeMap::new(),
            touched_ms: None,
            refused: None,
            restart_ms: None,
            urgent: true,
        };
        observer.show_parameters();
        observer
    }

    /// The simulation restarted: what was known is discarded.
    pub(crate) fn start_run(&mut self) {
        let mut events = std::mem::take(&mut self.events);
        events.push(Event::Run);
        let fresh = Self::new();
        events.extend(fresh.events);
        *self = Self { events, ..fresh };
    }

    /// Notes the ground truth at `now_ms`.
    pub(crate) fn truth(&mut self, now_ms: i64, truth: Truth) {
        if truth.contact {
            let apart = |last_ms: i64| now_ms > last_ms + APART_MS;
            if self.touched_ms.replace(now_ms).is_none_or(apart) {
                self.note(
                    now_ms,
                    Level::Warning,
                    "collision: the robot touches something".into(),
                );
            }
        }
        self.truths.push(now_ms, truth);
    }

    /// The robot's pose, as well as it is known.
    pub(crate) fn standing(&self) -> Standing {
        let estimated = MapPose::from(self.pose);
        Standing {
            at: self.origin.place(estimated),
            estimated,
        }
    }

    /// Notes the ghost's ground truth at `now_ms`.
    pub(crate) fn ghost(&mut self, now_ms: i64, truth: Truth) {
        self.ghosts.push(now_ms, truth);
    }

    /// The slow signals, as far as they are known, updated by telemetry and events between statuses.
    pub(crate) fn status(&self) -> StatusReport {
        self.status
    }

    /// The servo's angle last reported [rad].
    pub(crate) fn servo_rad(&self) -> f32 {
        self.servo_rad
    }

    /// The robot's task and its outcome.
    pub(crate) fn task(&self) -> &TaskState {
        &self.task
    }

    /// The robot has applied a command in this mode.
    pub(crate) fn take_on(&mut self, command: &Command, mode: ModeId) {
        task::applied(&mut self.task, command, mode);
    }

    /// The rig the robot reports, once it has.
    pub(crate) fn rig(&self) -> Option<Rig> {
        self.rig
    }

    /// A new value is in flight.
    pub(crate) fn parameter_pending(&mut self, id: u8) {
        if let Some(parameter) = self.parameters.get_mut(usize::from(id)) {
            parameter.pending = true;
            self.show_parameters();
        }
    }

    /// Sets the robot's parameters.
    pub(crate) fn know_parameters(&mut self, parameters: &Params) {
        self.believed = *parameters;
        for (state, id) in self.parameters.iter_mut().zip(ParamId::ALL) {
            state.value = Some(parameters.get(id));
        }
        self.show_parameters();
    }

    /// The robot has acknowledged this value of a parameter.
    pub(crate) fn know_parameter(&mut self, id: u8, value: f32) {
        let Some(parameter) = self.parameters.get_mut(usize::from(id)) else {
            return;
        };
        parameter.value = Some(value);
        if let Some(known) = ParamId::from_number(id) {
            // A value that the robot accepted is within the range of the same table.
            let _ = self.believed.set(known, value);
        }
        self.show_parameters();
    }

    /// The values of the parameters that are known, by number.
    pub(crate) fn parameter_values(&self) -> Vec<(u8, f32)> {
        let values = (0..).zip(&self.parameters);
        values
            .filter_map(|(id, each)| Some((id, each.value?)))
            .collect()
    }

    /// Notes an event.
    pub(crate) fn note(&mut self, t_ms: i64, level: Level, text: String) {
        self.urgent = true;
        self.emit(Entry::Event(LoggedEvent {
            t_s: t_ms as f64 / 1e3,
            level,
            text,
        }));
    }

    /// An order was given: the refusal of the one before is cleared.
    pub(crate) fn order_given(&mut self) {
        self.urgent |= self.refused.take().is_some();
    }

    /// Notes that an order was refused or given up.
    pub(crate) fn refuse(&mut self, t_ms: i64, text: String) {
        self.refused = Some(text.clone());
        self.note(t_ms, Level::Warning, text);
    }

    /// Why the last order was refused or given up, if it was.
    pub(crate) fn refused(&self) -> Option<&str> {
        self.refused.as_deref()
    }

    /// Notes the operator's commands.
    pub(crate) fn commanded(&mut self, t_us: u64, commands: Vec<Command>) {
        self.events.push(Event::Commanded(t_us, commands));
    }

    /// Notes raw bytes of the link.
    pub(crate) fn link(&mut self, burst: Burst) {
        self.emit(Entry::Burst(burst));
    }

    /// Takes what is shown of the robot beside its telemetry.
    pub(crate) fn shown(&mut self, now_ms: i64, shown: impl IntoIterator<Item = Shown>) {
        for (source, signals) in shown {
            let reading = self.names.reading(now_ms, source, signals);
            self.readings.push(reading);
        }
    }

    /// Records what the USARTs of an emulated chip sent, and the numbers in it.
    pub(crate) fn consoles(&mut self, t_us: u64, said: Vec<(u8, Vec<u8>)>) {
        for (usart, bytes) in said {
            self.said(Said {
                t_us,
                usart,
                to_chip: false,
                bytes,
            });
        }
    }

    /// Records what crossed a USART of an emulated chip, and the numbers that its program printed.
    pub(crate) fn said(&mut self, said: Said) {
        if !said.to_chip && said.usart != PARTS_CONSOLE {
            self.read_numbers(said.usart, &said.bytes, (said.t_us / 1_000) as i64);
        }
        self.emit(Entry::Said(said));
    }

    fn read_numbers(&mut self, usart: u8, bytes: &[u8], now_ms: i64) {
        let printed = self.printed.entry(usart).or_default();
        self.readings.extend(printed.take(usart, bytes, now_ms));
    }

    /// Records a line that a person typed to a USART.
    pub(crate) fn typed(&mut self, t_us: u64, usart: u8, line: &str) {
        self.said(Said {
            t_us,
            usart,
            to_chip: true,
            bytes: line.into(),
        });
    }

    /// Shows the text of a robot as received.
    pub(crate) fn said_in_text(&mut self, bytes: &[u8], now_ms: i64) {
        self.read_numbers(LINK_CONSOLE, bytes, now_ms);
        let text = readable(bytes);
        if !text.is_empty() {
            let usart = LINK_CONSOLE;
            self.events
                .push(Event::Console(ConsoleText { usart, text }));
        }
    }

    /// Publishes the samples; returns whether the state must follow at once.
    pub(crate) fn publish(&mut self, now_ms: i64) -> bool {
        let readings = std::mem::take(&mut self.readings);
        if !readings.is_empty() {
            self.emit(Entry::Readings(readings));
        }
        let samples = std::mem::take(&mut self.samples);
        if !samples.is_empty() {
            self.events.push(Event::Received(now_ms));
            self.emit(Entry::Rows(samples));
        }
        std::mem::take(&mut self.urgent)
    }

    /// The events since the last call.
    pub(crate) fn take_events(&mut self) -> Vec<Event> {
        std::mem::take(&mut self.events)
    }

    fn emit(&mut self, entry: Entry) {
        self.events.push(entry.into());
    }

    fn show_parameters(&mut self) {
        self.emit(Entry::Parameters(self.parameters.clone()));
    }

    /// Shows the scene; the robot's pose begins where it starts.
    pub(crate) fn show_scene(&mut self, scene: Option<Scene>) {
        let start = scene.as_ref().map(|scene| scene.start);
        self.origin = Origin::new(start.unwrap_or_default());
        self.emit(Entry::Scene(scene.map(Box::new)));
    }

    /// Shows the state.
    pub(crate) fn show_state(&mut self, state: State) {
        self.emit(Entry::State(Box::new(state)));
    }
}

fn unread_parameters() -> Vec<ParameterState> {
    parameters()
        .map(|entry| ParameterState {
            entry,
            value: None,
            pending: false,
            refused: None,
        })
        .collect()
}
