//! A session with a robot without a dashboard: its orders come from a program, its log is an ordinary one.
//!
//! The robot's link, expiry of orders, heartbeats, STOP and ON are those of every session ([`rumbo_session`]). A real
//! robot takes its time; a simulated one takes none.

use crate::failure::Failure;
use rumbo_log::{Entry, Level, LogWriter, Manifest, Row};
use rumbo_session::{Event, Extras, Host, Order, SLICE_US, SessionDriver, Target};
use rumbo_station::headless::begin_log;
use rumbo_station::now_utc;
use rumbo_wire::Command;
use std::fs::File;
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// The log reaches the file this often.
const FLUSH_US: u64 = 400_000;
/// The state is published this often.
const UPDATE_US: u64 = 20_000;

/// A session, its robot and its log.
pub(crate) struct Driven<T> {
    driver: SessionDriver<Recording, T>,
    began: Instant,
    /// The robot lives in real time.
    is_real: bool,
    /// What a wall clock would say beside a simulated robot \[us\].
    pretended_us: u64,
    flushed_us: u64,
    updated_us: u64,
    /// When the newest signals came \[us\].
    newest_us: u64,
}

/// What the driver passes events to.
struct Recording {
    folder: PathBuf,
    log: Option<(PathBuf, LogWriter<BufWriter<File>>)>,
    /// Why there is no log, or no more of it.
    failure: Option<Failure>,
    /// The newest signals, and whether they are newer than those that were looked at.
    newest: Option<Row>,
    is_new: bool,
    /// The robot takes orders.
    connected: bool,
    /// The last message of a fault, a refusal or a loss.
    trouble: Option<String>,
}

impl Recording {
    fn write(&mut self, write: impl FnOnce(&mut LogWriter<BufWriter<File>>) -> io::Result<()>) {
        if let Some((path, log)) = &mut self.log
            && let Err(error) = write(log)
        {
            self.failure = Some(unwritten(path, &error));
        }
    }
}

impl Host for Recording {
    fn random_id(&mut self) -> u8 {
        Instant::now().elapsed().subsec_nanos() as u8 ^ std::process::id() as u8
    }

    fn publish(&mut self, event: Event) {
        let Event::Entry(entry) = event else {
            return;
        };
        match &*entry {
            Entry::Rows(rows) => {
                let known = rows.iter().rev().find(|row| row.signal("armed").is_some());
                self.is_new |= known.is_some();
                self.newest = known.copied().or(self.newest);
            }
            Entry::State(state) => self.connected = state.link.connected,
            Entry::Event(event) if matches!(event.level, Level::Warning | Level::Fault) => {
                self.trouble = Some(event.text.clone());
            }
            _ => {}
        }
        self.write(|log| log.record(&entry));
    }

    /// A robot that begins again goes on in the same log.
    fn begin_run(&mut self, manifest: Manifest) -> Option<(Level, String)> {
        if self.log.is_none() {
            let manifest = Manifest {
                started: Some(now_utc()),
                ..manifest
            };
            match begin_log(&self.folder, &manifest) {
                Ok(log) => self.log = Some(log),
                Err(error) => self.failure = Some(Failure::input(error)),
            }
        }
        None
    }
}

impl<T: Target> Driven<T> {
    /// Begins a session, recorded in this folder.
    pub(crate) fn begin(target: T, folder: &Path) -> Result<Self, Failure> {
        let is_real = !target.abilities().pace;
        let recording = Recording {
            folder: folder.to_owned(),
            log: None,
            failure: None,
            newest: None,
            is_new: false,
            connected: false,
            trouble: None,
        };
        let mut driver = SessionDriver::new(Box::new(target), recording, 1.0, Extras::default());
        driver.begin(0);
        driver.wall_passed(0);
        let mut driven = Self {
            driver,
            began: Instant::now(),
            is_real,
            pretended_us: 0,
            flushed_us: 0,
            updated_us: 0,
            newest_us: 0,
        };
        driven.look()?;
        Ok(driven)
    }

    /// The robot.
    pub(crate) fn robot(&mut self) -> &mut T {
        self.driver.target()
    }

    /// The log's file.
    pub(crate) fn path(&mut self) -> PathBuf {
        let log = self.driver.host().log.as_ref();
        log.map(|(path, _)| path.clone()).unwrap_or_default()
    }

    /// The session's time \[us\].
    pub(crate) fn now_us(&self) -> u64 {
        self.driver.target_us()
    }

    /// The newest signals that are not older than `age_us`.
    pub(crate) fn signals(&mut self, age_us: u64) -> Option<Row> {
        let is_young = self.now_us() <= self.newest_us + age_us;
        self.driver.host().newest.filter(|_| is_young)
    }

    /// Whether the robot takes orders. Its telemetry comes without being asked for, and before that.
    pub(crate) fn is_connected(&mut self) -> bool {
        self.driver.host().connected
    }

    /// The last message of a fault, a refusal or a loss since it was last asked.
    pub(crate) fn take_trouble(&mut self) -> Option<String> {
        self.driver.host().trouble.take()
    }

    /// Gives an order.
    pub(crate) fn order(&mut self, command: Command) -> Result<(), Failure> {
        let ordered = self.driver.obey([Order::Robot(command)], self.wall_us());
        ordered.map_err(Failure::input)?;
        self.look()
    }

    /// Notes something in the log.
    pub(crate) fn note(&mut self, text: String) -> Result<(), Failure> {
        let wall_us = self.wall_us();
        self.driver.note(Level::Info, text, wall_us);
        self.look()
    }

    /// Lets one slice of time pass.
    pub(crate) fn slice(&mut self) -> Result<(), Failure> {
        if self.is_real {
            std::thread::sleep(Duration::from_micros(SLICE_US));
        }
        self.pretended_us += SLICE_US;
        let wall_us = self.wall_us();
        self.driver.wall_passed(wall_us);
        while self.driver.slice(wall_us).map_err(Failure::input)? {}
        let now_us = self.now_us();
        if now_us >= self.updated_us + UPDATE_US {
            self.updated_us = now_us;
            self.driver.update(wall_us);
        }
        self.look()
    }

    /// Completes the log.
    pub(crate) fn finish(mut self) -> Result<PathBuf, Failure> {
        self.look()?;
        let Some((path, log)) = self.driver.into_host().log else {
            return Ok(PathBuf::new());
        };
        log.finish().map_err(|error| unwritten(&path, &error))?;
        Ok(path)
    }

    fn wall_us(&self) -> u64 {
        match self.is_real {
            true => u64::try_from(self.began.elapsed().as_micros()).unwrap_or(u64::MAX),
            false => self.pretended_us,
        }
    }

    /// Takes what has happened.
    fn look(&mut self) -> Result<(), Failure> {
        self.driver.publish();
        let now_us = self.now_us();
        let host = self.driver.host();
        if std::mem::take(&mut host.is_new) {
            self.newest_us = now_us;
        }
        if now_us >= self.flushed_us + FLUSH_US {
            self.flushed_us = now_us;
            host.write(LogWriter::flush);
        }
        host.failure.take().map_or(Ok(()), Err)
    }
}

fn unwritten(path: &Path, error: &impl std::fmt::Display) -> Failure {
    Failure::Input(format!(
        "{}: the log cannot be written ({error}); make room, or name another folder with --out",
        path.display()
    ))
}
