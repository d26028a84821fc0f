//! The session's thread: drives it by the wall clock, and connects it with the pages and the log.
//!
//! It wakes every [`WAKE`], or at once for an order, and has the [`SessionDriver`] advance the target by the time due. Nothing
//! waits for a page.

use crate::log_file::LogError;
use crate::recorder::{Recorder, now_utc};
use crate::recordings::Recordings;
use crate::subscribers::Subscribers;
use rumbo_log::{Level, Manifest};
use rumbo_session::{Event, Extras, Host, Order, SessionDriver, Target, TargetError, stop_first};
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

/// The session of a robot.
struct Robot {
    driver: SessionDriver<Around>,
    orders: Orders,
}

/// The sessions of the robots in a world in their thread: the others follow the clock of the first.
pub(crate) struct Running {
    robots: Vec<Robot>,
    began: Instant,
}

/// What a session is made of.
pub(crate) struct Seat {
    pub(crate) target: Box<dyn Target>,
    pub(crate) subscribers: Subscribers,
    pub(crate) orders: Orders,
}

impl Running {
    /// Sessions that have not begun yet.
    pub(crate) fn new(
        seats: impl Iterator<Item = Seat>,
        speed: f64,
        recordings: Option<Arc<Recordings>>,
        extras: Extras,
    ) -> Self {
        let robots = seats.map(|seat| {
            let around = Around {
                subscribers: seat.subscribers,
                recordings: recordings.clone(),
            };
            Robot {
                driver: SessionDriver::new(seat.target, around, speed, extras),
                orders: seat.orders,
            }
        });
        Self {
            robots: robots.collect(),
            began: Instant::now(),
        }
    }

    /// Runs until the sender of the first one's orders is gone.
    ///
    /// # Errors
    /// The target's error when it is gone for good.
    pub(crate) fn run(mut self) -> Result<(), TargetError> {
        let wall_us = self.wall_us();
        for robot in &mut self.robots {
            robot.driver.begin(wall_us);
        }
        let ended = self.run_until_ended();
        let wall_us = self.wall_us();
        if let (Err(why), Some(first)) = (&ended, self.robots.first_mut()) {
            let text = format!("the robot is gone: {why}");
            first.driver.note(Level::Fault, text, wall_us);
        }
        for robot in &mut self.robots {
            robot.driver.publish();
        }
        // All logs are completed at once, and before anything else is done: whoever waits for us may not wait for long.
        let robots = self.robots.iter_mut();
        let recorders = robots.filter_map(|robot| robot.driver.host().subscribers.recorder.take());
        let mut recorders: Vec<Recorder> = recorders.collect();
        recorders.iter_mut().for_each(Recorder::end);
        drop(recorders);
        ended
    }

    fn run_until_ended(&mut self) -> Result<(), TargetError> {
        let began = self.began;
        while let Some((first, others)) = self.robots.split_first_mut() {
            // Orders to the other robots wake nobody.
            let wait = match first.driver.speed() > 0.0 || !others.is_empty() {
                true => WAKE,
                false => WAKE_PAUSED,
            };
            let order = match first.orders.queue.recv_timeout(wait) {
                Ok(order) => Some(order),
                Err(RecvTimeoutError::Timeout) => None,
                Err(RecvTimeoutError::Disconnected) => return self.stop(),
            };
            first.obey(order, began)?;
            for other in &mut *others {
                other.driver.follow(&first.driver);
                other.obey(None, began)?;
            }
            advance(first, others, began)?;
            if let Some(trouble) = first.driver.host().subscribers.recording_trouble() {
                let text = trouble.to_string();
                first.driver.note(Level::Warning, text, since_us(began));
            }
            let wall_us = since_us(began);
            for robot in &mut self.robots {
                robot.driver.update(wall_us);
            }
        }
        Ok(())
    }

    /// Leaves no robot driving. Should this STOP be lost, the missing heartbeat stops it.
    fn stop(&mut self) -> Result<(), TargetError> {
        let wall_us = self.wall_us();
        let robots = self.robots.iter_mut();
        let stopped = robots.map(|robot| robot.driver.obey([Order::Robot(Command::Stop)], wall_us));
        // All of them, also after an error.
        stopped.collect::<Vec<_>>().into_iter().collect()
    }

    fn wall_us(&self) -> u64 {
        since_us(self.began)
    }
}

/// Advances the first one's target by the time due, and the others with it.
fn advance(first: &mut Robot, others: &mut [Robot], began: Instant) -> Result<(), TargetError> {
    let round = Instant::now();
    first.driver.wall_passed(since_us(began));
    while round.elapsed() < ROUND && first.driver.slice(since_us(began))? {
        let wall_us = since_us(began);
        for other in &mut *others {
            other.driver.step(wall_us)?;
        }
    }
    Ok(())
}

impl Robot {
    /// Executes the orders that wait, after the `first` one.
    fn obey(&mut self, first: Option<Order>, began: Instant) -> Result<(), TargetError> {
        let waiting = first.into_iter().chain(self.orders.queue.try_iter());
        let waiting: Vec<Order> = waiting.collect();
        self.driver.host().subscribers.board.took(waiting.len());
        let stop = self.orders.stop.swap(false, Ordering::SeqCst);
        self.driver.obey(stop_first(waiting, stop), since_us(began))
    }
}

fn since_us(began: Instant) -> u64 {
    u64::try_from(began.elapsed().as_micros()).unwrap_or(u64::MAX)
}
