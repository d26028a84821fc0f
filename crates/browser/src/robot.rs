//! A session with a real robot, and the one page that it has.

use crate::desk::{Desk, Place, ROUND_US};
use crate::recording::{SOME, Saving};
use crate::serial_port::SerialPort;
use rumbo_log::Level;
use rumbo_session::{BaudTooLow, Extras, Order, TargetError, check_baud, stop_first};
use rumbo_wire::Command;
use std::io;

/// Longest time spent on a file of the recording in one round \[us\]: the heartbeat does not wait for it.
const SAVING_US: u64 = 4_000;

/// A robot at a serial port of the page.
pub struct Robot {
    desk: Desk<SerialPort>,
    /// By the wall clock \[us\].
    opened_us: u64,
    saving: Option<Saving>,
}

impl Robot {
    /// A session with the robot at the port of this name. With `text` it runs the original program, which is silent
    /// until its first ON. `ids` gives random numbers, which tell its sessions apart; `wall_us` is a clock that never
    /// goes back \[us\], `day_ms` the time of day \[ms since 1970\].
    ///
    /// # Errors
    /// A link of this speed carries too few heartbeats.
    pub fn new(
        port: String,
        baud: u32,
        text: bool,
        ids: fn() -> u8,
        wall_us: u64,
        day_ms: f64,
    ) -> Result<Self, BaudTooLow> {
        let warning = check_baud(baud)?;
        let extras = Extras {
            text,
            calibration: Some(rumbo_lab::calibration),
        };
        let port = Box::new(SerialPort::new(port, baud));
        let mut desk = Desk::new(port, Place::default(), extras, ids, wall_us, day_ms);
        if let Some(warning) = warning {
            desk.driver.note(Level::Warning, warning, wall_us);
        }
        Ok(Self {
            desk,
            opened_us: wall_us,
            saving: None,
        })
    }

    /// These bytes arrived from the robot.
    pub fn arrived(&mut self, bytes: &[u8]) {
        self.desk.driver.target().arrived(bytes);
    }

    /// The bytes for the robot since the last call.
    pub fn take_outgoing(&mut self) -> Vec<u8> {
        self.desk.driver.target().take_outgoing()
    }

    /// The port is gone, and why; it is being waited for.
    pub fn lost(&mut self, why: &str) {
        self.desk.driver.target().lost(why);
    }

    /// The port is open again, or another one of this name is in its place.
    pub fn back(&mut self, name: &str) {
        self.desk.driver.target().back(name);
    }

    /// Takes an order of the page, to be executed in the next round; what is refused is reported with the next news.
    pub fn order(&mut self, json: &str) {
        self.desk.order(json);
    }

    /// Warns the page, with the next news.
    pub fn warn(&mut self, text: String) {
        self.desk.warn(text);
    }

    /// Executes the orders, STOP first, and takes what has arrived. `wall_us` reads a clock that never goes back
    /// \[us\]; `day_ms` is the time of day \[ms since 1970\].
    ///
    /// # Errors
    /// The robot is gone for good, which one at a port never is.
    pub fn advance(&mut self, wall_us: impl Fn() -> u64, day_ms: f64) -> Result<(), TargetError> {
        let began_us = wall_us();
        let since = |wall_us: u64| wall_us.saturating_sub(self.opened_us);
        let driver = &mut self.desk.driver;
        driver.host().day_ms = day_ms;
        driver.target().set_now(since(began_us));
        let waiting = self.desk.take_orders();
        let driver = &mut self.desk.driver;
        let stop = waiting.contains(&Order::Robot(Command::Stop));
        driver.obey(stop_first(waiting, stop), began_us)?;
        driver.wall_passed(began_us);
        let mut now_us = began_us;
        while now_us < began_us + ROUND_US && driver.slice(now_us)? {
            now_us = wall_us();
            driver.target().set_now(since(now_us));
        }
        driver.update(now_us);
        if std::mem::take(&mut driver.host().full) {
            self.warn("the recording is full: save it, and connect again for another one".into());
        }
        Ok(())
    }

    /// What is new to the page, as JSON.
    pub fn news(&mut self) -> Vec<String> {
        self.desk.news(None)
    }

    /// When the session began: time of day \[ms since 1970\].
    pub fn began_ms(&mut self) -> f64 {
        let recording = self.desk.recording();
        recording.map_or(0.0, |recording| recording.began_ms)
    }

    /// Begins to write the session so far as a log, which [`Robot::saved`] gives out; `started` is when it began, as a
    /// manifest has it.
    ///
    /// # Errors
    /// Why it cannot be written.
    pub fn save(&mut self, started: String) -> io::Result<()> {
        if let Some(recording) = self.desk.recording() {
            self.saving = Some(recording.save(started)?);
        }
        Ok(())
    }

    /// Writes some more of the log that was asked for; once it is complete, its name and content.
    ///
    /// # Errors
    /// Why it cannot be written.
    pub fn saved(&mut self, wall_us: impl Fn() -> u64) -> io::Result<Option<(String, Vec<u8>)>> {
        let Some((mut saving, recording)) = self.saving.take().zip(self.desk.recording()) else {
            return Ok(None);
        };
        let until_us = wall_us() + SAVING_US;
        while !saving.advance(recording, SOME)? {
            if wall_us() >= until_us {
                self.saving = Some(saving);
                return Ok(None);
            }
        }
        saving.finish().map(Some)
    }
}
