//! Finds robots, worlds, scenarios and policies: built into the program by name, on disk by path.

use super::bounded;
use super::error::FileError;
use super::near::near_or_all;
use super::{PolicyFile, RobotFile, ScenarioFile, WorldFile};
use include_dir::{Dir, include_dir};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

static ROBOTS: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/../../robots");
static WORLDS: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/../../worlds");
static SCENARIOS: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/../../scenarios");
static POLICIES: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/../../policies");

/// The names of robots that are sold as kits begin with it.
const OF_KITS: &str = "kit_";

/// The kinds of file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// `robots/*.toml`
    Robot,
    /// `worlds/*.toml`
    World,
    /// `scenarios/*.toml`
    Scenario,
    /// `policies/*.toml`
    Policy,
}

impl Kind {
    /// Its word in messages.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Robot => "robot",
            Self::World => "world",
            Self::Scenario => "scenario",
            Self::Policy => "policy",
        }
    }

    /// The folder of the built-in files.
    fn folder(self) -> &'static str {
        match self {
            Self::Robot => "robots",
            Self::World => "worlds",
            Self::Scenario => "scenarios",
            Self::Policy => "policies",
        }
    }

    /// The built-in files.
    fn files(self) -> &'static Dir<'static> {
        match self {
            Self::Robot => &ROBOTS,
            Self::World => &WORLDS,
            Self::Scenario => &SCENARIOS,
            Self::Policy => &POLICIES,
        }
    }

    /// The names of the built-in files, in order.
    fn names(self) -> Vec<String> {
        let paths = self.files().files().filter_map(|file| file.path().to_str());
        let mut names: Vec<String> = paths
            .filter_map(|path| Some(path.strip_suffix(".toml")?.to_owned()))
            .collect();
        // Other people's kits come last.
        names.sort_by_key(|name| (name.starts_with(OF_KITS), name.clone()));
        names
    }

    fn built_in(self, name: &str) -> Option<String> {
        let file = self.files().get_file(format!("{name}.toml"))?;
        Some(file.contents_utf8()?.to_owned())
    }
}

/// Where files are found. A name is a built-in file; anything that ends in `.toml` or contains a `/` is a path.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Library {
    /// Paths are relative to this folder; empty for the current one.
    base: PathBuf,
    /// Files held in memory by kind and name; they come before the built-in ones.
    held: BTreeMap<(Kind, String), String>,
}

/// A file's text and its name for messages.
struct Found {
    name: String,
    file: String,
    text: String,
    on_disk: bool,
}

impl Library {
    /// Paths are relative to the current folder.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// The same, with paths relative to the folder of the file that contains them.
    #[must_use]
    pub fn beside(&self, name_or_path: &str) -> Self {
        let folder = is_path(name_or_path)
            .then(|| Path::new(name_or_path).parent())
            .flatten();
        Self {
            base: folder.map_or_else(|| self.base.clone(), |folder| self.base.join(folder)),
            held: self.held.clone(),
        }
    }

    /// Where a path leads that is relative to its folder.
    pub(crate) fn path(&self, path: &Path) -> PathBuf {
        self.base.join(path)
    }

    /// The same with a file of this name, in place of a built-in one.
    #[must_use]
    pub fn holding(mut self, kind: Kind, name: &str, text: &str) -> Self {
        self.held.insert((kind, name.to_owned()), text.to_owned());
        self
    }

    /// A robot.
    ///
    /// # Errors
    /// An unknown name, an unreadable path, or all problems of the file.
    pub fn robot(&self, name_or_path: &str) -> Result<RobotFile, FileError> {
        let found = self.find(Kind::Robot, name_or_path)?;
        RobotFile::parse(&found.name, &found.file, &found.text)
    }

    /// A world.
    ///
    /// # Errors
    /// As for [`Library::robot`].
    pub fn world(&self, name_or_path: &str) -> Result<WorldFile, FileError> {
        let found = self.find(Kind::World, name_or_path)?;
        WorldFile::parse(&found.name, &found.file, &found.text)
    }

    /// A scenario. Its robot, rig and world are looked up by [`Library::setup`] only.
    ///
    /// # Errors
    /// As for [`Library::robot`].
    pub fn scenario(&self, name_or_path: &str) -> Result<ScenarioFile, FileError> {
        let found = self.find(Kind::Scenario, name_or_path)?;
        let scenario = ScenarioFile::parse(&found.name, &found.file, &found.text)?;
        Ok(ScenarioFile {
            path: found.on_disk.then_some(found.file),
            ..scenario
        })
    }

    /// A policy.
    ///
    /// # Errors
    /// As for [`Library::robot`].
    pub fn policy(&self, name_or_path: &str) -> Result<PolicyFile, FileError> {
        let found = self.find(Kind::Policy, name_or_path)?;
        PolicyFile::parse(&found.name, &found.file, &found.text)
    }

    /// The text of a file.
    ///
    /// # Errors
    /// An unknown name, or an unreadable path.
    pub fn text(&self, kind: Kind, name_or_path: &str) -> Result<String, FileError> {
        Ok(self.find(kind, name_or_path)?.text)
    }

    /// The first of our robots that is so.
    pub fn robot_with(&self, is_so: impl Fn(&RobotFile) -> bool) -> Option<String> {
        let mut names = self.list(Kind::Robot).into_iter();
        names.find(|name| self.robot(name).is_ok_and(|robot| is_so(&robot)))
    }

    /// Names of the built-in files of a kind, in order.
    #[must_use]
    pub fn list(&self, kind: Kind) -> Vec<String> {
        kind.names()
    }

    fn find(&self, kind: Kind, name_or_path: &str) -> Result<Found, FileError> {
        if let Some(text) = self.held.get(&(kind, name_or_path.to_owned())) {
            return Ok(Found {
                name: name_or_path.to_owned(),
                file: format!("{} {name_or_path}", kind.word()),
                text: text.clone(),
                on_disk: false,
            });
        }
        if is_path(name_or_path) {
            let path = self.base.join(name_or_path);
            let text = bounded::read_text(&path).map_err(|error| {
                FileError::unreadable(
                    path.display().to_string(),
                    &error,
                    "the path of an existing file",
                )
            })?;
            let stem = path
                .file_stem()
                .map(|stem| stem.to_string_lossy().into_owned());
            return Ok(Found {
                name: stem.unwrap_or_default(),
                file: path.display().to_string(),
                text,
                on_disk: true,
            });
        }
        let text = kind.built_in(name_or_path).ok_or_else(|| {
            let names = kind.names();
            let near = near_or_all(name_or_path, names.iter().map(String::as_str));
            FileError::Unknown {
                kind: kind.word(),
                name: name_or_path.to_owned(),
                near,
            }
        })?;
        let file = format!("{}/{name_or_path}.toml", kind.folder());
        Ok(Found {
            name: name_or_path.to_owned(),
            file,
            text,
            on_disk: false,
        })
    }
}

fn is_path(name_or_path: &str) -> bool {
    name_or_path.ends_with(".toml") || name_or_path.contains(['/', '\\'])
}
