//! The world that a page edits: as JSON for the page, as the text of a file to keep, and checked as every world file is.
//!
//! What the page does not know of a file passes through it unchanged.

use crate::prepare::Prepared;
use crate::program::OwnProgram;
use crate::robot::SimulatedRobot;
use rumbo_experiment::files::{FileError, Kind, Library, Overrides, Setup};
use rumbo_log::{Choice, Manifest};
use rumbo_session::{EditedWorld, TargetError};
use toml::{Table, Value};

/// Its name among the worlds.
pub const EDITED: &str = "edited";

/// The library with this text as the edited world.
pub(crate) fn holding(library: Library, text: &str) -> Library {
    library.holding(Kind::World, EDITED, text)
}

/// The text of the edited world, if that is the world of a run.
#[must_use]
pub fn edited_world(manifest: &Manifest) -> Option<&str> {
    let edited = manifest.world.as_deref() == Some(EDITED);
    let text = manifest.files.get("world");
    text.filter(|_| edited).map(String::as_str)
}

impl SimulatedRobot {
    /// The world in which it drives, or the one given, to edit.
    pub(crate) fn to_edit(&self, given: Option<&str>) -> EditedWorld {
        match given {
            _ if !self.is_alone() => answer(
                Err(FileError::Setting(TargetError::NoReset.to_string())),
                None,
            ),
            None => self.shown(),
            Some(text) => self.checked(text),
        }
    }

    fn shown(&self) -> EditedWorld {
        let Choice { world, seed, .. } = self.choice();
        let editable = self
            .set_up(&self.library, world)
            .and_then(|setup| editable(&setup, seed));
        answer(editable, None)
    }

    fn checked(&self, given: &str) -> EditedWorld {
        let text = match given.trim_start().starts_with('{') {
            true => serde_json::from_str::<Table>(given)
                .map_err(|error| error.to_string())
                .and_then(|table| written(&table)),
            false => Ok(given.to_owned()),
        };
        let text = match text {
            Ok(text) => text,
            Err(problem) => return answer(Err(FileError::Setting(problem)), None),
        };
        let library = holding(self.library.clone(), &text);
        let editable = self
            .set_up(&library, Some(EDITED.into()))
            .and_then(|setup| editable(&setup, self.choice().seed));
        answer(editable, text.parse().ok())
    }

    fn set_up(&self, library: &Library, world: Option<String>) -> Result<Setup, FileError> {
        let choice = self.choice();
        let overrides = Overrides {
            world,
            rig: choice.rig,
            // An image takes its time, and no part in it.
            firmware: None,
            ..self.overrides.clone()
        };
        library.setup(&choice.scenario, &overrides)
    }

    /// Starts again in the world given.
    pub(crate) fn start_in(&mut self, given: &str) -> Result<Choice, TargetError> {
        if self.program.as_ref().is_some_and(OwnProgram::is_rejected) {
            return Err(TargetError::NotCompiled);
        }
        let world = self.to_edit(Some(given));
        if let Some(problem) = world.problem {
            return Err(TargetError::Setup(problem));
        }
        let held = holding(self.library.clone(), &world.toml);
        let before = std::mem::replace(&mut self.library, held);
        let choice = Choice {
            world: Some(EDITED.into()),
            ..self.choice()
        };
        if let Err(error) = self.start_again(&choice) {
            self.library = before;
            return Err(TargetError::Setup(error.to_string()));
        }
        let title = world.model.get("title").and_then(|title| title.as_str());
        let title = title.unwrap_or_default().to_owned();
        self.prepared(|Prepared { scene, .. }| {
            if !scene.worlds.iter().any(|name| name == EDITED) {
                scene.worlds.push(EDITED.into());
            }
            scene.world_titles.insert(EDITED.into(), title);
        });
        Ok(choice)
    }
}

/// A world as the page gets it; `instead` is what to show of one that is wrong.
fn answer(editable: Result<Table, FileError>, instead: Option<Table>) -> EditedWorld {
    let problem = editable.as_ref().err().map(ToString::to_string);
    let Some(table) = editable.ok().or(instead) else {
        return EditedWorld {
            problem,
            ..EditedWorld::default()
        };
    };
    EditedWorld {
        model: serde_json::to_value(&table).unwrap_or_default(),
        toml: written(&table).unwrap_or_default(),
        problem,
        ..EditedWorld::default()
    }
}

fn written(table: &Table) -> Result<String, String> {
    toml::to_string(table).map_err(|error| error.to_string())
}

/// The world of a setup with the start in force, and with the boxes and the goal of the seed in place of \[random\].
fn editable(setup: &Setup, seed: u64) -> Result<Table, FileError> {
    let unreadable = |error: toml::de::Error| FileError::Setting(error.to_string());
    let mut table: Table = setup.world.text.parse().map_err(unreadable)?;
    if table.remove("random").is_some() {
        let own = setup.of_seed(seed)?;
        let drawn = own.world.boxes.get(setup.world.boxes.len()..);
        let drawn = drawn.unwrap_or_default().iter().map(|block| {
            let entries = [
                ("centre_m", pair(block.center_m)),
                ("size_m", pair(block.size_m)),
                ("angle_deg", rounded(block.heading_rad.to_degrees())),
            ];
            Value::from(Table::from_iter(
                entries.map(|(key, value)| (key.to_owned(), value)),
            ))
        });
        let boxes = table.entry("box").or_insert(Value::Array(Vec::new()));
        if let Value::Array(boxes) = boxes {
            boxes.extend(drawn);
        }
        if let Some(journey) = &own.world.journey {
            table.insert("goal_m".into(), pair(journey.goal_m));
        }
    }
    let start = setup.scenario.start;
    table.entry("start").or_insert_with(|| {
        let entries = [
            ("x_m", rounded(start.x_m)),
            ("y_m", rounded(start.y_m)),
            ("heading_deg", rounded(start.heading_rad.to_degrees())),
        ];
        Value::from(Table::from_iter(
            entries.map(|(key, value)| (key.to_owned(), value)),
        ))
    });
    Ok(table)
}

/// To a micrometre or a millionth of a degree: what people read.
fn rounded(value: f64) -> Value {
    Value::from((value * 1e6).round() / 1e6)
}

fn pair(point: [f64; 2]) -> Value {
    Value::from(point.map(rounded).to_vec())
}
