//! The program of the lab's emulated robot, and what happens when its files change: it starts again with the new one, or
//! stands still when there is none.

use super::SimulatedRobot;
use crate::workshop::{Made, Workshop, problem};
use rumbo_log::{Complaint, Level, ProgramPhase, ProgramState};
use rumbo_session::{LinkNews, TargetError};
use rumbo_sim::boards::Board;
use std::path::{Path, PathBuf};

/// The program at the pins.
pub(super) struct OwnProgram {
    name: String,
    phase: ProgramPhase,
    complaints: Vec<Complaint>,
    /// Its file is watched, and not only compiled once.
    watched: bool,
    /// Nothing is watched where the program is no file of the user's.
    workshop: Option<Workshop>,
}

impl OwnProgram {
    /// The program that was given by this name, which is watched if it is at a path.
    pub(super) fn new(
        given: &str,
        path: Option<&Path>,
        board: &'static Board,
    ) -> std::io::Result<Self> {
        let name = Path::new(given).file_name();
        Ok(Self {
            name: name.map_or_else(|| given.into(), |name| name.to_string_lossy().into_owned()),
            phase: ProgramPhase::Running,
            complaints: Vec::new(),
            watched: path.is_some(),
            workshop: path.map(|path| Workshop::watch(path, board)).transpose()?,
        })
    }

    /// A program that was dropped on the page.
    fn dropped(board: &'static Board, name: String, content: Vec<u8>) -> std::io::Result<Self> {
        let mut program = Self::new(&name, None, board)?;
        program.workshop = Some(Workshop::make_dropped(board, name, content)?);
        Ok(program)
    }

    /// Why it cannot be started.
    pub(super) fn is_rejected(&self) -> bool {
        self.phase == ProgramPhase::Rejected
    }
}

impl SimulatedRobot {
    /// For the page.
    pub(super) fn program_state(&self) -> Option<ProgramState> {
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
        })
    }

    /// Takes what the workshop has made.
    pub(super) fn renew_program(&mut self) {
        let program = self.program.as_mut();
        let made = program.and_then(|program| program.workshop.as_ref()?.next());
        match made {
            None => {}
            Some(Made::Begun) => self.enter(ProgramPhase::Compiling, Vec::new()),
            Some(Made::Image(path)) => self.start_program(path),
            Some(Made::Rejected(complaints)) => self.reject(complaints),
        }
    }

    /// Replaces the program by one that was dropped on the page, once it is compiled.
    pub(super) fn drop_program(
        &mut self,
        name: String,
        content: Vec<u8>,
    ) -> Result<(), TargetError> {
        let kind = Path::new(&name).extension().and_then(|kind| kind.to_str());
        if !matches!(kind, Some("ino" | "elf" | "hex")) {
            return Err(TargetError::NotAProgram);
        }
        let mega = self.sim.mega().ok_or(TargetError::NoChip)?;
        let program = OwnProgram::dropped(mega.firmware().board(), name, content);
        self.program = Some(program.map_err(|error| TargetError::Setup(error.to_string()))?);
        Ok(())
    }

    fn enter(&mut self, phase: ProgramPhase, complaints: Vec<Complaint>) {
        if let Some(program) = &mut self.program {
            (program.phase, program.complaints) = (phase, complaints);
        }
    }

    fn start_program(&mut self, image: PathBuf) {
        let before = self.overrides.firmware.replace(image);
        match self.start_again(self.scene.choice.clone()) {
            Ok(()) => {
                self.enter(ProgramPhase::Running, Vec::new());
                self.news.push_back(LinkNews::Renewed);
            }
            Err(error) => {
                self.overrides.firmware = before;
                self.reject(vec![problem(error.to_string())]);
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
