//! The session's thread: drives it by the wall clock, and connects it with the pages and the log.
//!
//! It wakes every [`WAKE`], or at once for an order, and has the [`Driver`] advance the target by the time due. Nothing
//! waits for a page.

use crate::log_file::LogError;
use crate::recorder::{Recorder, now_utc};
use crate::recordings::Recordings;
use crate::subscribers::Subscribers;
use rumbo_log::{Level, Manifest};
use rumbo_session::{Driver, Event, Extras, Host, Order, Target, TargetError, stop_first};
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

/// The source of orders.
pub(crate) struct Orders {
    /// The orders, in order. The session ends when the sending side is gone.
    pub(crate) queue: Receiver<Order>,
    /// STOP, set beside the queue so that a full queue cannot keep it out.
    pub(crate) stop: Arc<AtomicBool>,
}

/// The subscribers of a session and its recordings.
struct Around {
    subscribers: Subscribers,
    /// Where to record; nowhere in tests.
    recordings: Option<Arc<Recordings>>,
}

impl Host for Around {
    /// From the clock if the system has no randomness.
    fn random_id(&mut self) -> u8 {
        let clock = std::time::SystemTime::UNIX_EPOCH
            .elapsed()
            .map_or(0, |elapsed| elapsed.subsec_micros());
        getrandom::u32().unwrap_or(clock).to_le_bytes()[0]
    }

    fn publish(&mut self, event: Event) {
        self.subscribers.publish(event);
    }

    /// Begins the log of the run; the one before is complete.
    fn begin_run(&mut self, manifest: Manifest) -> Option<(Level, String)> {
        let recordings = self.recordings.as_ref()?;
        Some(match recorder(recordings, manifest) {
            Ok(recorder) => {
                let text = format!("recording to {}", recorder.path().display());
                self.subscribers.record(recorder);
                (Level::Info, text)
            }
            Err(error) => (Level::Warning, format!("not recording: {error}")),
        })
    }
}

fn recorder(recordings: &Recordings, manifest: Manifest) -> Result<Recorder, LogError> {
    let manifest = Manifest {
        started: Some(now_utc()),
        ..manifest
    };
    Recorder::in_folder(recordings.folder(), &manifest)
}

/// The session of one of several robots, which follows the clock of the first.
struct Follower {
    driver: Driver<Around>,
    orders: Orders,
}

/// A session in its thread, perhaps with those of other robots in the same world.
pub(crate) struct Running {
    driver: Driver<Around>,
    orders: Orders,
    followers: Vec<Follower>,
    began: Instant,
}

/// What a session is made of.
pub(crate) struct Seat {
    pub(crate) target: Box<dyn Target>,
    pub(crate) subscribers: Subscribers,
    pub(crate) orders: Orders,
}

impl Running {
    /// A session that has not begun yet, and those of the robots that go with its time.
    pub(crate) fn new(
        first: Seat,
        others: Vec<Seat>,
        speed: f64,
        recordings: Option<Arc<Recordings>>,
        extras: Extras,
    ) -> Self {
        let begin = |seat: Seat| {
            let around = Around {
                subscribers: seat.subscribers,
                recordings: recordings.clone(),
            };
            let driver = Driver::new(seat.target, around, speed, extras);
            (driver, seat.orders)
        };
        let (driver, orders) = begin(first);
        let followers = others.into_iter().map(begin);
        let followers = followers.map(|(driver, orders)| Follower { driver, orders });
        Self {
            driver,
            orders,
            followers: followers.collect(),
            began: Instant::now(),
        }
    }

    /// Runs until the sender of orders is gone.
    ///
    /// # Errors
    /// The target's error when it is gone for good.
    pub(crate) fn run(mut self) -> Result<(), TargetError> {
        let wall_us = self.wall_us();
        self.driver.begin(wall_us);
        for follower in &mut self.followers {
            follower.driver.begin(wall_us);
        }
        let ended = self.run_until_ended();
        if let Err(why) = &ended {
            let text = format!("the robot is gone: {why}");
            self.driver.note(Level::Fault, text, self.wall_us());
        }
        self.driver.publish();
        for follower in &mut self.followers {
            follower.driver.publish();
        }
        // All logs are completed at once, and before anything else is done: whoever waits for us may not wait for long.
        let followers = self.followers.iter_mut().map(|each| &mut each.driver);
        let drivers = std::iter::once(&mut self.driver).chain(followers);
        let recorders = drivers.filter_map(|driver| driver.host().subscribers.recorder.take());
        let mut recorders: Vec<Recorder> = recorders.collect();
        recorders.iter_mut().for_each(Recorder::end);
        drop(recorders);
        ended
    }

    fn run_until_ended(&mut self) -> Result<(), TargetError> {
        loop {
            // Orders to the other robots wake nobody.
            let wait = match self.driver.speed() > 0.0 || !self.followers.is_empty() {
                true => WAKE,
                false => WAKE_PAUSED,
            };
            let first = match self.orders.queue.recv_timeout(wait) {
                Ok(order) => Some(order),
                Err(RecvTimeoutError::Timeout) => None,
                // Do not leave the robot driving. Should this STOP be lost, the missing heartbeat stops it.
                Err(RecvTimeoutError::Disconnected) => {
                    let stop = || [Order::Robot(Command::Stop)];
                    let wall_us = self.wall_us();
                    for follower in &mut self.followers {
                        follower.driver.obey(stop(), wall_us)?;
                    }
                    return self.driver.obey(stop(), wall_us);
                }
            };
            obey(&mut self.driver, &self.orders, first, self.began)?;
            for Follower { driver, orders } in &mut self.followers {
                driver.follow(&self.driver);
                obey(driver, orders, None, self.began)?;
            }
            self.advance()?;
            if let Some(trouble) = self.driver.host().subscribers.recording_trouble() {
                let text = trouble.to_string();
                self.driver.note(Level::Warning, text, self.wall_us());
            }
            let wall_us = self.wall_us();
            self.driver.update(wall_us);
            for follower in &mut self.followers {
                follower.driver.update(wall_us);
            }
        }
    }

    fn wall_us(&self) -> u64 {
        since_us(self.began)
    }

    /// Advances the target by the time due.
    fn advance(&mut self) -> Result<(), TargetError> {
        let began = Instant::now();
        self.driver.wall_passed(self.wall_us());
        while began.elapsed() < ROUND && self.driver.slice(self.wall_us())? {
            let wall_us = self.wall_us();
            for follower in &mut self.followers {
                follower.driver.step(wall_us)?;
            }
        }
        Ok(())
    }
}

fn since_us(began: Instant) -> u64 {
    u64::try_from(began.elapsed().as_micros()).unwrap_or(u64::MAX)
}

/// Executes the orders that wait, after the `first` one.
fn obey(
    driver: &mut Driver<Around>,
    orders: &Orders,
    first: Option<Order>,
    began: Instant,
) -> Result<(), TargetError> {
    let waiting: Vec<Order> = first.into_iter().chain(orders.queue.try_iter()).collect();
    driver.host().subscribers.board.took(waiting.len());
    let stop = orders.stop.swap(false, Ordering::SeqCst);
    driver.obey(stop_first(waiting, stop), since_us(began))
}
