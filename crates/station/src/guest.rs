//! A procedure that drives the robot by itself for a while, a calibration, as a guest on the session's link.
//!
//! It runs in a thread of its own and speaks to the robot with its own commands; the session lends it the bytes that arrive, passes on the
//! bytes that it sends, and goes on showing and recording. With each slice of time it gets its turn and the session waits for its answer,
//! so that a fast simulation does not run away from it. When the session takes the link back, time ends for it at once.

use rumbo_log::Findings;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::Duration;

/// Longest wait for a guest's answer: computing at its end takes no longer, and STOP waits this long at most.
const PATIENCE: Duration = Duration::from_millis(20);

/// Calibrates the robot at the other end of the link, which is left with the parameters found; or says why not.
pub type Calibration = fn(&mut GuestLink) -> Result<Findings, String>;

/// A slice of time: when it ended \[us\], and what arrived.
type Slice = (u64, Vec<u8>);

/// The guest's end of the link.
#[derive(Debug)]
pub struct GuestLink {
    now_us: u64,
    slices: Receiver<Slice>,
    answers: Sender<Vec<u8>>,
    heard: Vec<u8>,
    to_say: Vec<u8>,
}

impl GuestLink {
    /// Time of the session \[us\].
    #[must_use]
    pub fn now_us(&self) -> u64 {
        self.now_us
    }

    /// Puts bytes for the robot on the line.
    pub fn send(&mut self, bytes: &[u8]) {
        self.to_say.extend_from_slice(bytes);
    }

    /// Appends the bytes that have arrived from the robot.
    pub fn receive(&mut self, into: &mut Vec<u8>) {
        into.append(&mut self.heard);
    }

    /// Lets time go by until this instant \[us\]; at once when the session has taken the link back.
    pub fn wait_until(&mut self, us: u64) {
        while self.now_us < us {
            let answered = self.answers.send(std::mem::take(&mut self.to_say));
            match answered.ok().and_then(|()| self.slices.recv().ok()) {
                Some((now_us, bytes)) => {
                    self.now_us = now_us;
                    self.heard.extend(bytes);
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
    thread: JoinHandle<Result<Findings, String>>,
}

impl Guest {
    /// Invites a guest.
    ///
    /// # Errors
    /// The system gives no thread.
    pub(crate) fn invite(calibration: Calibration, now_us: u64) -> Result<Self, String> {
        let (slices, heard) = channel();
        let (say, answers) = channel();
        let mut link = GuestLink {
            now_us,
            slices: heard,
            answers: say,
            heard: Vec::new(),
            to_say: Vec::new(),
        };
        let thread = std::thread::Builder::new()
            .name("calibration".into())
            .spawn(move || calibration(&mut link))
            .map_err(|error| format!("no thread for it ({error})"))?;
        Ok(Self {
            slices,
            answers,
            thread,
        })
    }

    /// The guest's turn: it gets what arrived, and gives what it has to say. `None`: it has left.
    pub(crate) fn turn(&self, now_us: u64, arrived: &[u8]) -> Option<Vec<u8>> {
        let said = match self.answers.recv_timeout(PATIENCE) {
            Ok(said) => said,
            Err(RecvTimeoutError::Timeout) => Vec::new(),
            Err(RecvTimeoutError::Disconnected) => return None,
        };
        // One that has left in between is found out at its next turn.
        let _ = self.slices.send((now_us, arrived.to_vec()));
        Some(said)
    }

    /// What it found, when it has left by itself.
    pub(crate) fn findings(self) -> Result<Findings, String> {
        let fault = || Err("it ended by a fault of its own; please report it".into());
        self.thread.join().unwrap_or_else(|_| fault())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn echo(link: &mut GuestLink) -> Result<Findings, String> {
        let mut heard = Vec::new();
        while heard.len() < 3 {
            let next = link.now_us() + 1_000;
            link.wait_until(next);
            let before = heard.len();
            link.receive(&mut heard);
            link.send(&heard[before..]);
        }
        link.wait_until(link.now_us() + 1);
        let parameters = heard.iter().map(|byte| (*byte, 0.0)).collect();
        Ok(Findings {
            rows: Vec::new(),
            parameters,
        })
    }

    fn endless(link: &mut GuestLink) -> Result<Findings, String> {
        for _ in 0..1_000 {
            link.wait_until(link.now_us() + 1_000_000);
        }
        Err("given up".into())
    }

    #[test]
    fn a_guest_hears_and_speaks_in_turn_and_tells_what_it_found() {
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
    fn time_ends_for_a_guest_whose_link_is_taken_back() {
        let guest = Guest::invite(endless, 0).unwrap();
        guest.turn(5_000, &[]);
        let Guest {
            slices,
            answers,
            thread,
            ..
        } = guest;
        drop((slices, answers));
        assert_eq!(thread.join().unwrap(), Err("given up".into()));
    }
}
