//! The program of the lab's emulated robot, and what happens when there is another one: the robot starts again with it,
//! or stands still when there is none.

use crate::manifest::hash_of;
use crate::robot::SimulatedRobot;
use rumbo_emulator::devices::CLOCK_HZ;
use rumbo_emulator::image::Image;
use rumbo_emulator::observe::profile::Profile;
use rumbo_experiment::files::{FileError, Setup, firmware};
use rumbo_log::{
    Complaint, FunctionShare, InterruptShare, Level, ProgramPhase, ProgramProfile, ProgramState,
};
use rumbo_session::{LinkNews, TargetError};
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
#[derive(Debug)]
pub enum Made {
    /// The program has changed and is being compiled.
    Begun,
    /// The file of the new image.
    Image(PathBuf),
    /// Why there is none.
    Rejected(Vec<Complaint>),
}

/// A workshop for a program that was dropped on the page, for this emulated board, if there is one: the name of its
/// file and its content.
pub type Make =
    fn(Option<&'static Board>, String, Vec<u8>) -> Result<Box<dyn Workshop>, TargetError>;

/// What is wrong with no line in particular.
#[must_use]
pub fn problem(text: String) -> Complaint {
    Complaint {
        text,
        ..Complaint::default()
    }
}

/// Most functions that the page lists.
const FUNCTIONS: usize = 30;

/// A profile for the page.
fn shares(profile: &Profile) -> ProgramProfile {
    let functions = profile.costliest(FUNCTIONS).into_iter();
    let interrupts = profile.interrupts().into_iter();
    ProgramProfile {
        cycles: profile.cycles(),
        asleep: profile.cycles_asleep(),
        hertz: CLOCK_HZ as u32,
        functions: functions
            .map(|each| FunctionShare {
                name: each.name,
                calls: each.calls,
                own: each.own,
                total: each.total,
            })
            .collect(),
        interrupts: interrupts
            .map(|each| InterruptShare {
                vector: each.vector,
                name: profile.vector_name(each.vector).to_owned(),
                count: each.count,
                total: each.total,
                mean: each.mean(),
                longest: each.longest,
                worst_latency: each.worst_latency,
            })
            .collect(),
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
    name: String,
    phase: ProgramPhase,
    complaints: Vec<Complaint>,
    /// Its file is watched, and not only compiled once.
    watched: bool,
    /// Nothing is made where the program is no file of the user's.
    workshop: Option<Box<dyn Workshop>>,
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
        }
    }

    /// Why it cannot be started.
    pub(crate) fn is_rejected(&self) -> bool {
        self.phase == ProgramPhase::Rejected
    }
}

impl SimulatedRobot {
    /// For the page.
    pub(crate) fn program_state(&self) -> Option<ProgramState> {
        let (mega, program) = (self.sim.mega()?, self.program.as_ref());
        Some(ProgramState {
            name: match program {
                Some(program) => program.name.clone(),
                None => mega.firmware().name().to_owned(),
            },
            link_usart: mega.firmware().link_usart(),
            watched: program.is_some_and(|program| program.watched),
            phase: program.map(|program| program.phase).unwrap_or_default(),
            complaints: program.map_or_else(Vec::new, |program| program.complaints.clone()),
            profile: mega.chip().observers().profiled().map(shares),
        })
    }

    /// Takes what the workshop has made.
    pub(crate) fn renew_program(&mut self) {
        let program = self.program.as_mut();
        let made = program.and_then(|program| program.workshop.as_mut()?.next());
        match made {
            None => {}
            Some(Made::Begun) => self.enter(ProgramPhase::Compiling, Vec::new()),
            Some(Made::Image(path)) => self.start_program(path),
            Some(Made::Rejected(complaints)) => self.reject(complaints),
        }
    }

    /// Replaces the program by one that was dropped on the page: an image at once, another one when it is compiled.
    pub(crate) fn drop_program(
        &mut self,
        name: String,
        content: Vec<u8>,
    ) -> Result<(), TargetError> {
        let kind = Path::new(&name).extension().and_then(|kind| kind.to_str());
        if !matches!(kind, Some("ino" | "elf" | "hex")) {
            return Err(TargetError::NotAProgram);
        }
        let Some(make) = self.make else {
            return match kind {
                Some("ino") => Err(TargetError::NoCompiler),
                _ => self.start_held(&name, &content),
            };
        };
        let workshop = make(self.chip_board(), name.clone(), content)?;
        self.program = Some(OwnProgram {
            watched: false,
            ..OwnProgram::new(&name, Some(workshop))
        });
        Ok(())
    }

    /// Starts again with an image; without one that fits, the robot goes on as it is.
    fn start_held(&mut self, name: &str, bytes: &[u8]) -> Result<(), TargetError> {
        let wrong = |error: FileError| TargetError::Setup(error.to_string());
        let held = Held::new(name, bytes).map_err(wrong)?;
        let before = self.held.replace(held);
        if let Err(error) = self.start_again(self.scene.choice.clone()) {
            self.held = before;
            return Err(wrong(error));
        }
        self.program = Some(OwnProgram::new(name, None));
        self.news.push_back(LinkNews::Renewed);
        Ok(())
    }

    fn enter(&mut self, phase: ProgramPhase, complaints: Vec<Complaint>) {
        if let Some(program) = &mut self.program {
            (program.phase, program.complaints) = (phase, complaints);
        }
    }

    fn start_program(&mut self, image: PathBuf) {
        let shown = image.display().to_string();
        let before = self.overrides.firmware.replace(image);
        match self.start_again(self.scene.choice.clone()) {
            Ok(()) => {
                self.enter(ProgramPhase::Running, Vec::new());
                self.news.push_back(LinkNews::Renewed);
            }
            Err(error) => {
                self.overrides.firmware = before;
                // By its name: which file that is, and in whose folder, no page says.
                let name = self.program.as_ref().map_or("", |program| &program.name);
                let text = error.to_string().replace(&shown, name);
                self.reject(vec![problem(text)]);
            }
        }
    }

    fn reject(&mut self, complaints: Vec<Complaint>) {
        self.sim.switch_off();
        let text = "the changed program does not compile: the robot is switched off until it does";
        self.news
            .push_back(LinkNews::Program(Level::Fault, text.into()));
        for Complaint { place, text, .. } in &complaints {
            let place = place.as_ref().map(|place| format!("{place}: "));
            let text = format!("compiler: {}{text}", place.unwrap_or_default());
            self.news.push_back(LinkNews::Program(Level::Warning, text));
        }
        self.enter(ProgramPhase::Rejected, complaints);
    }
}
