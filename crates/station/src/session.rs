//! The session: lets the target live, paced by the wall clock, and keeps the board up to date.
//!
//! Its thread wakes every [`WAKE`], or at once for an order; advances the target in slices of [`SLICE_US`] for the time
//! that passed times the speed factor; feeds what arrived to the [`RobotClient`] and notes what it heard on the [`Board`].
//! Nothing waits for a page.

use crate::board::{Board, Level, LinkState, LoggedEvent, RobotState, State};
use crate::catalogue::{self, ParameterState};
use crate::client::{Heard, KnownTable, RobotClient};
use crate::commands::{Fate, Outcome};
use crate::orders::{MAX_SPEED, Order};
use crate::signals::{EARLIER_MS, Sample, TruthLog};
use crate::target::{Choice, Target};
use crate::words;
use rumbo_wire::{Command, EventKind, PROTOCOL_VERSION, Status, Telemetry};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::{Duration, Instant};

/// Time between two looks at the link while time passes.
const WAKE: Duration = Duration::from_millis(5);
/// The same while paused: an order wakes the session anyway.
const WAKE_PAUSED: Duration = Duration::from_millis(250);
/// Step of the target's time [us]; instants at which the truth is noted are multiples of it.
const SLICE_US: u64 = 5_000;
/// Target time that a late session still catches up with, in seconds of the wall clock; more is let go.
const CATCH_UP_S: f64 = 0.1;
/// Longest time spent on one round of slices: orders wait no longer, however high the speed factor.
const ROUND: Duration = Duration::from_millis(20);
/// The slow state is noted this often.
const STATE_PERIOD: Duration = Duration::from_millis(200);

/// Where orders come from.
pub(crate) struct Orders {
    /// The orders, in order. The session ends when the sending side is gone.
    pub(crate) queue: Receiver<Order>,
    /// STOP, set beside the queue so that a full queue cannot keep it out.
    pub(crate) stop: Arc<AtomicBool>,
}

/// A session with one target.
pub(crate) struct Session {
    target: Box<dyn Target>,
    client: RobotClient,
    board: Arc<Board>,
    orders: Orders,
    pace: Pace,
    status: Status,
    parameters: Vec<ParameterState>,
    truths: TruthLog,
    simulated: bool,
    state_noted: Option<Instant>,
    /// Kept to spare an allocation per slice.
    samples: Vec<Sample>,
    heard: Vec<Heard>,
}

impl Session {
    pub(crate) fn new(
        mut target: Box<dyn Target>,
        board: Arc<Board>,
        orders: Orders,
        speed: f64,
    ) -> Self {
        let simulated = target.simulation().is_some();
        let session = Self {
            client: new_client(simulated),
            target,
            board,
            orders,
            pace: Pace::new(speed.clamp(0.0, MAX_SPEED)),
            status: Status::default(),
            parameters: unread_parameters(),
            truths: TruthLog::default(),
            simulated,
            state_noted: None,
            samples: Vec::new(),
            heard: Vec::new(),
        };
        session.board.set_parameters(&session.parameters);
        session
    }

    /// Runs until the sender of orders is gone.
    ///
    /// # Errors
    /// What the target said when it was gone for good.
    pub(crate) fn run(mut self) -> Result<(), String> {
        let ended = self.run_until_ended();
        if let Err(why) = &ended {
            self.note(Level::Fault, format!("the robot is gone: {why}"));
        }
        ended
    }

    fn run_until_ended(&mut self) -> Result<(), String> {
        self.show_scene();
        loop {
            let wait = if self.pace.speed > 0.0 {
                WAKE
            } else {
                WAKE_PAUSED
            };
            match self.orders.queue.recv_timeout(wait) {
                Ok(order) => self.obey(order)?,
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return self.say_goodbye(),
            }
            if self.orders.stop.swap(false, Ordering::Relaxed) {
                self.obey(Order::Robot(Command::Stop))?;
            }
            while let Ok(order) = self.orders.queue.try_recv() {
                self.obey(order)?;
            }
            self.live()?;
            self.publish();
        }
    }

    /// The robot is not left driving. Should this be lost, the missing heartbeat stops it.
    fn say_goodbye(&mut self) -> Result<(), String> {
        self.obey(Order::Robot(Command::Stop))
    }

    fn obey(&mut self, order: Order) -> Result<(), String> {
        match order {
            Order::Robot(command) => self.command(command),
            Order::Speed(factor) => {
                if self.simulated {
                    self.pace = Pace::new(factor);
                    self.state_noted = None;
                } else {
                    self.note(
                        Level::Warning,
                        "speed: refused, a real robot lives at its own".into(),
                    );
                }
                Ok(())
            }
            Order::Reset(choice) => {
                self.reset(&choice);
                Ok(())
            }
        }
    }

    fn command(&mut self, command: Command) -> Result<(), String> {
        if let Command::SetParam { id, .. } = command {
            match self.parameters.get_mut(usize::from(id)) {
                Some(parameter) if self.client.table_matches() => {
                    parameter.pending = true;
                    self.board.set_parameters(&self.parameters);
                }
                _ => {
                    let asked = words::command(&command, self.client.mode());
                    self.note(
                        Level::Warning,
                        format!("{asked}: refused, the robot has another parameter table"),
                    );
                    return Ok(());
                }
            }
        }
        if self.client.submit(command, self.target.now_us()).is_err() {
            let asked = words::command(&command, self.client.mode());
            self.note(
                Level::Warning,
                format!("{asked}: refused, too many commands wait for the robot"),
            );
        }
        // At once: STOP does not wait for the next wake.
        self.send()
    }

    fn send(&mut self) -> Result<(), String> {
        let mut bytes = Vec::new();
        self.client
            .poll(self.target.now_us(), &mut bytes, &mut self.heard);
        if !bytes.is_empty() {
            self.target.send(&bytes)?;
        }
        Ok(())
    }

    fn reset(&mut self, choice: &Choice) {
        let Some(simulation) = self.target.simulation() else {
            return self.note(
                Level::Warning,
                "reset: refused, this is a real robot".into(),
            );
        };
        match simulation.reset(choice) {
            Ok(()) => {
                self.client = new_client(self.simulated);
                self.status = Status::default();
                self.parameters = unread_parameters();
                self.truths = TruthLog::default();
                self.samples.clear();
                self.heard.clear();
                self.pace = Pace::new(self.pace.speed);
                self.state_noted = None;
                self.board.start_run();
                self.board.set_parameters(&self.parameters);
                self.show_scene();
                let world = choice
                    .world
                    .as_ref()
                    .map(|world| format!(" in world {world}"))
                    .unwrap_or_default();
                self.note(
                    Level::Info,
                    format!("reset: {}{world}, seed {}", choice.scenario, choice.seed),
                );
            }
            Err(why) => self.note(Level::Warning, format!("reset: refused, {why}")),
        }
    }

    fn show_scene(&mut self) {
        let scene = self
            .target
            .simulation()
            .map(|simulation| simulation.scene());
        self.board.set_scene(scene);
    }

    /// Lets the target live for the time due.
    fn live(&mut self) -> Result<(), String> {
        self.pace.wall_passed(Instant::now());
        let round_ends = Instant::now() + ROUND;
        let mut bytes = Vec::new();
        while self.pace.slice_due() {
            self.target.advance(SLICE_US)?;
            self.pace.slice_lived();
            let now_us = self.target.now_us();
            if let Some(simulation) = self.target.simulation() {
                self.truths.push(to_ms(now_us), simulation.truth());
            }
            bytes.clear();
            self.target.receive(&mut bytes);
            self.client.hear(&bytes, now_us, &mut self.heard);
            self.send()?;
            self.digest();
            if Instant::now() >= round_ends {
                break;
            }
        }
        Ok(())
    }

    /// Notes what was heard.
    fn digest(&mut self) {
        let mut heard = std::mem::take(&mut self.heard);
        for item in heard.drain(..) {
            self.digest_one(item);
        }
        self.heard = heard;
    }

    fn digest_one(&mut self, item: Heard) {
        match item {
            Heard::Telemetry(t_ms, telemetry) => self.sample(t_ms, telemetry),
            Heard::Status(status) => self.status = status,
            Heard::Event(t_ms, kind) => {
                let (level, text) = event_words(kind);
                self.note_at(t_ms, level, text);
            }
            Heard::Ended(outcome) => self.end_command(outcome),
            Heard::Connected(hello) => {
                if hello.protocol != PROTOCOL_VERSION {
                    let text = format!(
                        "the robot speaks protocol {}, this station {PROTOCOL_VERSION}: flash the robot or update the station",
                        hello.protocol
                    );
                    return self.note(Level::Fault, text);
                }
                self.note(
                    Level::Good,
                    format!(
                        "connected; the robot started after: {}",
                        hello.reset.explanation()
                    ),
                );
                if !self.client.table_matches() {
                    self.note(
                        Level::Warning,
                        "the robot has another parameter table: parameters are neither shown nor written".into(),
                    );
                }
            }
            Heard::Restarted(hello) => {
                self.parameters = unread_parameters();
                self.board.set_parameters(&self.parameters);
                self.note(
                    Level::Fault,
                    format!(
                        "the robot's program started again: {}",
                        hello.reset.explanation()
                    ),
                );
            }
            Heard::Lost => {
                self.note(
                    Level::Fault,
                    "link lost: nothing heard from the robot for a second; trying again".into(),
                );
            }
        }
    }

    fn sample(&mut self, t_ms: i64, telemetry: Telemetry) {
        let truth = self
            .truths
            .at(t_ms - EARLIER_MS)
            .zip(self.truths.at(t_ms))
            .map(|(before, at)| [before, at]);
        let (mode, reference) = (self.client.mode(), self.client.reference());
        self.samples.push(Sample {
            t_ms,
            mode,
            reference,
            telemetry,
            truth,
        });
    }

    fn end_command(&mut self, ended: Outcome) {
        match (ended.command, ended.fate) {
            (Command::SetParam { id, .. } | Command::GetParam { id }, fate) => {
                if let Some(parameter) = self.parameters.get_mut(usize::from(id)) {
                    parameter.pending = false;
                    parameter.refused = match fate {
                        Fate::Applied(value) => {
                            parameter.value = Some(value);
                            None
                        }
                        Fate::Refused(why) => Some(words::refusal(why, &ended.command)),
                        Fate::Superseded | Fate::Expired | Fate::RobotRestarted => {
                            Some("not confirmed".into())
                        }
                    };
                    self.board.set_parameters(&self.parameters);
                }
            }
            (Command::ResetParams, Fate::Applied(_)) => self.client.read_parameters(),
            _ => {}
        }
        let level = match ended.fate {
            Fate::Applied(_) => Level::Info,
            _ => Level::Warning,
        };
        // That a value was read is no event.
        if !matches!(
            (ended.command, ended.fate),
            (Command::GetParam { .. }, Fate::Applied(_))
        ) {
            self.note(level, words::outcome(&ended, self.client.mode()));
        }
    }

    fn note(&self, level: Level, text: String) {
        self.note_at(to_ms(self.target.now_us()), level, text);
    }

    fn note_at(&self, t_ms: i64, level: Level, text: String) {
        self.board.push_event(LoggedEvent {
            t_s: t_ms as f64 / 1e3,
            level,
            text,
        });
    }

    fn publish(&mut self) {
        self.digest();
        self.board.push_samples(&self.samples);
        self.samples.clear();
        let now = Instant::now();
        if self
            .state_noted
            .is_none_or(|noted| now >= noted + STATE_PERIOD)
        {
            self.state_noted = Some(now);
            let state = self.state();
            self.board.set_state(state);
        }
    }

    fn state(&mut self) -> State {
        let now_us = self.target.now_us();
        let link = self.client.link(now_us);
        let capacity_bytes_s = f64::from(self.target.baud()) / 10.0;
        let status = &self.status;
        let reference = self.client.reference();
        State {
            t_s: now_us as f64 / 1e6,
            simulated: self.simulated,
            speed: self.pace.speed,
            achieved_speed: (self.pace.achieved() * 100.0).round() / 100.0,
            link: LinkState {
                connected: self.client.connected(),
                telemetry_hz: (link.telemetry_hz * 10.0).round() / 10.0,
                down_load: (link.down_bytes_s / capacity_bytes_s * 1e3).round() / 1e3,
                up_load: (link.up_bytes_s / capacity_bytes_s * 1e3).round() / 1e3,
                baud: self.target.baud(),
                round_trip_ms: link
                    .round_trip_us
                    .map(|round_trip_us| round_trip_us / 1_000),
                crc_errors_down: link.crc_errors,
                crc_errors_up: status.crc_errors,
                frames_lost: link.frames_lost,
                dropped: status.dropped,
                unacknowledged: link.unacknowledged,
            },
            robot: RobotState {
                mode: self.client.mode() as u8,
                armed: status.armed,
                fault: status.fault.map(rumbo_control::Fault::explanation),
                battery_v: status
                    .battery_v
                    .map(|volts| (f64::from(volts) * 100.0).round() / 100.0),
                true_battery_v: self
                    .target
                    .simulation()
                    .map(|simulation| (simulation.truth().battery_v * 100.0).round() / 100.0),
                reference: [reference.left, reference.right],
                overruns: status.overruns,
                servo_rad: status.servo_rad,
                foreign: self.client.hello().is_some() && !self.client.table_matches(),
            },
        }
    }
}

fn to_ms(us: u64) -> i64 {
    (us / 1_000) as i64
}

fn new_client(clock_known: bool) -> RobotClient {
    let table = KnownTable {
        schema: catalogue::schema(),
        len: catalogue::len(),
    };
    RobotClient::new(random_session(), clock_known, table)
}

/// A session id that differs from the last one's in 255 of 256 cases even when randomness is not to be had.
fn random_session() -> u8 {
    let clock = std::time::SystemTime::UNIX_EPOCH
        .elapsed()
        .map_or(0, |elapsed| elapsed.subsec_micros());
    getrandom::u32().unwrap_or(clock).to_le_bytes()[0]
}

fn unread_parameters() -> Vec<ParameterState> {
    catalogue::table()
        .map(|entry| ParameterState {
            entry,
            value: None,
            pending: false,
            refused: None,
        })
        .collect()
}

fn event_words(kind: EventKind) -> (Level, String) {
    let level = match kind {
        EventKind::Armed | EventKind::Reached => Level::Good,
        EventKind::Disarmed | EventKind::Cleared(_) | EventKind::ModeChanged(_) => Level::Info,
        EventKind::Faulted(_) => Level::Fault,
    };
    let text = match kind.detail() {
        Some(detail) => format!("{}: {detail}", kind.title()),
        None => kind.title().into(),
    };
    (level, text)
}

/// How fast the target's time goes.
#[derive(Debug)]
struct Pace {
    speed: f64,
    due_us: f64,
    last: Option<Instant>,
    measured_from: Option<Instant>,
    lived_us: u64,
    achieved: f64,
}

impl Pace {
    fn new(speed: f64) -> Self {
        Self {
            speed,
            due_us: 0.0,
            last: None,
            measured_from: None,
            lived_us: 0,
            achieved: 0.0,
        }
    }

    fn wall_passed(&mut self, now: Instant) {
        let passed_s = self.last.map_or(0.0, |last| (now - last).as_secs_f64());
        self.last = Some(now);
        self.due_us =
            (self.due_us + passed_s * self.speed * 1e6).min(CATCH_UP_S * self.speed * 1e6);
        let from = *self.measured_from.get_or_insert(now);
        let measured_s = (now - from).as_secs_f64();
        if measured_s >= 1.0 {
            self.achieved = self.lived_us as f64 / 1e6 / measured_s;
            self.measured_from = Some(now);
            self.lived_us = 0;
        }
    }

    fn slice_due(&self) -> bool {
        self.due_us >= SLICE_US as f64
    }

    fn slice_lived(&mut self) {
        self.due_us -= SLICE_US as f64;
        self.lived_us += SLICE_US;
    }

    fn achieved(&self) -> f64 {
        self.achieved
    }
}
