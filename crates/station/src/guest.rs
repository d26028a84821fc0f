//! A procedure that drives the robot for a while, such as a calibration, as a guest on the session's link.
//!
//! It runs in its own thread and sends its own commands; the session forwards the received bytes to it and its bytes to
//! the robot, and goes on displaying and recording. In each time slice it gets a turn and the session waits for its
//! answer, so that a fast simulation does not outrun it. When the session takes the link back, its waits end at once.

use rumbo_log::Findings;
use rumbo_session::CalibrationError;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::Duration;

/// Longest wait for a guest's answer: its final computation takes no longer, and STOP waits at most this long.
const PATIENCE: Duration = Duration::from_millis(20);

/// Calibrates the robot at the other end of the link and sets the parameters found; or returns why not.
pub type Calibration = fn(&mut GuestLink) -> Result<Findings, CalibrationError>;

/// A time slice: its end \[us\] and the bytes received.
type Slice = (u64, Vec<u8>);

/// The guest's end of the link.
#[derive(Debug)]
pub struct GuestLink {
    now_us: u64,
    slices: Receiver<Slice>,
    answers: Sender<Vec<u8>>,
    received: Vec<u8>,
    to_send: Vec<u8>,
}

impl GuestLink {
    /// Time of the session \[us\].
    #[must_use]
    pub fn now_us(&self) -> u64 {
        self.now_us
    }

    /// Queues bytes for the robot.
    pub fn send(&mut self, bytes: &[u8]) {
        self.to_send.extend_from_slice(bytes);
    }

    /// Appends the bytes received from the robot.
    pub fn receive(&mut self, into: &mut Vec<u8>) {
        into.append(&mut self.received);
    }

    /// Waits until this instant \[us\]; returns at once when the session has taken the link back.
    pub fn wait_until(&mut self, us: u64) {
        while self.now_us < us {
            let answered = self.answers.send(std::mem::take(&mut self.to_send));
            match answered.ok().and_then(|()| self.slices.recv().ok()) {
                Some((now_us, bytes)) => {
                    self.now_us = now_us;
                    self.received.extend(bytes);
                }
                None => self.now_us = us,
            }
        }
    }
}

/// The session's end.
#[derive(Debug)]
pub(crate) struct Guest {
    slices: Sender<Slice>,
    answers: Receiver<Vec<u8>>,
    thread: JoinHandle<Result<Findings, CalibrationError>>,
}

impl Guest {
    /// Starts a guest.
    ///
    /// # Errors
    /// If no thread can be started.
    pub(crate) fn invite(calibration: Calibration, now_us: u64) -> Result<Self, CalibrationError> {
        let (slices, arriving) = channel();
        let (send, answers) = channel();
        let mut link = GuestLink {
            now_us,
            slices: arriving,
            answers: send,
            received: Vec::new(),
            to_send: Vec::new(),
        };
        let thread = std::thread::Builder::new()
            .name("calibration".into())
            .spawn(move || calibration(&mut link))
            .map_err(|error| CalibrationError::NoThread(error.to_string()))?;
        Ok(Self {
            slices,
            answers,
            thread,
        })
    }

    /// The guest's turn: passes it the received bytes and returns those it sends. `None`: it has ended.
    pub(crate) fn turn(&self, now_us: u64, arrived: &[u8]) -> Option<Vec<u8>> {
        let said = match self.answers.recv_timeout(PATIENCE) {
            Ok(said) => said,
            Err(RecvTimeoutError::Timeout) => Vec::new(),
            Err(RecvTimeoutError::Disconnected) => return None,
        };
        // A guest that has left in between is detected at its next turn.
        let _ = self.slices.send((now_us, arrived.to_vec()));
        Some(said)
    }

    /// Its findings, after it has ended by itself.
    pub(crate) fn findings(self) -> Result<Findings, CalibrationError> {
        let joined = self.thread.join();
        joined.unwrap_or(Err(CalibrationError::Panicked))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn echo(link: &mut GuestLink) -> Result<Findings, CalibrationError> {
        let mut received = Vec::new();
        while received.len() < 3 {
            let next = link.now_us() + 1_000;
            link.wait_until(next);
            let before = received.len();
            link.receive(&mut received);
            link.send(&received[before..]);
        }
        link.wait_until(link.now_us() + 1);
        let parameters = received.iter().map(|byte| (*byte, 0.0)).collect();
        Ok(Findings {
            rows: Vec::new(),
            parameters,
        })
    }

    fn endless(link: &mut GuestLink) -> Result<Findings, CalibrationError> {
        for _ in 0..1_000 {
            link.wait_until(link.now_us() + 1_000_000);
        }
        Err(CalibrationError::Stopped)
    }

    #[test]
    fn a_guest_receives_and_sends_in_turn_and_returns_its_findings() {
        let guest = Guest::invite(echo, 0).unwrap();
        let mut said = Vec::new();
        for slice in 1_u64.. {
            let byte = [slice as u8];
            match guest.turn(slice * 5_000, &byte[..usize::from(slice <= 3)]) {
                Some(bytes) => said.extend(bytes),
                None => break,
            }
        }
        assert_eq!(said, [1, 2, 3]);
        assert_eq!(guest.findings().unwrap().parameters.len(), 3);
    }

    #[test]
    fn waits_end_for_a_guest_whose_link_is_taken_back() {
        let guest = Guest::invite(endless, 0).unwrap();
        guest.turn(5_000, &[]);
        let Guest {
            slices,
            answers,
            thread,
            ..
        } = guest;
        drop((slices, answers));
        assert_eq!(thread.join().unwrap(), Err(CalibrationError::Stopped));
    }
}
