//! A session with a simulated robot, and the one page that it has.

use crate::drive::{self, Change};
use crate::following::{Following, is_by_hand};
use crate::recording::Recording;
use crate::showing::Showing;
use rumbo_experiment::files::{FileError, Overrides};
use rumbo_lab::SimulatedRobot;
use rumbo_log::{Choice, Level, LoggedEvent, Manifest, WriteError};
use rumbo_session::{
    Board, Cursor, Driver, Event, Extras, Host, Lease, Order, PageId, TargetError, ToPage, View,
    stop_first,
};
use rumbo_wire::Command;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Longest time spent on one round of slices, so that orders do not wait \[us\].
const ROUND_US: u64 = 20_000;
/// Orders that wait for a round; a page that gives more at once has gone wrong.
const WAITING: usize = 1_000;
/// The session's number. The robot begins anew with each run, so none is left of another session, and the same orders
/// make the same bytes.
const SESSION: u8 = 1;

/// What runs when the page is opened: as its address says, or else the first scenario.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(default, deny_unknown_fields)]
pub struct Start {
    /// The scenario's name.
    pub scenario: String,
    /// Another world than the scenario's.
    pub world: Option<String>,
    /// Other sonars than the scenario's.
    pub rig: Option<String>,
    /// Another robot than the scenario's.
    pub robot: Option<String>,
    /// Draws the robot and its noise.
    pub seed: u64,
    /// Values of parameters by name, which hold in every run of the page.
    pub parameters: BTreeMap<String, f64>,
    /// Commands to repeat in the first run, as [`Shared::drive`].
    pub drive: Option<String>,
    /// Until then it was driven \[s\].
    pub until_s: Option<f64>,
    /// What the run until then was, as [`Shared::hash`].
    pub hash: Option<String>,
}

/// The run as a link carries it: what the page does not know of it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Shared {
    /// With which it began, besides the scenario's.
    pub parameters: BTreeMap<String, f64>,
    /// The commands given by hand since, with their times; `None`: a link cannot repeat them.
    pub drive: Option<String>,
    /// Why not.
    pub why_not: Option<String>,
    /// Changes of commands.
    pub changes: usize,
    /// The time now \[s\].
    pub until_s: f64,
    /// Of the run until now.
    pub hash: Option<String>,
}

impl Default for Start {
    fn default() -> Self {
        Self {
            scenario: "mode1".into(),
            world: None,
            rig: None,
            robot: None,
            seed: 1,
            parameters: BTreeMap::new(),
            drive: None,
            until_s: None,
            hash: None,
        }
    }
}

/// What the driver passes events to.
struct Page {
    board: Board,
    /// Time of day \[ms since 1970\].
    day_ms: f64,
    recording: Option<Recording>,
    /// The commands given by hand in this run, and why a link cannot repeat it.
    changes: Vec<Change>,
    unlike: Option<&'static str>,
    /// The recording has just run out of room.
    full: bool,
}

impl Host for Page {
    fn random_id(&mut self) -> u8 {
        SESSION
    }

    fn publish(&mut self, event: Event) {
        self.board.take(&event, self.day_ms);
        match event {
            Event::Entry(entry) => {
                if let Some(recording) = &mut self.recording {
                    self.full |= !recording.keep(&entry);
                }
            }
            Event::Commanded(t_us, commands) => self.changes.push(Change { t_us, commands }),
            _ => {}
        }
    }

    /// The recording of the run before is gone.
    fn begin_run(&mut self, manifest: Manifest) -> Option<(Level, String)> {
        self.changes.clear();
        self.unlike = match (&manifest.image, &manifest.eeprom) {
            (Some(_), _) => Some("a program of your own is not in a link"),
            (_, Some(_)) => Some("the robot began with parameters that are saved on it"),
            _ => None,
        };
        self.recording = Some(Recording::new(manifest, self.day_ms));
        None
    }
}

/// The lab of one page.
pub struct Lab {
    driver: Driver<Page, SimulatedRobot>,
    /// Those of the page's address.
    parameters: BTreeMap<String, f64>,
    /// A link that still drives.
    following: Option<Following>,
    /// Orders since the last round.
    waiting: Vec<Order>,
    lease: Lease,
    page: PageId,
    /// A recording that is shown; the robot waits meanwhile.
    showing: Option<Box<Showing>>,
    cursor: Cursor,
    /// The page has had its first message.
    greeted: bool,
    seat: Option<View>,
    /// Warnings for the page.
    warnings: Vec<String>,
}

impl Lab {
    /// The robot at its start, in real time; `day_ms` is the time of day \[ms since 1970\].
    ///
    /// # Errors
    /// No such scenario, world, rig, robot or parameter, or a value out of its range.
    pub fn new(start: Start, day_ms: f64) -> Result<Self, FileError> {
        let following = Following::of(&start);
        let choice = Choice {
            scenario: start.scenario,
            world: start.world,
            rig: start.rig,
            seed: start.seed,
        };
        let overrides = Overrides {
            robot: start.robot,
            parameters: start.parameters.clone().into_iter().collect(),
            ..Overrides::default()
        };
        let robot = SimulatedRobot::new(overrides, choice)?;
        let page = Page {
            board: Board::default(),
            day_ms,
            recording: None,
            changes: Vec::new(),
            unlike: None,
            full: false,
        };
        let extras = Extras {
            calibration: Some(rumbo_lab::calibration),
            ..Extras::default()
        };
        let mut driver = Driver::new(Box::new(robot), page, 1.0, extras);
        driver.begin(0);
        let mut warnings = Vec::new();
        let mut following = following.unwrap_or_else(|why| {
            warnings.push(why);
            None
        });
        for (level, text) in following.iter_mut().flat_map(|link| link.notes.drain(..)) {
            driver.note(level, text, 0);
        }
        let mut lease = Lease::default();
        Ok(Self {
            driver,
            parameters: start.parameters,
            following,
            waiting: Vec::new(),
            // The first page is always admitted.
            page: lease.join(true).unwrap_or_default(),
            lease,
            showing: None,
            cursor: Cursor::default(),
            greeted: false,
            seat: None,
            warnings,
        })
    }

    /// Takes an order of the page, to be executed in the next round; what is refused is reported with the next news.
    pub fn order(&mut self, json: &str) {
        let admitted = json.parse::<Order>().map_err(|error| error.to_string());
        let admitted = admitted.and_then(|order| {
            self.lease.admit(&order, self.page)?;
            match self.waiting.len() < WAITING || order == Order::Robot(Command::Stop) {
                true => Ok(order),
                false => Err("too many orders at once".into()),
            }
        });
        match admitted {
            Ok(order) => self.waiting.push(order),
            Err(why) => self.warn(why),
        }
    }

    /// Shows a recording, or `None`: the lab again, whose robot waits meanwhile. To the page it is a new connection.
    pub fn show(&mut self, recording: Option<Showing>) {
        self.showing = recording.map(Box::new);
        self.waiting.clear();
        self.cursor = Cursor::default();
        self.greeted = false;
        self.seat = None;
    }

    /// Warns the page, with the next news.
    pub fn warn(&mut self, text: String) {
        self.warnings.push(text);
    }

    /// Executes the orders, STOP first, and advances the robot by the time due: one round, which ends early rather than
    /// late. `wall_us` reads a clock that never goes back \[us\]; `day_ms` is the time of day \[ms since 1970\].
    ///
    /// # Errors
    /// The robot is gone for good, which no simulated one is.
    pub fn advance(&mut self, wall_us: impl Fn() -> u64, day_ms: f64) -> Result<(), TargetError> {
        let began_us = wall_us();
        self.driver.host().day_ms = day_ms;
        let waiting = std::mem::take(&mut self.waiting);
        if let Some(showing) = &mut self.showing {
            showing.advance(&waiting, began_us, day_ms);
            return Ok(());
        }
        self.take_over(&waiting, began_us);
        let stop = waiting.contains(&Order::Robot(Command::Stop));
        self.driver.obey(stop_first(waiting, stop), began_us)?;
        self.driver.wall_passed(began_us);
        let mut now_us = began_us;
        loop {
            self.follow(now_us)?;
            if now_us >= began_us + ROUND_US || !self.driver.slice(now_us)? {
                break;
            }
            now_us = wall_us();
        }
        self.driver.update(now_us);
        self.end_following(now_us);
        if std::mem::take(&mut self.driver.host().full) {
            self.warn("the recording is full: save it, and reset for another one".into());
        }
        Ok(())
    }

    /// An order given by hand ends what a link repeats; of a calibration no link has anything.
    fn take_over(&mut self, orders: &[Order], wall_us: u64) {
        if orders.contains(&Order::Calibrate) {
            self.driver.host().unlike = Some("a calibration is not in a link");
        }
        if orders
            .iter()
            .any(|order| matches!(order, Order::Velocity(_)))
        {
            self.driver.host().unlike = Some("velocities, many a second, are not in a link");
        }
        if orders.iter().any(is_by_hand) && self.following.take().is_some() {
            let text = "the link drives no further: an order was given here";
            self.driver.note(Level::Info, text.into(), wall_us);
        }
    }

    /// Gives the orders of a link that are due.
    fn follow(&mut self, wall_us: u64) -> Result<(), TargetError> {
        let target_us = self.driver.target_us();
        while let Some(order) = self
            .following
            .as_mut()
            .and_then(|link| link.next(target_us))
        {
            self.driver.obey([order], wall_us)?;
        }
        Ok(())
    }

    /// At its end, compares the run with that of the link.
    fn end_following(&mut self, wall_us: u64) {
        let target_us = self.driver.target_us();
        let over = |following: &mut Following| target_us >= following.until_us;
        if let Some(following) = self.following.take_if(over) {
            let hash = self.hash(following.until_us);
            let (level, text) = following.verdict(hash);
            self.driver.note(level, text, wall_us);
        }
    }

    fn hash(&mut self, until_us: u64) -> Option<String> {
        let recording = self.driver.host().recording.as_ref();
        recording.and_then(|recording| recording.hash(until_us))
    }

    /// The run so far, for a link.
    pub fn share(&mut self) -> Shared {
        let until_us = self.driver.target_us();
        let hash = self.hash(until_us);
        let page = self.driver.host();
        let changes = page.changes.len();
        let why_not = match page.unlike {
            Some(why) => Some(why.into()),
            None if changes > drive::MOST => Some(format!(
                "a link has at most {} changes of commands, this run has {changes}",
                drive::MOST
            )),
            None => None,
        };
        Shared {
            drive: why_not.is_none().then(|| drive::to_text(&page.changes)),
            why_not,
            changes,
            until_s: until_us as f64 / 1e6,
            hash,
            parameters: self.parameters.clone(),
        }
    }

    /// When the run began: time of day \[ms since 1970\].
    pub fn began_ms(&mut self) -> f64 {
        let recording = self.driver.host().recording.as_ref();
        recording.map_or(0.0, |recording| recording.began_ms)
    }

    /// The run so far as a log: the name of a file for it, and the file. `started` is when it began, as a manifest has it.
    ///
    /// # Errors
    /// Why it cannot be written.
    pub fn log(&mut self, started: String) -> Result<(String, Vec<u8>), WriteError> {
        match &self.driver.host().recording {
            Some(recording) => recording.log(started),
            None => Ok(Default::default()),
        }
    }

    /// What is new to the page, as JSON.
    pub fn news(&mut self) -> Vec<String> {
        let mut messages = Vec::new();
        if !std::mem::replace(&mut self.greeted, true) {
            messages.extend(ToPage::hello().json());
        }
        let view = self.lease.view(self.page);
        if self.seat.replace(view) != Some(view) {
            messages.extend(ToPage::Control(view).json());
        }
        let board = match &self.showing {
            Some(showing) => &showing.board,
            None => &self.driver.host().board,
        };
        let mut news = board.news(&mut self.cursor);
        let t_s = news.state.as_ref().map_or(0.0, |state| state.t_s);
        let refused = self.warnings.drain(..).map(|text| LoggedEvent {
            t_s,
            level: Level::Warning,
            text,
        });
        news.events.extend(refused);
        messages.extend(news.messages().filter_map(|message| message.json()));
        messages
    }
}
