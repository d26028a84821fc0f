//! A session with a simulated robot, and the one page that it has.

use crate::desk::{Desk, ROUND_US};
use crate::drive;
use crate::following::{Following, is_by_hand};
use crate::showing::Showing;
use rumbo_experiment::files::{FileError, Overrides};
use rumbo_lab::SimulatedRobot;
use rumbo_log::{Choice, Level, WriteError};
use rumbo_session::{Extras, Order, TargetError, stop_first};
use rumbo_wire::Command;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

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
    /// The file of an edited world, in place of `world`.
    pub edited: Option<String>,
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
    /// The file of the edited world in which it drives.
    pub edited: Option<String>,
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
            edited: None,
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

/// The lab of one page.
pub struct Lab {
    desk: Desk<SimulatedRobot>,
    /// Those of the page's address.
    parameters: BTreeMap<String, f64>,
    /// A link that still drives.
    following: Option<Following>,
    /// A recording that is shown; the robot waits meanwhile.
    showing: Option<Box<Showing>>,
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
        let robot = match &start.edited {
            Some(text) => SimulatedRobot::in_world(text, overrides, choice)?,
            None => SimulatedRobot::new(overrides, choice)?,
        };
        let extras = Extras {
            calibration: Some(rumbo_lab::calibration),
            ..Extras::default()
        };
        let mut desk = Desk::new(robot, extras, || SESSION, 0, day_ms);
        let mut following = following.unwrap_or_else(|why| {
            desk.warn(why);
            None
        });
        for (level, text) in following.iter_mut().flat_map(|link| link.notes.drain(..)) {
            desk.driver.note(level, text, 0);
        }
        Ok(Self {
            desk,
            parameters: start.parameters,
            following,
            showing: None,
        })
    }

    /// Takes an order of the page, to be executed in the next round; what is refused is reported with the next news.
    pub fn order(&mut self, json: &str) {
        self.desk.order(json);
    }

    /// Shows a recording, or `None`: the lab again, whose robot waits meanwhile. To the page it is a new connection.
    pub fn show(&mut self, recording: Option<Showing>) {
        self.showing = recording.map(Box::new);
        self.desk.begin_again();
    }

    /// Warns the page, with the next news.
    pub fn warn(&mut self, text: String) {
        self.desk.warn(text);
    }

    /// Executes the orders, STOP first, and advances the robot by the time due: one round, which ends early rather than
    /// late. `wall_us` reads a clock that never goes back \[us\]; `day_ms` is the time of day \[ms since 1970\].
    ///
    /// # Errors
    /// The robot is gone for good, which no simulated one is.
    pub fn advance(&mut self, wall_us: impl Fn() -> u64, day_ms: f64) -> Result<(), TargetError> {
        let began_us = wall_us();
        self.desk.driver.host().day_ms = day_ms;
        let waiting = self.desk.take_orders();
        if let Some(showing) = &mut self.showing {
            showing.advance(&waiting, began_us, day_ms);
            return Ok(());
        }
        self.take_over(&waiting, began_us);
        let stop = waiting.contains(&Order::Robot(Command::Stop));
        self.desk.driver.obey(stop_first(waiting, stop), began_us)?;
        self.desk.driver.wall_passed(began_us);
        let mut now_us = began_us;
        loop {
            self.follow(now_us)?;
            if now_us >= began_us + ROUND_US || !self.desk.driver.slice(now_us)? {
                break;
            }
            now_us = wall_us();
        }
        self.desk.driver.update(now_us);
        self.end_following(now_us);
        if std::mem::take(&mut self.desk.driver.host().full) {
            self.warn("the recording is full: save it, and reset for another one".into());
        }
        Ok(())
    }

    /// An order given by hand ends what a link repeats; of a calibration no link has anything.
    fn take_over(&mut self, orders: &[Order], wall_us: u64) {
        if orders.contains(&Order::Calibrate) {
            self.desk.driver.host().unlike = Some("a calibration is not in a link");
        }
        if orders
            .iter()
            .any(|order| matches!(order, Order::Velocity(_)))
        {
            self.desk.driver.host().unlike = Some("velocities, many a second, are not in a link");
        }
        if orders.iter().any(is_by_hand) && self.following.take().is_some() {
            let text = "the link drives no further: an order was given here";
            self.desk.driver.note(Level::Info, text.into(), wall_us);
        }
    }

    /// Gives the orders of a link that are due.
    fn follow(&mut self, wall_us: u64) -> Result<(), TargetError> {
        let target_us = self.desk.driver.target_us();
        while let Some(order) = self
            .following
            .as_mut()
            .and_then(|link| link.next(target_us))
        {
            self.desk.driver.obey([order], wall_us)?;
        }
        Ok(())
    }

    /// At its end, compares the run with that of the link.
    fn end_following(&mut self, wall_us: u64) {
        let target_us = self.desk.driver.target_us();
        let over = |following: &mut Following| target_us >= following.until_us;
        if let Some(following) = self.following.take_if(over) {
            let hash = self.hash(following.until_us);
            let (level, text) = following.verdict(hash);
            self.desk.driver.note(level, text, wall_us);
        }
    }

    fn hash(&mut self, until_us: u64) -> Option<String> {
        let recording = self.desk.recording();
        recording.and_then(|recording| recording.hash(until_us))
    }

    /// The run so far, for a link.
    pub fn share(&mut self) -> Shared {
        let until_us = self.desk.driver.target_us();
        let hash = self.hash(until_us);
        let edited = self.desk.driver.target().edited_world().map(str::to_owned);
        let page = self.desk.driver.host();
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
            edited,
            parameters: self.parameters.clone(),
        }
    }

    /// When the run began: time of day \[ms since 1970\].
    pub fn began_ms(&mut self) -> f64 {
        let recording = self.desk.recording();
        recording.map_or(0.0, |recording| recording.began_ms)
    }

    /// The run so far as a log: the name of a file for it, and the file. `started` is when it began, as a manifest has it.
    ///
    /// # Errors
    /// Why it cannot be written.
    pub fn log(&mut self, started: String) -> Result<(String, Vec<u8>), WriteError> {
        match self.desk.recording() {
            Some(recording) => recording.log(started),
            None => Ok(Default::default()),
        }
    }

    /// What is new to the page, as JSON.
    pub fn news(&mut self) -> Vec<String> {
        let shown = self.showing.as_ref().map(|showing| &showing.board);
        self.desk.news(shown)
    }
}
