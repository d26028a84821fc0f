//! Replays a log: the same events as of a live session, with a playhead that can be moved.
//!
//! Nothing is sent to any robot: commands to one are answered with a note. Pages get what lies up to [`BEFORE_MS`]
//! before and [`AHEAD_MS`] after the playhead, whose time is that of the state. Moved beyond that, it begins a new run on
//! the board, so that pages discard what they had.
//!
//! The caller's loop is [`Replay::obey`] for the orders that have come, [`Replay::wall_passed`], [`Replay::follow`] as
//! long as there is work for the ghost and time, [`Replay::update`], and [`Replay::take_events`].

mod ghost;
mod speech;

use crate::error::TargetError;
use crate::event::Event;
use crate::orders::Order;
use crate::target::Ghost;
use ghost::GhostReplay;
use rumbo_log::{Entry, Level, Log, LoggedEvent, ParameterState, ReplayState, State, parameters};
use speech::Speech;
use std::fmt;
use std::ops::Range;

/// How much before the playhead a page gets \[ms\].
const BEFORE_MS: f64 = 300_000.0;
/// How much after the playhead a page gets \[ms\]; both together are what board and page keep.
const AHEAD_MS: f64 = 300_000.0;
/// Rows that a page takes at once without losing some.
const ROWS_AT_ONCE: usize = 250;

/// A log being replayed.
pub struct Replay {
    name: String,
    log: Log,
    speech: Speech,
    ghost: Option<GhostReplay>,
    /// Not published yet.
    events: Vec<Event>,
    /// Position of the playhead \[ms\].
    at_ms: f64,
    end_ms: f64,
    /// From here on the pages have what is before the playhead \[ms\].
    from_ms: f64,
    /// The first row, and the first reading, that are not on the board yet.
    next_row: usize,
    next_reading: usize,
    speed: f64,
    /// The wall clock when the playhead was moved last \[us\].
    last_us: Option<u64>,
    shown: Option<(usize, usize)>,
    warned: bool,
}

impl fmt::Debug for Replay {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Replay").field(&self.name).finish()
    }
}

impl Replay {
    /// A log, shown under this name, from its start on, at `speed` seconds of it per second of the wall clock.
    #[must_use]
    pub fn new(name: String, log: Log, speed: f64, ghost: Option<Box<dyn Ghost>>) -> Self {
        let mut replay = Self {
            name,
            speech: Speech::of(&log),
            ghost: ghost.map(GhostReplay::new),
            end_ms: log.duration_s() * 1e3,
            log,
            events: Vec::new(),
            at_ms: 0.0,
            from_ms: 0.0,
            next_row: 0,
            next_reading: 0,
            speed,
            last_us: None,
            shown: None,
            warned: false,
        };
        replay.begin();
        replay
    }

    fn begin(&mut self) {
        self.put(Entry::Scene(self.log.scene.clone().map(Box::new)));
        for event in self.log.events.clone() {
            self.put(Entry::Event(event));
        }
        for note in self.log.notes.clone() {
            self.note(format!("about the log: {note}"));
        }
        if let Some(why) = &self.log.cut {
            self.note(match self.log.has_holes {
                true => format!("the log is damaged: {why}"),
                false => format!("the log ends early: {why}"),
            });
        }
        // First where the playhead is: a page that comes now takes no sample for the present.
        self.update();
        self.begin_at(0.0);
    }

    /// The requested speed; 0 is a pause.
    #[must_use]
    pub fn speed(&self) -> f64 {
        self.speed
    }

    /// The events since the last call.
    pub fn take_events(&mut self) -> Vec<Event> {
        std::mem::take(&mut self.events)
    }

    /// Executes an order.
    pub fn obey(&mut self, order: &Order) {
        match order {
            Order::Speed(speed) => {
                // Played to its end, it begins again.
                if *speed > 0.0 && self.at_ms >= self.end_ms {
                    self.seek(0.0);
                }
                self.speed = *speed;
                self.last_us = None;
            }
            Order::Seek(t_s) => self.seek(t_s * 1e3),
            Order::Step(frames) => self.step(*frames),
            Order::Reset(_) => self.seek(0.0),
            Order::RestartGhost => self.restart_ghost(),
            Order::Robot(_)
            | Order::Hold(_)
            | Order::Velocity(_)
            | Order::Route(_)
            | Order::Type(..)
            | Order::Program(_)
            | Order::Sketch(..)
            | Order::Debug(_)
            | Order::Profile(_)
            | Order::Play
            | Order::World(_) => {
                if !std::mem::replace(&mut self.warned, true) {
                    self.note("this is a replay: nothing is sent to a robot".into());
                }
            }
            Order::Calibrate | Order::TakeControl | Order::ReleaseControl => {}
        }
    }

    /// Restarts the ghost at the robot's pose shown now.
    fn restart_ghost(&mut self) {
        let row = self.row_after(self.at_ms).saturating_sub(1);
        let started = match &mut self.ghost {
            Some(ghost) => ghost.restart(&mut self.log, row),
            None => Err(TargetError::NoGhost),
        };
        match started {
            Ok(()) => {
                self.put(Entry::Event(LoggedEvent {
                    t_s: self.at_ms / 1e3,
                    level: Level::Info,
                    text: "the ghost starts again where the robot is".into(),
                }));
                self.begin_at(self.at_ms);
            }
            Err(why) => self.note(format!("the ghost: refused, {why}")),
        }
    }

    /// Whether a ghost that was restarted is still on its way.
    #[must_use]
    pub fn follows(&self) -> bool {
        self.ghost.as_ref().is_some_and(GhostReplay::at_work)
    }

    /// Advances the ghost by a step; pages that were shown rows without it get them again.
    pub fn follow(&mut self) {
        let Some(ghost) = &mut self.ghost else {
            return;
        };
        let behind = ghost.is_behind(self.next_row);
        if let Err(why) = ghost.work(&mut self.log) {
            ghost.give_up();
            self.note(format!("the ghost: refused, {why}"));
        } else if behind && !ghost.is_behind(self.next_row) {
            self.begin_at(self.at_ms);
        }
    }

    fn note(&mut self, text: String) {
        self.put(Entry::Event(LoggedEvent {
            t_s: self.at_ms / 1e3,
            level: Level::Warning,
            text,
        }));
    }

    fn put(&mut self, entry: Entry) {
        self.events.push(entry.into());
    }

    fn put_rows(&mut self, rows: Range<usize>) {
        let rows = self.log.rows.get(rows).unwrap_or_default().to_vec();
        if !rows.is_empty() {
            self.put(Entry::Rows(rows));
        }
    }

    fn put_readings(&mut self, readings: Range<usize>) {
        let readings = self.log.readings.get(readings).unwrap_or_default().to_vec();
        if !readings.is_empty() {
            self.put(Entry::Readings(readings));
        }
    }

    /// The first reading after a time.
    fn reading_after(&self, t_ms: f64) -> usize {
        let readings = &self.log.readings;
        readings.partition_point(|reading| reading.t_ms as f64 <= t_ms)
    }

    /// The first row after a time.
    fn row_after(&self, t_ms: f64) -> usize {
        self.log.rows.partition_point(|row| row.t_ms as f64 <= t_ms)
    }

    /// Moves the playhead; pages that have what is around it already only follow.
    fn seek(&mut self, t_ms: f64) {
        let t_ms = t_ms.clamp(0.0, self.end_ms);
        let missing = self
            .row_after(t_ms + AHEAD_MS)
            .saturating_sub(self.next_row);
        let back = t_ms < self.at_ms;
        if t_ms < self.from_ms || missing > ROWS_AT_ONCE || (back && self.speech.speaks()) {
            self.begin_at(t_ms);
        } else {
            self.last_us = None;
            self.advance(t_ms);
        }
    }

    /// Begins a new run on the board, with what is around this time.
    fn begin_at(&mut self, t_ms: f64) {
        self.at_ms = t_ms.clamp(0.0, self.end_ms);
        self.last_us = None;
        self.events.push(Event::Run);
        self.from_ms = self.at_ms - BEFORE_MS;
        self.next_row = self.row_after(self.from_ms);
        self.next_reading = self.reading_after(self.from_ms);
        self.speech.seek(self.from_ms);
        self.advance(self.at_ms);
    }

    /// To the next telemetry frame, or to the one before; the playhead stands there.
    fn step(&mut self, frames: i32) {
        self.speed = 0.0;
        // A program that sends no telemetry is seen by the instruments.
        let t_ms: Vec<i64> = match self.log.rows.is_empty() {
            true => self.log.readings.iter().map(|each| each.t_ms).collect(),
            false => self.log.rows.iter().map(|row| row.t_ms).collect(),
        };
        let now = t_ms.partition_point(|t_ms| *t_ms as f64 <= self.at_ms) as i64 - 1;
        let wanted = (now + i64::from(frames)).clamp(0, t_ms.len().saturating_sub(1) as i64);
        if let Some(t_ms) = t_ms.get(wanted as usize) {
            let t_ms = *t_ms as f64;
            if frames > 0 {
                self.advance(t_ms)
            } else {
                self.seek(t_ms)
            }
        }
    }

    /// The wall clock says so \[us\]: a replay that is not paused plays on.
    pub fn wall_passed(&mut self, wall_us: u64) {
        let last_us = self.last_us.replace(wall_us).unwrap_or(wall_us);
        if self.speed > 0.0 {
            let passed_ms = wall_us.saturating_sub(last_us) as f64 / 1e3;
            self.advance(self.at_ms + passed_ms * self.speed);
            if self.at_ms >= self.end_ms {
                self.speed = 0.0;
            }
        }
    }

    fn advance(&mut self, t_ms: f64) {
        self.at_ms = t_ms.min(self.end_ms);
        let ahead_ms = self.at_ms + AHEAD_MS;
        // What a page keeps moves on with what it gets.
        self.from_ms = self
            .from_ms
            .max(ahead_ms.min(self.end_ms) - BEFORE_MS - AHEAD_MS);
        let until = self.row_after(ahead_ms);
        self.put_rows(self.next_row..until);
        self.next_row = until.max(self.next_row);
        let until = self.reading_after(ahead_ms);
        self.put_readings(self.next_reading..until);
        self.next_reading = until.max(self.next_reading);
        self.events.extend(self.speech.advance(self.at_ms));
    }

    /// Publishes the slow state and the parameters of the playhead.
    pub fn update(&mut self) {
        let t_s = self.at_ms / 1e3;
        let index = self.log.states.partition_point(|state| state.t_s <= t_s);
        // An imported recording has no state: its rows tell the mode.
        let mut state = index
            .checked_sub(1)
            .and_then(|last| self.log.states.get(last))
            .cloned()
            .unwrap_or_else(|| self.state_of_row());
        state.t_s = t_s;
        state.simulated = self.log.scene.as_ref().is_some_and(|scene| !scene.of_ghost);
        state.speed = self.speed;
        state.achieved_speed = self.speed;
        state.replay = Some(ReplayState {
            name: self.name.clone(),
            duration_s: self.end_ms / 1e3,
        });
        self.put(Entry::State(Box::new(state)));
        let known = self
            .log
            .parameters
            .partition_point(|(t_ms, _)| *t_ms as f64 <= self.at_ms);
        if self.shown != Some((known, self.log.parameters.len())) {
            self.shown = Some((known, self.log.parameters.len()));
            self.put(Entry::Parameters(self.parameters(known)));
        }
    }

    fn state_of_row(&self) -> State {
        let mut state = State::default();
        let row = self
            .row_after(self.at_ms)
            .checked_sub(1)
            .and_then(|last| self.log.rows.get(last));
        if let Some(row) = row {
            state.link.connected = true;
            state.robot.mode = row.signal("mode").map_or(0, |mode| mode as u8);
            state.robot.armed = row.signal("armed") != Some(0.0);
        }
        state
    }

    fn parameters(&self, known: usize) -> Vec<ParameterState> {
        let values = known
            .checked_sub(1)
            .and_then(|last| self.log.parameters.get(last));
        parameters()
            .map(|entry| ParameterState {
                entry,
                value: values.and_then(|(_, values)| values.get(entry.name).copied()),
                pending: false,
                refused: None,
            })
            .collect()
    }
}
