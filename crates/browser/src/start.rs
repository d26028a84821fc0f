//! What a page of the lab begins with.

use rumbo_experiment::files::{FileError, Kind, Library, Overrides, Setup};
use rumbo_lab::{EDITED, SimulatedRobot};
use rumbo_log::Choice;
use rumbo_session::Target;
use serde::Deserialize;
use std::collections::BTreeMap;

/// A robot, and what it is called; nothing, if it is alone.
pub(crate) type Named = (String, Box<dyn Target>);

/// What runs when the page is opened: as its address says, or else the first scenario.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(default, deny_unknown_fields)]
pub struct Start {
    /// The scenario's name.
    pub scenario: String,
    /// The file of a scenario of this name that is not built in.
    pub file: Option<String>,
    /// As many copies of the scenario's robot, in one world.
    pub robots: usize,
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
    /// Commands to repeat in the first run, as [`Shared::drive`](crate::Shared).
    pub drive: Option<String>,
    /// Until then it was driven \[s\].
    pub until_s: Option<f64>,
    /// What the run until then was, as [`Shared::hash`](crate::Shared).
    pub hash: Option<String>,
}

impl Default for Start {
    fn default() -> Self {
        Self {
            scenario: "mode1".into(),
            file: None,
            robots: 1,
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

impl Start {
    /// The files of it and ours.
    fn library(&self) -> Library {
        let given = [
            (Kind::Scenario, self.scenario.as_str(), &self.file),
            (Kind::World, EDITED, &self.edited),
        ];
        let hold = |library: Library, (kind, name, text): (_, _, &Option<String>)| match text {
            Some(text) => library.holding(kind, name, text),
            None => library,
        };
        given.into_iter().fold(Library::new(), hold)
    }

    fn world(&self) -> Option<String> {
        match &self.edited {
            Some(_) => Some(EDITED.into()),
            None => self.world.clone(),
        }
    }

    fn overrides(&self) -> Overrides {
        Overrides {
            robot: self.robot.clone(),
            parameters: self.parameters.clone().into_iter().collect(),
            ..Overrides::default()
        }
    }

    /// What runs without a page.
    ///
    /// # Errors
    /// The problems of the files that it names.
    pub fn setup(&self) -> Result<Setup, FileError> {
        let overrides = Overrides {
            world: self.world(),
            rig: self.rig.clone(),
            ..self.overrides()
        };
        self.library().setup(&self.scenario, &overrides)
    }

    /// The robots.
    pub(crate) fn targets(&self) -> Result<Vec<Named>, FileError> {
        let (library, overrides) = (self.library(), self.overrides());
        let choice = Choice {
            scenario: self.scenario.clone(),
            world: self.world(),
            rig: self.rig.clone(),
            seed: self.seed,
        };
        let robots = SimulatedRobot::all(library, overrides, &choice, self.robots)?.into_iter();
        let named = |robot: SimulatedRobot| -> Named { (robot.name(), Box::new(robot)) };
        Ok(robots.map(named).collect())
    }
}
