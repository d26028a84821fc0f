//! The session: turns received bytes into events, and orders into bytes.
//!
//! Its driver calls, in this order and with both clocks: [`Session::order`] for each order, [`Session::expire_hold`];
//! for each slice of the target's time [`Session::observe`], [`Session::receive`] and [`Session::advance`]; then
//! [`Session::update`]. After each call there may be bytes to send ([`Session::take_bytes`]) and events to publish
//! ([`Session::take_events`]). Nothing blocks.

mod calibrating;
mod commanding;
mod playing;

use crate::client::{KnownTable, LinkEvent, RobotClient};
use crate::error::{CalibrationError, TargetError};
use crate::event::Event;
use crate::guest::Guest;
use crate::observer::Observer;
use crate::observer::describe::{Around, describe};
use crate::orders::Order;
use crate::program::GivenProgram;
use crate::target::{About, LinkNews, Shown, Standing};
use crate::watch::LinkWatch;
use crate::world::WorldOrder;
use rumbo_control::mode::ModeId;
use rumbo_log::{
    Burst, CalibrationState, Choice, ExperimentState, Level, ProgramState, State, Truth,
};
use rumbo_wire::{Command, GUEST_SESSION};
use serde_json::Value;

/// The slow state is published this often, and at once when it matters \[us\].
const STATE_PERIOD_US: u64 = 200_000;

/// The time now.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Now {
    /// The target's: since its start or last reset \[us\].
    pub target_us: u64,
    /// That of the operator, which also runs while the target is paused: since an arbitrary instant \[us\].
    pub wall_us: u64,
}

impl Now {
    fn target_ms(self) -> i64 {
        to_ms(self.target_us)
    }
}

/// A request to the target's driver; its result is reported to the session.
#[derive(Clone, Debug, PartialEq)]
pub enum Ask {
    /// Run it at this many seconds per second of the wall clock.
    Pace(f64),
    /// Start it again; then [`Session::restart`].
    Reset(Choice),
    /// To show, check or drive in a world.
    World(WorldOrder),
    /// Send a line to a USART; then [`Session::typed`].
    Type(u8, String),
    /// Put the ghost there; then [`Session::ghost_restarted`].
    Ghost(Standing),
    /// Run this program; why not is reported as a note.
    Program(GivenProgram),
    /// Show the source of its program, or of an example.
    Sketch(u32, Option<String>),
    /// A request to the debugger of its program.
    Debug(Value),
    /// Count the cycles of its program, or no longer.
    Profile(bool),
    /// Cut the supply of its motors, or give it back.
    Supply(bool),
    /// Calibrate the robot; then [`Session::calibration_begun`].
    Calibrate,
    /// Start it again, commanded by its scenario; these are the robot's parameters. Then [`Session::play_begun`].
    Play(Vec<(u8, f32)>),
}

/// What is known of a target besides the bytes of its robot.
#[derive(Clone, Debug, Default)]
pub struct TargetView {
    /// Ground truth.
    pub truth: Option<Truth>,
    /// The ghost's.
    pub ghost: Option<Truth>,
    /// What the USARTs of an emulated chip have sent.
    pub consoles: Vec<(u8, Vec<u8>)>,
    /// What is shown of it beside its telemetry, if a reading is due.
    pub shown: Vec<Shown>,
    /// What its scenario has sent to the robot.
    pub scripted: Vec<Burst>,
}

/// The target's progress.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Going {
    /// Requested seconds of its time per second of the wall clock.
    pub speed: f64,
    /// The same, measured.
    pub achieved_speed: f64,
    /// The voltage of its battery, where that is known \[V\].
    pub true_battery_v: Option<f64>,
    /// The program of an emulated robot.
    pub program: Option<ProgramState>,
    /// The scenario that commands the robot, or has done so.
    pub experiment: Option<ExperimentState>,
}

/// A session with one target.
#[derive(Debug)]
pub struct Session {
    about: About,
    /// The robot runs the original program, which is silent until its first ON.
    text: bool,
    client: RobotClient,
    observer: Observer,
    /// The running calibration and its start \[us\], and the state of the last one.
    calibrating: Option<(Box<dyn Guest>, u64)>,
    calibration: Option<CalibrationState>,
    /// Calibrations asked for, in all runs.
    calibrations: u32,
    state_noted_us: Option<u64>,
    /// The movement held by a key, and when it expires unless the page repeats it \[us\].
    held: Option<(Command, u64)>,
    /// A velocity was refused: when that was said \[us\].
    velocity_refused_us: Option<u64>,
    /// The robot has been sent its first commands.
    briefed: bool,
    /// STOP or OFF cut the supply of its motors.
    motors_cut: bool,
    /// The scenario commands the robot, and the session only listens.
    playing: bool,
    /// The port is gone and not back yet.
    port_gone: bool,
    link_watch: LinkWatch,
    link_events: Vec<LinkEvent>,
    to_robot: Vec<u8>,
}

impl Session {
    /// A session that has not begun yet. `id` is to be random; with `text` the robot is addressed in text from the
    /// beginning.
    #[must_use]
    pub fn new(about: About, id: u8, text: bool) -> Self {
        let mut session = Self {
            client: new_client(&about, id, text),
            about,
            text,
            observer: Observer::new(),
            calibrating: None,
            calibration: None,
            calibrations: 0,
            state_noted_us: None,
            held: None,
            velocity_refused_us: None,
            briefed: false,
            motors_cut: false,
            playing: false,
            port_gone: false,
            link_watch: LinkWatch::default(),
            link_events: Vec::new(),
            to_robot: Vec::new(),
        };
        session.show_scene();
        session
    }

    /// The target was reset, or refused it: a new run begins, with another random `id`, or nothing has changed.
    pub fn restart(&mut self, choice: &Choice, done: Result<About, TargetError>, id: u8, now: Now) {
        let about = match done {
            Ok(about) => about,
            Err(why) => return self.note(Level::Warning, format!("reset: refused, {why}"), now),
        };
        self.begin_run(about, id);
        let part = |what: &str, name: &Option<String>| {
            let name = name.as_ref();
            name.map_or_else(String::new, |name| format!(" {what} {name}"))
        };
        let text = format!(
            "reset: {}{}{}, seed {}",
            choice.scenario,
            part("in world", &choice.world),
            part("with rig", &choice.rig),
            choice.seed
        );
        self.note(Level::Info, text, now);
    }

    /// The target has started again by itself, with a changed program.
    pub fn renew(&mut self, about: About, id: u8, now: Now) {
        self.begin_run(about, id);
        let text = "the changed program runs, from the start";
        self.note(Level::Good, text.into(), now);
    }

    fn begin_run(&mut self, about: About, id: u8) {
        self.client = new_client(&about, id, self.text);
        self.about = about;
        self.link_events.clear();
        self.to_robot.clear();
        self.held = None;
        self.velocity_refused_us = None;
        self.calibrating = None;
        self.calibration = None;
        self.briefed = false;
        (self.motors_cut, self.playing) = (false, false);
        self.state_noted_us = None;
        self.observer.start_run();
        self.show_scene();
    }

    /// Executes an order of the page; returns the request to the target, if any.
    pub fn order(&mut self, order: Order, now: Now) -> Option<Ask> {
        if self.is_taken(&order, now) || self.is_played(&order, now) {
            return None;
        }
        let abilities = self.about.abilities;
        match order {
            Order::Robot(command) => {
                self.held = None;
                self.command(command, now);
                return self.supply(command);
            }
            Order::Hold(command) => self.hold(command, now),
            Order::Velocity(velocity) => self.velocity(velocity, now),
            Order::Route(commands) => {
                self.held = None;
                self.commands(commands, now);
            }
            Order::Type(usart, line) => return self.type_in(usart, line, now),
            Order::Speed(factor) if abilities.pace => {
                self.state_noted_us = None;
                return Some(Ask::Pace(factor));
            }
            Order::Speed(_) => {
                let text = "speed: refused, a real robot runs in real time";
                self.note(Level::Warning, text.into(), now);
            }
            Order::Reset(choice) if abilities.reset => return Some(Ask::Reset(choice)),
            Order::Reset(_) => {
                let text = "reset: refused, this is a real robot";
                self.note(Level::Warning, text.into(), now);
            }
            Order::World(order) if abilities.reset => return Some(Ask::World(order)),
            Order::World(_) => {
                let text = "world: refused, this is a real robot";
                self.note(Level::Warning, text.into(), now);
            }
            Order::Calibrate => return self.may_calibrate(now),
            Order::Play if abilities.play => {
                return Some(Ask::Play(self.observer.parameter_values()));
            }
            Order::Play => self.play_begun(Err(TargetError::NoReset), 0, now),
            Order::TakeControl | Order::ReleaseControl => {}
            Order::RestartGhost => return Some(Ask::Ghost(self.observer.standing())),
            Order::Program(program) => return Some(Ask::Program(program)),
            Order::Sketch(ticket, example) => return Some(Ask::Sketch(ticket, example)),
            Order::Debug(request) => return Some(Ask::Debug(request)),
            Order::Profile(on) => return Some(Ask::Profile(on)),
            Order::Seek(_) | Order::Step(_) => {
                let text = "refused, this is no replay of a log";
                self.note(Level::Warning, text.into(), now);
            }
        }
        None
    }

    /// Takes what is known of the target now.
    pub fn observe(&mut self, sight: TargetView, now: Now) {
        if let Some(truth) = sight.ghost {
            self.observer.ghost(now.target_ms(), truth);
        }
        if let Some(truth) = sight.truth {
            self.observer.truth(now.target_ms(), truth);
        }
        self.observer.shown(now.target_ms(), sight.shown);
        self.observer.consoles(now.target_us, sight.consoles);
        for burst in sight.scripted {
            self.client.said(burst.bytes.len(), now.target_us);
            self.observer.link(burst);
        }
    }

    /// Takes the bytes received from the robot, and gives a guest its turn.
    pub fn receive(&mut self, bytes: &[u8], now: Now) {
        self.note_bytes(bytes, false, now);
        if self.about.abilities.port && self.client.speaks_text() {
            self.observer.said_in_text(bytes, now.target_ms());
        }
        self.client
            .receive(bytes, now.target_us, &mut self.link_events);
        self.advance_guest(bytes, now);
    }

    /// Time has passed: queues the bytes due, and turns link events into events.
    pub fn advance(&mut self, now: Now) {
        self.say(now);
        self.digest(now);
        self.brief(now);
    }

    /// Something happened to the target.
    pub fn news(&mut self, news: LinkNews, now: Now) {
        let (level, text) = match news {
            LinkNews::Lost(text) => {
                self.port_gone = true;
                self.note(Level::Fault, text, now);
                self.calibration_ended(Err(CalibrationError::PortGone), now);
                return self.client.port_is_gone();
            }
            LinkNews::Back(text) => {
                self.port_gone = false;
                (Level::Good, text)
            }
            LinkNews::GhostFault(fault) => {
                let why = fault.explanation();
                (Level::Warning, format!("the ghost has stopped: {why}"))
            }
            LinkNews::Held(text) => (Level::Warning, text),
            LinkNews::Ended(why) => (Level::Fault, why),
            LinkNews::Program(level, text) => (level, text),
            // Its driver begins the new run.
            LinkNews::Renewed => return,
        };
        self.note(level, text, now);
    }

    /// Publishes the samples, and the state if it is due.
    pub fn update(&mut self, going: Going, now: Now) {
        self.digest(now);
        self.watch_link(now);
        self.watch_play(&going, now);
        let urgent = self.observer.publish(now.target_ms());
        let due = |noted_us: u64| now.wall_us >= noted_us + STATE_PERIOD_US;
        if urgent || self.state_noted_us.is_none_or(due) {
            self.state_noted_us = Some(now.wall_us);
            let state = self.state(going, now);
            self.observer.show_state(state);
        }
    }

    /// Shows a message on the page.
    pub fn note(&mut self, level: Level, text: String, now: Now) {
        self.observer.note(now.target_ms(), level, text);
    }

    /// The bytes to be sent to the robot now.
    pub fn take_bytes(&mut self) -> Vec<u8> {
        std::mem::take(&mut self.to_robot)
    }

    /// The events since the last call.
    pub fn take_events(&mut self) -> Vec<Event> {
        self.observer.take_events()
    }

    fn say(&mut self, now: Now) {
        if self.playing {
            return;
        }
        let mut bytes = Vec::new();
        self.client
            .poll(now.target_us, &mut bytes, &mut self.link_events);
        self.send(&bytes, now);
    }

    fn send(&mut self, bytes: &[u8], now: Now) {
        self.note_bytes(bytes, true, now);
        self.to_robot.extend_from_slice(bytes);
    }

    fn note_bytes(&mut self, bytes: &[u8], to_robot: bool, now: Now) {
        if !bytes.is_empty() {
            self.observer.link(Burst {
                t_us: now.target_us,
                to_robot,
                bytes: bytes.to_vec(),
            });
        }
    }

    fn digest(&mut self, now: Now) {
        self.observer
            .digest(&mut self.link_events, &mut self.client, now.target_ms());
    }

    fn show_scene(&mut self) {
        self.observer.show_scene(self.about.scene.clone());
    }

    /// Reports trouble on a port's link.
    fn watch_link(&mut self, now: Now) {
        if !self.about.abilities.port || self.client.other_protocol().is_some() {
            return;
        }
        let (now_us, connected) = (now.target_us, self.client.connected());
        let (figures, dropped) = (self.client.link(now_us), self.observer.status().dropped);
        let baud = self.about.baud;
        // The original program waits for its first ON.
        let quiet = self.client.speaks_text();
        let trouble = self
            .link_watch
            .look(now_us, &figures, connected, dropped, baud, quiet);
        if let Some(trouble) = trouble {
            self.note(Level::Warning, trouble, now);
        }
    }

    fn state(&mut self, going: Going, now: Now) -> State {
        let around = Around {
            true_battery_v: going.true_battery_v,
            t_us: now.target_us,
            simulated: self.about.abilities.pace || !self.about.abilities.port,
            speed: going.speed,
            achieved_speed: going.achieved_speed,
            baud: self.about.baud,
        };
        State {
            calibration: self.calibration.clone(),
            program: going.program,
            motors_cut: self.motors_cut,
            experiment: going.experiment,
            ..describe(&around, &mut self.client, &self.observer)
        }
    }
}

fn to_ms(us: u64) -> i64 {
    (us / 1_000) as i64
}

fn new_client(about: &About, id: u8, text: bool) -> RobotClient {
    let clock_known = about.abilities.clock;
    match about.abilities.text {
        Some(mode) => RobotClient::of_text(mode, clock_known),
        None if text => RobotClient::of_text(ModeId::default(), clock_known),
        None => {
            let id = if id == GUEST_SESSION { !id } else { id };
            RobotClient::new(id, clock_known, KnownTable::OURS)
        }
    }
}
