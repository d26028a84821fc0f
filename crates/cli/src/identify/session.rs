//! A session with a robot without a dashboard: its orders come from a program, its log is an ordinary one.
//!
//! The robot's link, expiry of orders, heartbeats, STOP and ON are those of every session ([`rumbo_session`]). A real
//! robot takes its time; a simulated one takes none.

use crate::failure::Failure;
use rumbo_log::{Entry, Level, LogWriter, Manifest, Row};
use rumbo_session::{About, Event, Going, Now, Order, SLICE_US, Session, Sight, Target};
use rumbo_station::{headless, now_utc};
use rumbo_wire::Command;
use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// The log reaches the file this often.
const FLUSH_US: u64 = 400_000;
/// The state is published this often.
const UPDATE_US: u64 = 20_000;

/// A session, its robot and its log.
pub(crate) struct Driven<T: Target> {
    pub(crate) target: T,
    session: Session,
    log: LogWriter<BufWriter<File>>,
    path: PathBuf,
    began: Instant,
    /// The robot lives in real time.
    is_real: bool,
    flushed_us: u64,
    updated_us: u64,
    bytes: Vec<u8>,
    /// The newest signals, and when they came [us].
    newest: Option<(Row, u64)>,
    /// The last message of a fault, a refusal or a loss.
    trouble: Option<String>,
}

impl<T: Target> Driven<T> {
    /// Begins a session, recorded in this folder.
    pub(crate) fn begin(target: T, folder: &Path) -> Result<Self, Failure> {
        let about = About::of(&target);
        let manifest = Manifest {
            version: env!("CARGO_PKG_VERSION").into(),
            baud: target.baud(),
            step_us: SLICE_US,
            started: Some(now_utc()),
            ..target.manifest()
        };
        let (path, log) = headless::begin_log(folder, &manifest).map_err(Failure::input)?;
        let id = Instant::now().elapsed().subsec_nanos() as u8 ^ std::process::id() as u8;
        Ok(Self {
            is_real: !about.abilities.pace,
            session: Session::new(about, id, false),
            target,
            log,
            path,
            began: Instant::now(),
            flushed_us: 0,
            updated_us: 0,
            bytes: Vec::new(),
            newest: None,
            trouble: None,
        })
    }

    /// The log's file.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// The session's time [us].
    pub(crate) fn now_us(&self) -> u64 {
        self.target.now_us()
    }

    /// The newest signals that are not older than `age_us`.
    pub(crate) fn signals(&self, age_us: u64) -> Option<&Row> {
        let (row, at_us) = self.newest.as_ref()?;
        (self.now_us() <= at_us + age_us).then_some(row)
    }

    /// The last message of a fault, a refusal or a loss since it was last asked.
    pub(crate) fn take_trouble(&mut self) -> Option<String> {
        self.trouble.take()
    }

    /// Gives an order.
    pub(crate) fn order(&mut self, command: Command) -> Result<(), Failure> {
        let now = self.now();
        // These orders ask nothing of the target.
        let _ = self.session.order(Order::Robot(command), now);
        self.send()?;
        self.publish()
    }

    /// Notes something in the log.
    pub(crate) fn note(&mut self, text: String) -> Result<(), Failure> {
        let now = self.now();
        self.session.note(Level::Info, text, now);
        self.publish()
    }

    /// Lets one slice of time pass.
    pub(crate) fn slice(&mut self) -> Result<(), Failure> {
        if self.is_real {
            std::thread::sleep(Duration::from_micros(SLICE_US));
        }
        self.target.advance(SLICE_US).map_err(Failure::input)?;
        let now = self.now();
        let sight = Sight {
            truth: self.target.truth(),
            ..Sight::default()
        };
        self.session.observe(sight, now);
        self.bytes.clear();
        self.target.receive(&mut self.bytes);
        self.session.receive(&self.bytes, now);
        self.session.advance(now);
        self.send()?;
        while let Some(news) = self.target.news() {
            self.session.news(news, now);
        }
        if now.target_us >= self.updated_us + UPDATE_US {
            self.updated_us = now.target_us;
            let going = Going {
                speed: 1.0,
                achieved_speed: 1.0,
                true_battery_v: self.target.truth().map(|truth| truth.battery_v),
                program: self.target.program(),
            };
            self.session.update(going, now);
        }
        self.publish()
    }

    /// Completes the log.
    pub(crate) fn finish(mut self) -> Result<PathBuf, Failure> {
        self.publish()?;
        let done = self.log.finish();
        done.map_err(|error| unwritten(&self.path, &error))?;
        Ok(self.path)
    }

    fn now(&self) -> Now {
        let target_us = self.target.now_us();
        let wall = self.began.elapsed().as_micros();
        Now {
            target_us,
            wall_us: match self.is_real {
                true => u64::try_from(wall).unwrap_or(u64::MAX),
                false => target_us,
            },
        }
    }

    fn send(&mut self) -> Result<(), Failure> {
        let bytes = self.session.take_bytes();
        match bytes.is_empty() {
            true => Ok(()),
            false => self.target.send(&bytes).map_err(Failure::input),
        }
    }

    fn publish(&mut self) -> Result<(), Failure> {
        let now_us = self.target.now_us();
        for event in self.session.take_events() {
            let Event::Entry(entry) = event else {
                continue;
            };
            match &*entry {
                Entry::Rows(rows) => {
                    let known = rows.iter().rev().find(|row| row.signal("armed").is_some());
                    self.newest = known.map(|row| (*row, now_us)).or(self.newest);
                }
                Entry::Event(event) if matches!(event.level, Level::Warning | Level::Fault) => {
                    self.trouble = Some(event.text.clone());
                }
                _ => {}
            }
            let recorded = self.log.record(&entry);
            recorded.map_err(|error| unwritten(&self.path, &error))?;
        }
        if now_us >= self.flushed_us + FLUSH_US {
            self.flushed_us = now_us;
            let flushed = self.log.flush();
            flushed.map_err(|error| unwritten(&self.path, &error))?;
        }
        Ok(())
    }
}

fn unwritten(path: &Path, error: &impl std::fmt::Display) -> Failure {
    Failure::Input(format!(
        "{}: the log cannot be written ({error}); make room, or name another folder with --out",
        path.display()
    ))
}
