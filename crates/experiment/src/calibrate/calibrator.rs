//! A [`Calibrator`] into which time and bytes go, and a robot to drive it with.

use super::error::CalibrateError;
use super::link::Link;
use super::{Calibration, procedure};
use rumbo_sim::Sim;
use std::fmt;
use std::pin::Pin;
use std::task::{Context, Poll, Waker};

/// The procedure, up to its result.
type Course = Pin<Box<dyn Future<Output = Result<Calibration, CalibrateError>>>>;

/// A calibration in progress: no thread, no clock; its driver passes on time and bytes.
pub struct Calibrator {
    link: Link,
    /// Until it has ended.
    course: Option<Course>,
}

impl Calibrator {
    /// A calibration that begins at this instant [us].
    #[must_use]
    pub fn new(now_us: u64) -> Self {
        let link = Link::default();
        link.arrive(now_us, &[]);
        Self {
            course: Some(Box::pin(procedure::course(link.clone()))),
            link,
        }
    }

    /// It is this instant [us], and these bytes have arrived from the robot. Appends those to send; returns the result
    /// when it has ended.
    pub fn advance(
        &mut self,
        now_us: u64,
        received: &[u8],
        to_robot: &mut Vec<u8>,
    ) -> Option<Result<Calibration, CalibrateError>> {
        self.link.arrive(now_us, received);
        let course = self.course.as_mut()?;
        let polled = course
            .as_mut()
            .poll(&mut Context::from_waker(Waker::noop()));
        self.link.take(to_robot);
        match polled {
            Poll::Pending => None,
            Poll::Ready(result) => {
                self.course = None;
                Some(result)
            }
        }
    }

    /// When it next has something to do [us].
    #[must_use]
    pub fn due_us(&self) -> u64 {
        self.link.due_us()
    }
}

impl fmt::Debug for Calibrator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Calibrator")
            .field("link", &self.link)
            .finish_non_exhaustive()
    }
}

/// A simulated robot that receives and sends bytes as time passes.
pub trait Linked {
    /// Time on this side of the link [us].
    fn now_us(&self) -> u64;
    /// Sends bytes to the robot.
    fn send(&mut self, bytes: &[u8]);
    /// Appends the bytes that have arrived from the robot.
    fn receive(&mut self, into: &mut Vec<u8>);
    /// Simulates until this instant [us].
    fn advance(&mut self, us: u64);
}

impl Linked for Sim {
    fn now_us(&self) -> u64 {
        Sim::now_us(self)
    }

    fn send(&mut self, bytes: &[u8]) {
        Sim::send(self, bytes);
    }

    fn receive(&mut self, into: &mut Vec<u8>) {
        Sim::receive(self, into);
    }

    fn advance(&mut self, us: u64) {
        Sim::advance(self, us);
    }
}

/// Calibrates a simulated robot that stands beside a wall, along it, with free floor ahead. It is left disarmed, with
/// the parameters found.
///
/// # Errors
/// Why it failed; the robot is stopped.
pub fn calibrate<R: Linked>(robot: &mut R) -> Result<Calibration, CalibrateError> {
    let mut calibrator = Calibrator::new(robot.now_us());
    let (mut received, mut to_robot) = (Vec::new(), Vec::new());
    loop {
        let ended = calibrator.advance(robot.now_us(), &received, &mut to_robot);
        robot.send(&to_robot);
        to_robot.clear();
        if let Some(result) = ended {
            return result;
        }
        robot.advance(calibrator.due_us());
        received.clear();
        robot.receive(&mut received);
    }
}
