//! The session's thread: advances the target, paced by the wall clock, and connects it, the pages and the session.
//!
//! It wakes every [`WAKE`], or at once for an order; advances the target in slices by the elapsed time times the speed
//! factor ([`Pace`]), and passes the results to the [`Session`], which returns the bytes to send and the events to
//! publish. Nothing waits for a page.

use crate::log_file::LogError;
use crate::recorder::{Recorder, now_utc};
use crate::recordings::Recordings;
use crate::subscribers::Subscribers;
use rumbo_log::{Level, Manifest};
use rumbo_session::{
    About, Ask, CalibrationError, Going, Guest, LinkNews, MAX_SPEED, Now, Order, Pace, SLICE_US,
    Session, Sight, Target, TargetError, stop_first,
};
use rumbo_wire::Command;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::{Duration, Instant};

/// Time between two polls of the link while time passes.
const WAKE: Duration = Duration::from_millis(5);
/// The same while paused: an order wakes the session anyway.
const WAKE_PAUSED: Duration = Duration::from_millis(250);
/// Longest time spent on one round of slices: orders wait no longer, however high the speed factor.
const ROUND: Duration = Duration::from_millis(20);

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

/// The source of orders.
pub(crate) struct Orders {
    /// The orders, in order. The session ends when the sending side is gone.
    pub(crate) queue: Receiver<Order>,
    /// STOP, set beside the queue so that a full queue cannot keep it out.
    pub(crate) stop: Arc<AtomicBool>,
}

/// The session, its target and its subscribers.
pub(crate) struct Driver {
    target: Box<dyn Target>,
    session: Session,
    subscribers: Subscribers,
    /// Where to record; nowhere in tests.
    recordings: Option<Arc<Recordings>>,
    calibration: Option<Calibration>,
    orders: Orders,
    pace: Pace,
    began: Instant,
    /// Kept to spare allocations.
    bytes: Vec<u8>,
}

impl Driver {
    /// A session that has not begun yet.
    pub(crate) fn new(
        target: Box<dyn Target>,
        subscribers: Subscribers,
        orders: Orders,
        speed: f64,
        recordings: Option<Arc<Recordings>>,
        extras: Extras,
    ) -> Self {
        let about = About::of(target.as_ref());
        let speed = match about.abilities.pace {
            true => speed.clamp(0.0, MAX_SPEED),
            false => 1.0,
        };
        Self {
            session: Session::new(about, random_id(), extras.text),
            target,
            subscribers,
            recordings,
            calibration: extras.calibration,
            orders,
            pace: Pace::new(speed),
            began: Instant::now(),
            bytes: Vec::new(),
        }
    }

    /// Runs until the sender of orders is gone.
    ///
    /// # Errors
    /// The target's error when it is gone for good.
    pub(crate) fn run(mut self) -> Result<(), TargetError> {
        self.record();
        let ended = self.run_until_ended();
        if let Err(why) = &ended {
            self.note(Level::Fault, format!("the robot is gone: {why}"));
        }
        self.publish();
        ended
    }

    fn run_until_ended(&mut self) -> Result<(), TargetError> {
        loop {
            let wait = if self.pace.speed > 0.0 {
                WAKE
            } else {
                WAKE_PAUSED
            };
            let first = match self.orders.queue.recv_timeout(wait) {
                Ok(order) => Some(order),
                Err(RecvTimeoutError::Timeout) => None,
                // Do not leave the robot driving. Should this STOP be lost, the missing heartbeat stops it.
                Err(RecvTimeoutError::Disconnected) => {
                    return self.obey(Order::Robot(Command::Stop));
                }
            };
            let waiting = first
                .into_iter()
                .chain(self.orders.queue.try_iter())
                .collect();
            let stop = self.orders.stop.swap(false, Ordering::SeqCst);
            for order in stop_first(waiting, stop) {
                self.obey(order)?;
            }
            self.session.expire_hold(self.now());
            self.send()?;
            self.advance()?;
            self.update();
        }
    }

    fn now(&self) -> Now {
        let wall = self.began.elapsed().as_micros();
        Now {
            target_us: self.target.now_us(),
            wall_us: u64::try_from(wall).unwrap_or(u64::MAX),
        }
    }

    fn obey(&mut self, order: Order) -> Result<(), TargetError> {
        let ask = self.session.order(order, self.now());
        if let Some(ask) = ask {
            self.act(ask);
        }
        // At once: STOP does not wait for the next slice.
        self.send()
    }

    fn act(&mut self, ask: Ask) {
        let now = self.now();
        match ask {
            Ask::Pace(factor) => self.pace = Pace::new(factor),
            Ask::Type(usart, line) => {
                let sent = self.target.type_in(usart, &line);
                self.session.typed(usart, &line, sent, now);
            }
            Ask::Program(name, content) => {
                if let Err(why) = self.target.run_program(name, content) {
                    self.note(Level::Warning, format!("program: refused, {why}"));
                }
            }
            Ask::Ghost(standing) => {
                let done = self.target.restart_ghost(standing);
                self.session.ghost_restarted(done, now);
            }
            Ask::Calibrate => {
                let calibration = self.calibration.ok_or(CalibrationError::Missing);
                let begun = calibration.map(|begin| begin(now.target_us));
                self.session.calibration_begun(begun, now);
            }
            Ask::Reset(choice) => {
                let done = self.target.reset(&choice);
                if done.is_ok() {
                    self.begin_run();
                }
                let done = done.map(|()| About::of(self.target.as_ref()));
                self.session.restart(&choice, done, random_id(), self.now());
            }
        }
    }

    /// Earlier events belong to the previous run.
    fn begin_run(&mut self) {
        self.publish();
        self.pace = Pace::new(self.pace.speed);
        self.record();
    }

    /// Advances the target by the time due.
    fn advance(&mut self) -> Result<(), TargetError> {
        let began = Instant::now();
        self.pace.wall_passed(self.now().wall_us);
        while self.pace.slice_due() {
            self.target.advance(SLICE_US)?;
            self.pace.slice_lived();
            let now = self.now();
            let sight = Sight {
                truth: self.target.truth(),
                ghost: self.target.ghost(),
                consoles: self.target.consoles(),
                instruments: self.target.instruments(),
            };
            self.session.observe(sight, now);
            self.bytes.clear();
            self.target.receive(&mut self.bytes);
            self.session.receive(&self.bytes, now);
            self.session.advance(now);
            self.send()?;
            self.news();
            if began.elapsed() >= ROUND {
                break;
            }
        }
        Ok(())
    }

    fn news(&mut self) {
        while let Some(news) = self.target.news() {
            if news == LinkNews::Renewed {
                self.begin_run();
                let about = About::of(self.target.as_ref());
                self.session.renew(about, random_id(), self.now());
            } else {
                self.session.news(news, self.now());
            }
        }
    }

    fn update(&mut self) {
        self.news();
        if let Some(trouble) = self.subscribers.recording_trouble() {
            self.note(Level::Warning, trouble.to_string());
        }
        let going = Going {
            speed: self.pace.speed,
            achieved_speed: self.pace.achieved(),
            true_battery_v: self.target.truth().map(|truth| truth.battery_v),
            program: self.target.program(),
        };
        self.session.update(going, self.now());
        self.publish();
    }

    fn note(&mut self, level: Level, text: String) {
        self.session.note(level, text, self.now());
    }

    fn send(&mut self) -> Result<(), TargetError> {
        let bytes = self.session.take_bytes();
        match bytes.is_empty() {
            true => Ok(()),
            false => self.target.send(&bytes),
        }
    }

    fn publish(&mut self) {
        for event in self.session.take_events() {
            self.subscribers.publish(event);
        }
    }

    /// Begins the log of a run; the one before is complete.
    fn record(&mut self) {
        let Some(recordings) = &self.recordings else {
            return;
        };
        let (level, text) = match self.recorder(recordings) {
            Ok(recorder) => {
                recordings.set_current(recorder.path());
                let text = format!("recording to {}", recorder.path().display());
                self.subscribers.record(recorder);
                (Level::Info, text)
            }
            Err(error) => (Level::Warning, format!("not recording: {error}")),
        };
        self.note(level, text);
        self.publish();
    }

    fn recorder(&self, recordings: &Recordings) -> Result<Recorder, LogError> {
        let manifest = Manifest {
            version: env!("CARGO_PKG_VERSION").into(),
            baud: self.target.baud(),
            step_us: SLICE_US,
            started: Some(now_utc()),
            ..self.target.manifest()
        };
        Recorder::in_folder(recordings.folder(), &manifest)
    }
}

/// A random number that distinguishes sessions; from the clock if the system has no randomness.
fn random_id() -> u8 {
    let clock = std::time::SystemTime::UNIX_EPOCH
        .elapsed()
        .map_or(0, |elapsed| elapsed.subsec_micros());
    getrandom::u32().unwrap_or(clock).to_le_bytes()[0]
}
