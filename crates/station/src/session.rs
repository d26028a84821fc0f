//! The session: lets the target live, paced by the wall clock, and passes on what it says and what is asked of it.
//!
//! Its thread wakes every [`WAKE`], or at once for an order; advances the target in slices for the time that passed times the
//! speed factor ([`Pace`]); feeds what arrived to the [`RobotClient`] and what that heard to the [`Observer`], who
//! keeps the board up to date. Nothing waits for a page.

mod calibrating;
mod commanding;
mod recording;

use crate::board::Board;
use crate::client::{Heard, KnownTable, RobotClient};
use crate::guest::{Calibration, Guest};
use crate::observer::Observer;
use crate::observer::describe::{Around, describe};
use crate::orders::{self, MAX_SPEED, Order};
use crate::pace::{Pace, SLICE_US};
use crate::recorder::Recording;
use crate::target::{LinkNews, Target};
use crate::watch::LinkWatch;
use rumbo_control::mode::ModeId;
use rumbo_log::{CalibrationState, Choice, Level, State};
use rumbo_wire::Command;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::{Duration, Instant};

/// Time between two looks at the link while time passes.
const WAKE: Duration = Duration::from_millis(5);
/// The same while paused: an order wakes the session anyway.
const WAKE_PAUSED: Duration = Duration::from_millis(250);
/// Longest time spent on one round of slices: orders wait no longer, however high the speed factor.
const ROUND: Duration = Duration::from_millis(20);
/// The slow state is noted this often, and at once when it matters.
const STATE_PERIOD: Duration = Duration::from_millis(200);

/// What a session can do besides, if whoever starts it gives it the means.
#[derive(Clone, Copy, Debug, Default)]
pub struct Extras {
    /// The robot runs the original program, which is silent until its first ON: it is spoken to in text from the
    /// beginning.
    pub text: bool,
    /// How the robot calibrates itself.
    pub calibration: Option<Calibration>,
}

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
    observer: Observer,
    board: Arc<Board>,
    /// Where to record; nowhere in tests.
    recording: Option<Recording>,
    extras: Extras,
    /// The calibration that drives the robot now, and how the last one stands.
    guest: Option<Guest>,
    calibration: Option<CalibrationState>,
    orders: Orders,
    pace: Pace,
    simulated: bool,
    state_noted: Option<Instant>,
    /// The movement that a key holds, and until when without a word from the page.
    held: Option<(Command, Instant)>,
    /// The robot has been told what to begin with.
    briefed: bool,
    /// The port is waited for.
    port_gone: bool,
    link_watch: LinkWatch,
    /// Kept to spare allocations.
    heard: Vec<Heard>,
    bytes: Vec<u8>,
}

impl Session {
    /// A session that has not begun yet.
    pub(crate) fn new(
        mut target: Box<dyn Target>,
        board: Arc<Board>,
        orders: Orders,
        speed: f64,
        recording: Option<Recording>,
        extras: Extras,
    ) -> Self {
        let simulated = target.simulation().is_some();
        Self {
            client: new_client(target.as_mut(), extras),
            target,
            observer: Observer::new(Arc::clone(&board)),
            board,
            recording,
            extras,
            guest: None,
            calibration: None,
            orders,
            pace: Pace::new(if simulated {
                speed.clamp(0.0, MAX_SPEED)
            } else {
                1.0
            }),
            simulated,
            state_noted: None,
            held: None,
            briefed: false,
            port_gone: false,
            link_watch: LinkWatch::default(),
            heard: Vec::new(),
            bytes: Vec::new(),
        }
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
        self.record();
        self.show_scene();
        loop {
            let wait = if self.pace.speed > 0.0 {
                WAKE
            } else {
                WAKE_PAUSED
            };
            let first = match self.orders.queue.recv_timeout(wait) {
                Ok(order) => Some(order),
                Err(RecvTimeoutError::Timeout) => None,
                // The robot is not left driving. Should this be lost, the missing heartbeat stops it.
                Err(RecvTimeoutError::Disconnected) => return self.command(Command::Stop),
            };
            let waiting = first
                .into_iter()
                .chain(self.orders.queue.try_iter())
                .collect();
            let stop = self.orders.stop.swap(false, Ordering::SeqCst);
            for order in orders::stop_first(waiting, stop) {
                if !self.is_taken(&order) {
                    self.obey(order)?;
                }
            }
            self.let_go()?;
            self.live()?;
            self.publish();
        }
    }

    fn obey(&mut self, order: Order) -> Result<(), String> {
        match order {
            Order::Robot(command) => {
                self.held = None;
                return self.command(command);
            }
            Order::Hold(command) => return self.hold(command),
            Order::Route(commands) => {
                self.held = None;
                return self.commands(commands);
            }
            Order::Type(usart, line) => return self.type_in(usart, &line),
            Order::Speed(factor) if self.simulated => {
                self.pace = Pace::new(factor);
                self.state_noted = None;
            }
            Order::Speed(_) => self.note(
                Level::Warning,
                "speed: refused, a real robot lives at its own".into(),
            ),
            Order::Reset(choice) => self.reset(&choice),
            Order::Calibrate => self.calibrate(),
            Order::TakeControl | Order::ReleaseControl => {}
            Order::RestartGhost => self.restart_ghost(),
            Order::Seek(_) | Order::Step(_) => {
                self.note(Level::Warning, "refused, this is no replay of a log".into())
            }
        }
        Ok(())
    }

    fn send(&mut self) -> Result<(), String> {
        self.bytes.clear();
        self.client
            .poll(self.target.now_us(), &mut self.bytes, &mut self.heard);
        if self.bytes.is_empty() {
            return Ok(());
        }
        self.note_bytes(true);
        self.target.send(&self.bytes)
    }

    fn reset(&mut self, choice: &Choice) {
        let Some(simulation) = self.target.simulation() else {
            return self.note(
                Level::Warning,
                "reset: refused, this is a real robot".into(),
            );
        };
        if let Err(why) = simulation.reset(choice) {
            return self.note(Level::Warning, format!("reset: refused, {why}"));
        }
        self.client = new_client(self.target.as_mut(), self.extras);
        self.heard.clear();
        self.held = None;
        self.calibration = None;
        self.briefed = false;
        self.record();
        self.observer.start_run();
        self.pace = Pace::new(self.pace.speed);
        self.state_noted = None;
        self.show_scene();
        let world = choice
            .world
            .as_ref()
            .map(|world| format!(" in world {world}"))
            .unwrap_or_default();
        let rig = choice.rig.as_ref();
        let rig = rig
            .map(|rig| format!(" with rig {rig}"))
            .unwrap_or_default();
        self.note(
            Level::Info,
            format!(
                "reset: {}{world}{rig}, seed {}",
                choice.scenario, choice.seed
            ),
        );
    }

    fn show_scene(&mut self) {
        let scene = self
            .target
            .simulation()
            .map(|simulation| simulation.scene());
        let scene = scene.or_else(|| self.target.surroundings());
        self.observer.show_scene(scene);
    }

    /// Lets the target live for the time due.
    fn live(&mut self) -> Result<(), String> {
        let now = Instant::now();
        self.pace.wall_passed(now);
        while self.pace.slice_due() {
            self.target.advance(SLICE_US)?;
            self.pace.slice_lived();
            let now_us = self.target.now_us();
            if let Some(pose) = self.target.ghost() {
                self.observer.ghost(to_ms(now_us), pose);
            }
            if let Some(simulation) = self.target.simulation() {
                self.observer.truth(to_ms(now_us), simulation.truth());
                self.observer.consoles(now_us, simulation.consoles());
                for news in simulation.news() {
                    self.observer.note(to_ms(now_us), Level::Warning, news);
                }
                if let Some(why) = simulation.ended() {
                    self.observer.note(to_ms(now_us), Level::Fault, why);
                }
            }
            self.bytes.clear();
            self.target.receive(&mut self.bytes);
            self.note_bytes(false);
            if !self.simulated && self.client.speaks_text() {
                self.observer.said_in_text(&self.bytes);
            }
            self.client.hear(&self.bytes, now_us, &mut self.heard);
            self.take_turns(now_us)?;
            self.send()?;
            self.observer
                .digest(&mut self.heard, &mut self.client, to_ms(now_us));
            self.brief()?;
            if now.elapsed() >= ROUND {
                break;
            }
        }
        Ok(())
    }

    fn note(&mut self, level: Level, text: String) {
        self.observer.note(to_ms(self.target.now_us()), level, text);
    }

    fn publish(&mut self) {
        let now_ms = to_ms(self.target.now_us());
        self.observer
            .digest(&mut self.heard, &mut self.client, now_ms);
        while let Some(news) = self.target.news() {
            let (level, text) = match news {
                LinkNews::Lost(text) => (Level::Fault, text),
                LinkNews::Back(text) => (Level::Good, text),
                LinkNews::GhostFault(fault) => {
                    let why = format!("the ghost has stopped: {}", fault.explanation());
                    self.note(Level::Warning, why);
                    continue;
                }
            };
            self.port_gone = level == Level::Fault;
            self.note(level, text);
            if self.port_gone {
                self.give_up_calibration("the port is gone");
                self.client.port_is_gone();
            }
        }
        if let Some(trouble) = self.board.recording_trouble() {
            self.note(Level::Warning, trouble.to_string());
        }
        self.watch_link();
        let urgent = self.observer.publish(now_ms);
        let now = Instant::now();
        if urgent
            || self
                .state_noted
                .is_none_or(|noted| now >= noted + STATE_PERIOD)
        {
            self.state_noted = Some(now);
            let state = self.state();
            self.observer.show_state(state);
        }
    }

    /// Says what is wrong with a real link.
    fn watch_link(&mut self) {
        if self.simulated || self.client.other_protocol().is_some() {
            return;
        }
        let (now_us, connected) = (self.target.now_us(), self.client.connected());
        let (figures, dropped) = (self.client.link(now_us), self.observer.status().dropped);
        let baud = self.target.baud();
        let trouble = self
            .link_watch
            .look(now_us, &figures, connected, dropped, baud);
        if let Some(trouble) = trouble {
            self.note(Level::Warning, trouble);
        }
    }

    fn state(&mut self) -> State {
        let simulation = self.target.simulation();
        let around = Around {
            true_battery_v: simulation.map(|simulation| simulation.truth().battery_v),
            t_us: self.target.now_us(),
            simulated: self.simulated,
            speed: self.pace.speed,
            achieved_speed: self.pace.achieved(),
            baud: self.target.baud(),
        };
        State {
            calibration: self.calibration.clone(),
            ..describe(&around, &mut self.client, &self.observer)
        }
    }
}

fn to_ms(us: u64) -> i64 {
    (us / 1_000) as i64
}

fn new_client(target: &mut dyn Target, extras: Extras) -> RobotClient {
    let simulation = target.simulation();
    let clock_known = simulation.is_some();
    match simulation.and_then(|simulation| simulation.speaks_text()) {
        Some(mode) => RobotClient::of_text(mode, clock_known),
        None if extras.text => RobotClient::of_text(ModeId::default(), clock_known),
        None => RobotClient::new(random_session(), clock_known, KnownTable::OURS),
    }
}

/// A session id; from the clock where there is no randomness to be had.
fn random_session() -> u8 {
    let clock = std::time::SystemTime::UNIX_EPOCH
        .elapsed()
        .map_or(0, |elapsed| elapsed.subsec_micros());
    getrandom::u32().unwrap_or(clock).to_le_bytes()[0]
}
