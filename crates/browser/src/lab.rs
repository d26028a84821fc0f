//! The sessions with simulated robots, one or several in one world, and the one page that they have.

use crate::desk::{Desk, Place, ROUND_US};
use crate::drive;
use crate::following::{Following, is_by_hand};
use crate::showing::Showing;
use crate::start::Start;
use rumbo_experiment::files::FileError;
use rumbo_lab::edited_world;
use rumbo_log::Level;
use rumbo_session::explain::Cause;
use rumbo_session::{Board, Extras, Order, Target, TargetError, stop_first};
use rumbo_wire::Command;
use serde::Serialize;
use std::collections::BTreeMap;
use std::io;
use std::rc::Rc;

const STOP: Order = Order::Robot(Command::Stop);
/// The session's number. The robot begins anew with each run, so none is left of another session, and the same orders
/// make the same bytes.
const SESSION: u8 = 1;

/// The run as a link carries it: what the page does not know of it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Shared {
    /// The file of the edited world in which it drives.
    pub edited: Option<String>,
    /// The file of the scenario, if it is not built in.
    pub file: Option<String>,
    /// Copies of the scenario's robot.
    pub robots: usize,
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

/// The lab of one page.
pub struct Lab {
    /// That of the first robot, which has the time.
    first: Desk<dyn Target>,
    /// Those of the others in its world.
    others: Vec<Desk<dyn Target>>,
    /// Of which robot the page is.
    own: usize,
    /// What the page began with: a scenario that is not built in, by its name, copies of its robot, and parameters.
    file: Option<(String, String)>,
    robots: usize,
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
        let targets = start.targets()?;
        let several = targets.len() > 1;
        let names = targets.iter().filter(|_| several);
        let names: Rc<[String]> = names.map(|(name, _)| name.clone()).collect();
        let extras = Extras {
            calibration: Some(rumbo_lab::calibration),
            ..Extras::default()
        };
        let mut desks = targets.into_iter().enumerate().map(|(own, (_, target))| {
            let robots = Rc::clone(&names);
            Desk::new(target, Place { robots, own }, extras, || SESSION, 0, day_ms)
        });
        let none = || FileError::Setting("there is no robot".into());
        let mut first = desks.next().ok_or_else(none)?;
        let mut following = following.unwrap_or_else(|why| {
            first.warn(why);
            None
        });
        for (level, text) in following.iter_mut().flat_map(|link| link.notes.drain(..)) {
            first.driver.note(level, text, 0);
        }
        Ok(Self {
            first,
            others: desks.collect(),
            own: 0,
            file: start.file.map(|text| (start.scenario, text)),
            robots: start.robots,
            parameters: start.parameters,
            following,
            showing: None,
        })
    }

    /// That of the page.
    fn desk(&mut self) -> &mut Desk<dyn Target> {
        match self.own {
            0 => &mut self.first,
            other => &mut self.others[other - 1],
        }
    }

    fn desks(&mut self) -> impl Iterator<Item = &mut Desk<dyn Target>> {
        std::iter::once(&mut self.first).chain(&mut self.others)
    }

    /// Makes the page that of another robot: to the page it is a new connection.
    pub fn select(&mut self, robot: usize) {
        if robot <= self.others.len() {
            self.own = robot;
            self.show(None);
        }
    }

    /// Takes an order of the page, to be executed in the next round; what is refused is reported with the next news.
    pub fn order(&mut self, json: &str) {
        self.desk().order(json);
    }

    /// Shows a recording, or `None`: the lab again, whose robots wait meanwhile. To the page it is a new connection.
    pub fn show(&mut self, recording: Option<Showing>) {
        self.showing = recording.map(Box::new);
        self.desk().begin_again();
    }

    /// Warns the page, with the next news.
    pub fn warn(&mut self, text: String) {
        self.desk().warn(text);
    }

    /// Executes the orders, STOP first, and advances the robot by the time due: one round, which ends early rather than
    /// late. `wall_us` reads a clock that never goes back \[us\]; `day_ms` is the time of day \[ms since 1970\].
    ///
    /// # Errors
    /// The robot is gone for good, which no simulated one is.
    pub fn advance(&mut self, wall_us: impl Fn() -> u64, day_ms: f64) -> Result<(), TargetError> {
        let began_us = wall_us();
        let mut waiting = Vec::new();
        for desk in self.desks() {
            desk.driver.host().day_ms = day_ms;
            waiting.push(desk.take_orders());
        }
        if let Some(showing) = &mut self.showing {
            showing.advance(&waiting[self.own], began_us, day_ms);
            return Ok(());
        }
        self.take_over(&waiting[0], began_us);
        let stop = waiting.iter().flatten().any(|order| *order == STOP);
        for (desk, orders) in self.desks().zip(waiting) {
            desk.driver.obey(stop_first(orders, stop), began_us)?;
        }
        for other in &mut self.others {
            other.driver.follow(&self.first.driver);
        }
        self.first.driver.wall_passed(began_us);
        let mut now_us = began_us;
        loop {
            self.follow(now_us)?;
            if now_us >= began_us + ROUND_US || !self.first.driver.slice(now_us)? {
                break;
            }
            for other in &mut self.others {
                other.driver.step(now_us)?;
            }
            now_us = wall_us();
        }
        for desk in self.desks() {
            desk.driver.update(now_us);
            if std::mem::take(&mut desk.driver.host().full) {
                desk.warn("the recording is full: save it, and reset for another one".into());
            }
        }
        self.end_following(now_us);
        Ok(())
    }

    /// An order given by hand ends what a link repeats; of a calibration no link has anything.
    fn take_over(&mut self, orders: &[Order], wall_us: u64) {
        if orders.contains(&Order::Calibrate) {
            self.first.driver.host().unlike = Some("a calibration is not in a link");
        }
        if orders
            .iter()
            .any(|order| matches!(order, Order::Velocity(_)))
        {
            self.first.driver.host().unlike = Some("velocities, many a second, are not in a link");
        }
        if orders.iter().any(is_by_hand) && self.following.take().is_some() {
            let text = "the link drives no further: an order was given here";
            self.first.driver.note(Level::Info, text.into(), wall_us);
        }
    }

    /// Gives the orders of a link that are due.
    fn follow(&mut self, wall_us: u64) -> Result<(), TargetError> {
        let target_us = self.first.driver.target_us();
        while let Some(order) = self
            .following
            .as_mut()
            .and_then(|link| link.next(target_us))
        {
            self.first.driver.obey([order], wall_us)?;
        }
        Ok(())
    }

    /// At its end, compares the run with that of the link.
    fn end_following(&mut self, wall_us: u64) {
        let target_us = self.first.driver.target_us();
        let over = |following: &mut Following| target_us >= following.until_us;
        if let Some(following) = self.following.take_if(over) {
            let hash = self.hash(following.until_us);
            let (level, text) = following.verdict(hash);
            self.first.driver.note(level, text, wall_us);
        }
    }

    fn hash(&mut self, until_us: u64) -> Option<String> {
        let recording = self.first.recording();
        recording.and_then(|recording| recording.hash(until_us))
    }

    /// The run so far, for a link.
    pub fn share(&mut self) -> Shared {
        let until_us = self.first.driver.target_us();
        let hash = self.hash(until_us);
        let several = !self.others.is_empty();
        let recording = self.first.recording();
        let edited = recording.and_then(|recording| edited_world(&recording.manifest));
        let edited = edited.map(str::to_owned);
        let scenario = recording.and_then(|recording| recording.manifest.scenario.as_ref());
        let file = self
            .file
            .as_ref()
            .filter(|(name, _)| Some(name) == scenario);
        let file = file.map(|(_, text)| text.clone());
        let page = self.first.driver.host();
        let changes = page.changes.len();
        let why_not = match page.unlike {
            Some(why) => Some(why.into()),
            None if several => Some("there are several robots".into()),
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
            file,
            robots: self.robots,
            parameters: self.parameters.clone(),
        }
    }

    /// When the run began: time of day \[ms since 1970\].
    pub fn began_ms(&mut self) -> f64 {
        let recording = self.desk().recording();
        recording.map_or(0.0, |recording| recording.began_ms)
    }

    /// The run so far as a log: the name of a file for it, and the file. `started` is when it began, as a manifest has it.
    ///
    /// # Errors
    /// Why it cannot be written.
    pub fn log(&mut self, started: String) -> io::Result<(String, Vec<u8>)> {
        match self.desk().recording() {
            Some(recording) => recording.log(started),
            None => Ok(Default::default()),
        }
    }

    /// What explains a stretch \[s\] of what the page sees.
    pub fn explain(&mut self, from_s: f64, to_s: f64) -> Vec<Cause> {
        let (desk, shown) = self.seen();
        desk.explain(shown, from_s, to_s)
    }

    /// What is new to the page, as JSON.
    pub fn news(&mut self) -> Vec<String> {
        let (desk, shown) = self.seen();
        desk.news(shown)
    }

    /// Whose page it is, and the board of a recording that it shows instead.
    fn seen(&mut self) -> (&mut Desk<dyn Target>, Option<&Board>) {
        let shown = self.showing.as_ref().map(|showing| &showing.board);
        let desk = match self.own {
            0 => &mut self.first,
            other => &mut self.others[other - 1],
        };
        (desk, shown)
    }
}
