//! `rumbo lab --pty`: the simulated robot as a serial port for other programs, without a dashboard of its own.

use crate::failure::Failure;
use crate::output;
use rumbo_session::Target;
use rumbo_station::port::Pty;
use std::time::{Duration, Instant};

/// The simulation advances in steps of this length \[us\].
const STEP_US: u64 = 5_000;
/// Longest wait for the other side of the link, so that the loop does not spin.
const PATIENCE: Duration = Duration::from_millis(5);
/// A simulation that is late by more lets the rest go \[us\].
const CATCH_UP_US: u64 = 100_000;

/// Offers the robot until the process is ended. Prints the name of the port first thing.
pub(crate) fn offer(mut robot: impl Target, speed: f64) -> Result<(), Failure> {
    let mut pty = open(PATIENCE)?;
    output::line(pty.path())?;
    let mut bytes = Vec::new();
    let (mut last, mut due_us) = (Instant::now(), 0);
    loop {
        bytes.clear();
        pty.read(&mut bytes);
        robot.send(&bytes).map_err(Failure::input)?;
        let passed_us = last.elapsed().as_secs_f64() * 1e6;
        last = Instant::now();
        due_us =
            (due_us + (passed_us * speed) as u64).min((CATCH_UP_US as f64 * speed.max(1.0)) as u64);
        while due_us >= STEP_US {
            due_us -= STEP_US;
            robot.advance(STEP_US).map_err(Failure::input)?;
        }
        bytes.clear();
        robot.receive(&mut bytes);
        pty.write(&bytes);
        // Those of the USB port go to its own terminal; nobody looks at the others.
        robot.consoles();
    }
}

/// A terminal for another program.
fn open(patience: Duration) -> Result<Pty, Failure> {
    Pty::new(patience).map_err(|error| {
        Failure::Input(format!(
            "no pseudo terminal to be had ({error}); close other programs that use some"
        ))
    })
}

/// The USB port of an emulated Mega for another program, beside whatever else the robot is offered to.
pub(crate) struct UsbPort {
    pty: Pty,
    /// Kept to spare allocations.
    bytes: Vec<u8>,
}

impl UsbPort {
    /// Opens it and prints its name and whose it is.
    pub(crate) fn offer(board: &str) -> Result<Self, Failure> {
        // The session's thread does not wait.
        let pty = open(Duration::ZERO)?;
        output::aside(&format!("Serial (USB) of the {board}: {}", pty.path()));
        Ok(Self {
            pty,
            bytes: Vec::new(),
        })
    }
}

impl rumbo_lab::Cable for UsbPort {
    fn read(&mut self) -> &[u8] {
        self.bytes.clear();
        self.pty.read(&mut self.bytes);
        &self.bytes
    }

    fn write(&mut self, bytes: &[u8]) {
        self.pty.write(bytes);
    }
}
