//! Drives a session: connects it and its target, paced by a wall clock that the caller reads.
//!
//! The caller's loop is [`SessionDriver::obey`] for the orders that have come, [`SessionDriver::wall_passed`], [`SessionDriver::slice`] while
//! one is due and the caller has time, and [`SessionDriver::update`]. The driver passes what happens in the target to the
//! [`Session`], the session's bytes to the target, and its events to the [`Host`].

use crate::error::{CalibrationError, TargetError};
use crate::event::Event;
use crate::guest::Guest;
use crate::orders::{MAX_SPEED, Order};
use crate::pace::{Pace, SLICE_US};
use crate::session::{Ask, Going, Now, Session, TargetView};
use crate::target::{About, LinkNews, Target};
use crate::world::{EditedWorld, WorldAct, WorldOrder};
use rumbo_log::{Choice, Level, Manifest};

/// Begins a calibration of the robot at this instant \[us\].
pub type Calibration = fn(u64) -> Box<dyn Guest>;

/// Options of a session.
#[derive(Clone, Copy, Debug, Default)]
pub struct Extras {
    /// The robot runs the original program, which is silent until its first ON: it is addressed in text from the
    /// beginning.
    pub text: bool,
    /// How the robot calibrates itself.
    pub calibration: Option<Calibration>,
}

/// The program around a driver.
pub trait Host {
    /// A random number that distinguishes sessions.
    fn random_id(&mut self) -> u8;

    /// Takes an event.
    fn publish(&mut self, event: Event);

    /// A run of this manifest begins: a log begins too, where one is kept. Returns what to say about it.
    fn begin_run(&mut self, manifest: Manifest) -> Option<(Level, String)>;
}

/// A session with its target.
pub struct SessionDriver<H, T: ?Sized = dyn Target> {
    target: Box<T>,
    session: Session,
    host: H,
    calibration: Option<Calibration>,
    pace: Pace,
    /// Kept to spare allocations.
    bytes: Vec<u8>,
}

impl<H: Host, T: Target + ?Sized> SessionDriver<H, T> {
    /// A session at `speed`, in seconds of the target per second of the wall clock, that has not begun yet. Times of
    /// the wall clock are \[us\] since any instant, and never decrease.
    pub fn new(target: Box<T>, mut host: H, speed: f64, extras: Extras) -> Self {
        let about = About::of(target.as_ref());
        let speed = match about.abilities.pace {
            true => speed.clamp(0.0, MAX_SPEED),
            false => 1.0,
        };
        Self {
            session: Session::new(about, host.random_id(), extras.text),
            target,
            host,
            calibration: extras.calibration,
            pace: Pace::new(speed),
            bytes: Vec::new(),
        }
    }

    /// The program around it.
    pub fn host(&mut self) -> &mut H {
        &mut self.host
    }

    /// The same, for good.
    pub fn into_host(self) -> H {
        self.host
    }

    /// What is driven.
    pub fn target(&mut self) -> &mut T {
        &mut self.target
    }

    /// The target's time since its start or last reset \[us\].
    #[must_use]
    pub fn target_us(&self) -> u64 {
        self.target.now_us()
    }

    /// The requested speed; 0 is a pause.
    #[must_use]
    pub fn speed(&self) -> f64 {
        self.pace.speed
    }

    fn now(&self, wall_us: u64) -> Now {
        Now {
            target_us: self.target.now_us(),
            wall_us,
        }
    }

    /// Begins the first run.
    pub fn begin(&mut self, wall_us: u64) {
        let manifest = self.target.manifest();
        let manifest = Manifest {
            version: env!("CARGO_PKG_VERSION").into(),
            baud: self.target.baud(),
            // An experiment goes in the steps of a run.
            step_us: match manifest.step_us {
                0 => SLICE_US,
                own => own,
            },
            ..manifest
        };
        if let Some((level, text)) = self.host.begin_run(manifest) {
            self.note(level, text, wall_us);
        }
        self.publish();
    }

    /// Earlier events belong to the previous run.
    fn begin_again(&mut self, wall_us: u64) {
        self.publish();
        self.pace = Pace::new(self.pace.speed);
        self.begin(wall_us);
    }

    /// Executes orders, in this order ([`crate::stop_first`]); to be called without any, too: a movement held by a key
    /// may be over.
    ///
    /// # Errors
    /// When the target is gone for good.
    pub fn obey(
        &mut self,
        orders: impl IntoIterator<Item = Order>,
        wall_us: u64,
    ) -> Result<(), TargetError> {
        for order in orders {
            if let Some(ask) = self.session.order(order, self.now(wall_us)) {
                self.act(ask, wall_us);
            }
            if !self.session.is_playing() {
                self.target.end_play();
            }
            // At once: STOP does not wait for the next slice.
            self.send()?;
        }
        self.session.expire_hold(self.now(wall_us));
        self.send()
    }

    fn act(&mut self, ask: Ask, wall_us: u64) {
        let now = self.now(wall_us);
        match ask {
            Ask::Pace(factor) => self.pace = Pace::new(factor),
            Ask::Type(usart, line) => {
                let sent = self.target.type_in(usart, &line);
                self.session.typed(usart, &line, sent, now);
            }
            Ask::Program(program) => {
                if let Err(why) = self.target.run_program(program) {
                    self.note(Level::Warning, format!("program: refused, {why}"), wall_us);
                }
            }
            Ask::Sketch(ticket, example) => {
                let mut sketch = self.target.sketch(example.as_deref());
                sketch.ticket = ticket;
                self.host.publish(Event::Sketch(sketch));
            }
            Ask::Debug(request) => {
                if let Err(why) = self.target.ask_debugger(&request) {
                    self.note(Level::Warning, format!("debugger: {why}"), wall_us);
                }
                self.pass_debug();
            }
            Ask::Profile(on) => {
                if let Err(why) = self.target.profile(on) {
                    self.note(Level::Warning, format!("profile: refused, {why}"), wall_us);
                }
            }
            Ask::Supply(on) => self.target.supply_motors(on),
            Ask::Ghost(standing) => {
                let done = self.target.restart_ghost(standing);
                self.session.ghost_restarted(done, now);
            }
            Ask::Calibrate => {
                let calibration = self.calibration.ok_or(CalibrationError::Missing);
                let begun = calibration.map(|begin| begin(now.target_us));
                self.session.calibration_begun(begun, now);
            }
            Ask::Play(parameters) => {
                let done = self.target.play(&parameters);
                if done.is_ok() {
                    self.begin_again(wall_us);
                }
                let done = done.map(|()| About::of(self.target.as_ref()));
                let (id, now) = (self.host.random_id(), self.now(wall_us));
                self.session.play_begun(done, id, now);
            }
            Ask::Reset(choice) => {
                let done = self.target.reset(&choice);
                self.restarted(&choice, done, wall_us);
            }
            Ask::World(order) => {
                let world = self.edit(&order, wall_us);
                self.host.publish(Event::World(world));
            }
        }
    }

    /// The target was reset, or refused it.
    fn restarted(&mut self, choice: &Choice, done: Result<(), TargetError>, wall_us: u64) {
        if done.is_ok() {
            self.begin_again(wall_us);
        }
        let done = done.map(|()| About::of(self.target.as_ref()));
        let (id, now) = (self.host.random_id(), self.now(wall_us));
        self.session.restart(choice, done, id, now);
    }

    fn edit(&mut self, order: &WorldOrder, wall_us: u64) -> EditedWorld {
        let WorldOrder { ticket, act, text } = order;
        let mut world = match act {
            WorldAct::Show => self.target.world(None),
            WorldAct::Check => self.target.world(Some(text)),
            WorldAct::Drive => EditedWorld::default(),
        };
        world.ticket = *ticket;
        if *act == WorldAct::Drive {
            match self.target.drive_in(text) {
                Ok(choice) => {
                    world.driven = true;
                    self.restarted(&choice, Ok(()), wall_us);
                }
                Err(why) => world.problem = Some(why.to_string()),
            }
        }
        world
    }

    /// The wall clock says so: time of the target becomes due.
    pub fn wall_passed(&mut self, wall_us: u64) {
        self.pace.wall_passed(wall_us);
    }

    /// Advances the target by a slice if one is due; returns whether it was.
    ///
    /// # Errors
    /// When the target is gone for good.
    pub fn slice(&mut self, wall_us: u64) -> Result<bool, TargetError> {
        if !self.pace.slice_due() {
            return Ok(false);
        }
        self.pace.slice_lived();
        self.step(wall_us)?;
        Ok(true)
    }

    /// Advances the target by a slice, whether one is due or not: for a driver that follows another one's clock.
    ///
    /// # Errors
    /// When the target is gone for good.
    pub fn step(&mut self, wall_us: u64) -> Result<(), TargetError> {
        self.target.advance(SLICE_US)?;
        let now = self.now(wall_us);
        let sight = TargetView {
            truth: self.target.truth(),
            ghost: self.target.ghost(),
            consoles: self.target.consoles(),
            shown: self.target.shown(),
            scripted: self.target.scripted(),
        };
        self.session.observe(sight, now);
        self.bytes.clear();
        self.target.receive(&mut self.bytes);
        self.session.receive(&self.bytes, now);
        self.session.advance(now);
        self.send()?;
        self.news(wall_us);
        Ok(())
    }

    /// Follows the clock of `leader`.
    pub fn follow(&mut self, leader: &Self) {
        self.pace = leader.pace;
    }

    fn news(&mut self, wall_us: u64) {
        while let Some(news) = self.target.news() {
            if news == LinkNews::Renewed {
                self.begin_again(wall_us);
                let about = About::of(self.target.as_ref());
                let (id, now) = (self.host.random_id(), self.now(wall_us));
                self.session.renew(about, id, now);
            } else {
                self.session.news(news, self.now(wall_us));
            }
        }
    }

    /// Passes on what the debugger says.
    fn pass_debug(&mut self) {
        for message in self.target.take_debug() {
            self.host.publish(Event::Debug(message));
        }
    }

    /// Publishes what is new.
    pub fn update(&mut self, wall_us: u64) {
        self.news(wall_us);
        self.pass_debug();
        let going = Going {
            speed: self.pace.speed,
            achieved_speed: self.pace.achieved(),
            true_battery_v: self.target.truth().map(|truth| truth.battery_v),
            program: self.target.program(),
            experiment: self.target.experiment(),
        };
        self.session.update(going, self.now(wall_us));
        self.publish();
    }

    /// Shows a message on the page, with the next events.
    pub fn note(&mut self, level: Level, text: String, wall_us: u64) {
        self.session.note(level, text, self.now(wall_us));
    }

    /// Passes the events on to the host.
    pub fn publish(&mut self) {
        for event in self.session.take_events() {
            self.host.publish(event);
        }
    }

    fn send(&mut self) -> Result<(), TargetError> {
        let bytes = self.session.take_bytes();
        match bytes.is_empty() {
            true => Ok(()),
            false => self.target.send(&bytes),
        }
    }
}
