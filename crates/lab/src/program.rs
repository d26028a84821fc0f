//! The program of the lab's emulated robot, and what makes its images.

use crate::in_hand::Attach;
use crate::manifest::hash_of;
use rumbo_emulator::image::Image;
use rumbo_experiment::files::{FileError, Setup, firmware};
use rumbo_log::{Complaint, ProgramPhase};
use rumbo_session::{GivenProgram, SketchFile, TargetError};
use rumbo_sim::boards::Board;
use rumbo_sim::mega::firmware::Firmware;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Makes the images of a program in its own time: when its files change, or once.
pub trait Workshop: Send {
    /// What it has made since the last call, oldest first.
    fn next(&mut self) -> Option<Made>;
}

/// What a workshop says.
pub enum Made {
    /// The program has changed and is being compiled.
    Begun,
    /// The file of the new image.
    Image(PathBuf),
    /// The same, and a debugger for it.
    Debugged(PathBuf, Attach),
    /// Why there is none.
    Rejected(Vec<Complaint>),
}

/// A workshop for a program of the page, for this board.
pub type Make = fn(&'static Board, GivenProgram) -> Result<Box<dyn Workshop>, TargetError>;

/// Files by name.
type Files = Vec<(String, Vec<u8>)>;

/// What is known of sketches where there is a compiler.
#[derive(Clone, Copy)]
pub struct Sketches {
    /// Makes what the page hands in.
    pub make: Make,
    /// Names of the examples.
    pub examples: fn() -> Vec<String>,
    /// The files of one.
    pub example: fn(&str) -> Option<Files>,
}

/// Files as a page shows them: those that are text.
pub(crate) fn shown(files: Files) -> Vec<SketchFile> {
    let text = |(name, bytes)| {
        let text = String::from_utf8(bytes).ok()?;
        Some(SketchFile { name, text })
    };
    files.into_iter().filter_map(text).collect()
}

/// What is wrong with no line in particular.
#[must_use]
pub fn problem(text: String) -> Complaint {
    Complaint {
        text,
        ..Complaint::default()
    }
}

/// An image in memory.
#[derive(Clone)]
pub(crate) struct Held {
    pub(crate) name: String,
    /// Of its file, as the manifest has it.
    pub(crate) hash: String,
    image: Image,
}

impl Held {
    pub(crate) fn new(name: &str, bytes: &[u8]) -> Result<Self, FileError> {
        let wrong = |error| FileError::Setting(format!("firmware {name}: {error}"));
        Ok(Self {
            name: name.to_owned(),
            hash: hash_of(bytes),
            image: Image::parse(bytes).map_err(wrong)?,
        })
    }

    /// The image in the wiring that it is for.
    pub(crate) fn firmware(
        &self,
        setup: &Setup,
        wiring: Option<&str>,
    ) -> Result<Arc<Firmware>, FileError> {
        let Setup {
            robot, scenario, ..
        } = setup;
        let image = self.image.clone();
        firmware::wired(&self.name, image, wiring, robot, scenario).map(Arc::new)
    }
}

/// The program at the pins.
pub struct OwnProgram {
    pub(crate) name: String,
    pub(crate) phase: ProgramPhase,
    pub(crate) complaints: Vec<Complaint>,
    /// Its file is watched, and not only compiled once.
    pub(crate) watched: bool,
    /// Nothing is made where the program is no file of the user's.
    pub(crate) workshop: Option<Box<dyn Workshop>>,
    /// Gives its source as it is now.
    pub(crate) source: Option<Box<dyn Fn() -> Files + Send>>,
    /// The robot that it drives from its first image on, by the text of its file.
    pub(crate) robot: Option<String>,
}

impl OwnProgram {
    /// The program that was given by this name or path; it is renewed by its workshop, if it has one.
    #[must_use]
    pub fn new(given: &str, workshop: Option<Box<dyn Workshop>>) -> Self {
        let name = Path::new(given).file_name();
        Self {
            name: name.map_or_else(|| given.into(), |name| name.to_string_lossy().into_owned()),
            phase: ProgramPhase::Running,
            complaints: Vec::new(),
            watched: workshop.is_some(),
            workshop,
            source: None,
            robot: None,
        }
    }

    /// With what gives its source as it is now.
    #[must_use]
    pub fn from_source(self, source: impl Fn() -> Files + Send + 'static) -> Self {
        Self {
            source: Some(Box::new(source)),
            ..self
        }
    }

    /// Why it cannot be started.
    pub(crate) fn is_rejected(&self) -> bool {
        self.phase == ProgramPhase::Rejected
    }
}
