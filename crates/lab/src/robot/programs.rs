//! What happens when there is another program: the robot starts again with it, or stands still when there is none.

use super::SimulatedRobot;
use crate::in_hand::{Attach, InHand};
use crate::prepare::set_up;
use crate::program::{Held, Made, OwnProgram, problem, shown};
use rumbo_emulator::devices::CLOCK_HZ;
use rumbo_emulator::observe::profile::Profile;
use rumbo_experiment::files::{FileError, Kind, RobotFile};
use rumbo_log::{
    Choice, Complaint, FunctionShare, InterruptShare, Level, PartState, ProgramPhase,
    ProgramProfile, ProgramState,
};
use rumbo_session::{GivenProgram, LinkNews, ShownSketch, TargetError};
use rumbo_sim::Sim;
use rumbo_sim::boards::Board;
use rumbo_sim::bus::BusDevice;
use rumbo_sim::wiring::Part;
use std::path::{Path, PathBuf};

/// Most functions that the page lists.
const FUNCTIONS: usize = 30;

/// The robot that a page has wired, among the robots.
const WIRED: &str = "wired";
/// The scenario in which it starts, and the worlds of robots that look at lines and at lamps.
const FREE: &str = "free";
const LINES: &str = "line_loop";
const LAMPS: &str = "lamps";

/// What the text of a robot's file says.
fn file_of(text: &str) -> Result<RobotFile, TargetError> {
    RobotFile::parse(WIRED, "robot.toml", text)
        .map_err(|error| TargetError::Setup(error.to_string()))
}

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

fn part_state((part, value): (&Part, f64)) -> PartState {
    PartState {
        name: part.name.clone(),
        kind: part.kind.name().to_owned(),
        percent: (100.0 * value).round() as u8,
        keys: part.keys.iter().map(|(key, _)| key.clone()).collect(),
        ..PartState::default()
    }
}

fn device_state(device: &BusDevice) -> PartState {
    PartState {
        name: device.name.clone(),
        kind: device.kind.name().to_owned(),
        address: device.address(),
        ..PartState::default()
    }
}

impl SimulatedRobot {
    /// For the page; there is no chip yet while its first program is made.
    pub(crate) fn program_state(&self) -> Option<ProgramState> {
        let robots = self.robots.lock();
        let [only] = &robots.all[..] else {
            return None;
        };
        let state = match &self.program {
            Some(program) => ProgramState {
                name: program.name.clone(),
                watched: program.watched,
                phase: program.phase,
                complaints: program.complaints.clone(),
                ..ProgramState::default()
            },
            None => ProgramState {
                name: only.sim.mega()?.firmware().name().to_owned(),
                ..ProgramState::default()
            },
        };
        let Some(mega) = only.sim.mega() else {
            return Some(state);
        };
        let devices = mega.firmware().bus().iter().map(device_state);
        Some(ProgramState {
            link_usart: mega.firmware().link_usart(),
            parts: mega.parts().map(part_state).chain(devices).collect(),
            profile: mega.chip().observers().profiled().map(shares),
            held: self.in_hand.as_ref().map(InHand::state),
            ..state
        })
    }

    /// Counts the cycles of the program at the pins from zero, if they are to be counted.
    pub(crate) fn begin_profile(&self) {
        self.sim(|sim| {
            let Some(mega) = sim.mega_mut() else {
                return;
            };
            let counts = self
                .profiling
                .then(|| Profile::new(mega.firmware().image()));
            let observers = mega.chip_mut().observers_mut();
            match counts {
                Some(counts) => observers.profile(counts),
                None => observers.end_profile(),
            }
        });
    }

    /// Takes what the workshop has made.
    pub(crate) fn renew_program(&mut self) {
        let program = self.program.as_mut();
        let made = program.and_then(|program| program.workshop.as_mut()?.next());
        match made {
            None => {}
            Some(Made::Begun) => self.enter(ProgramPhase::Compiling, Vec::new()),
            Some(Made::Image(path)) => self.start_program(path, None),
            Some(Made::Debugged(path, attach)) => self.start_program(path, Some(attach)),
            Some(Made::Rejected(complaints)) => self.reject(complaints),
        }
    }

    /// Replaces the program by one of the page: an image at once, another one when it is compiled.
    pub(crate) fn take_program(&mut self, program: GivenProgram) -> Result<(), TargetError> {
        let kind = |name: &str| {
            let kind = Path::new(name).extension().and_then(|kind| kind.to_str());
            kind.filter(|kind| ["ino", "elf", "hex"].contains(kind))
                .map(|kind| kind == "ino")
        };
        let mut kinds = program.files.iter().filter_map(|(name, _)| kind(name));
        let is_sketch = kinds.next().ok_or(TargetError::NotAProgram)?;
        let Some(sketches) = self.sketches else {
            return match (is_sketch, &program.files[..]) {
                (false, [(name, content)]) => self.start_held(name, content),
                _ => Err(TargetError::NoCompiler),
            };
        };
        if program.debug && self.debugging.is_some() {
            return Err(TargetError::Debugged);
        }
        let board = match &program.robot {
            Some(text) => file_of(text)?.board,
            None => self.board()?,
        };
        let workshop = (sketches.make)(board, program.clone())?;
        let own = OwnProgram {
            watched: false,
            phase: ProgramPhase::Compiling,
            robot: program.robot.clone(),
            ..OwnProgram::new(&program.name, Some(workshop))
        };
        self.program = Some(match is_sketch {
            true => own.from_source(move || program.files.clone()),
            false => own,
        });
        Ok(())
    }

    /// Takes another robot, by the text of its file, for the next start: in the scenario that commands nothing.
    fn with_robot(&mut self, text: &str) -> Choice {
        self.library = self.library.clone().holding(Kind::Robot, WIRED, text);
        self.overrides.robot = Some(WIRED.into());
        self.overrides.wiring = None;
        let before = self.choice();
        let robot = file_of(text).ok();
        let wiring = robot.iter().find_map(|robot| robot.wirings.values().next());
        let its_world = wiring.and_then(|wiring| {
            let lines = (!wiring.line_sensors.is_empty()).then_some(LINES);
            lines.or_else(|| (!wiring.light_sensors.is_empty()).then_some(LAMPS))
        });
        let world = before.world.filter(|_| before.scenario == FREE);
        Choice {
            scenario: FREE.into(),
            world: world.or_else(|| its_world.map(str::to_owned)),
            rig: None,
            seed: before.seed,
        }
    }

    /// The board that a program is for.
    fn board(&self) -> Result<&'static Board, TargetError> {
        if let Some(board) = self.chip_board() {
            return Ok(board);
        }
        let setup = set_up(&self.library, &self.overrides, None, &self.choice());
        let (setup, _) = setup.map_err(|error| TargetError::Setup(error.to_string()))?;
        Ok(setup.robot.board)
    }

    /// The source of the program, or of an example.
    pub(crate) fn source(&self, example: Option<&str>) -> ShownSketch {
        let examples = self.sketches.map(|sketches| (sketches.examples)());
        let (name, files) = match (example, &self.program) {
            (Some(name), _) => {
                let files = self.sketches.and_then(|sketches| (sketches.example)(name));
                (name, files)
            }
            (None, Some(program)) => {
                let files = program.source.as_ref().map(|source| source());
                (program.name.as_str(), files)
            }
            (None, None) => ("", None),
        };
        ShownSketch {
            name: name.strip_suffix(".ino").unwrap_or(name).to_owned(),
            files: shown(files.unwrap_or_default()),
            examples: examples.unwrap_or_default(),
            ..ShownSketch::default()
        }
    }

    /// Starts again with an image; without one that fits, the robot goes on as it is.
    fn start_held(&mut self, name: &str, bytes: &[u8]) -> Result<(), TargetError> {
        let wrong = |error: FileError| TargetError::Setup(error.to_string());
        let held = Held::new(name, bytes).map_err(wrong)?;
        let before = self.held.replace(held);
        if let Err(error) = self.start_again(&self.choice()) {
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

    fn start_program(&mut self, image: PathBuf, attach: Option<Attach>) {
        let shown = image.display().to_string();
        let before = (self.library.clone(), self.overrides.clone());
        self.overrides.firmware = Some(image);
        let robot = self
            .program
            .as_mut()
            .and_then(|program| program.robot.take());
        let choice = match robot {
            Some(text) => self.with_robot(&text),
            None => self.choice(),
        };
        match self.start_again(&choice) {
            Ok(()) => {
                self.enter(ProgramPhase::Running, Vec::new());
                self.in_hand =
                    attach.and_then(|attach| InHand::new(attach, self.sim(|sim| sim.clone())));
                self.news.push_back(LinkNews::Renewed);
            }
            Err(error) => {
                (self.library, self.overrides) = before;
                // By its name: which file that is, and in whose folder, no page says.
                let name = self.program.as_ref().map_or("", |program| &program.name);
                let text = error.to_string().replace(&shown, name);
                self.reject(vec![problem(text)]);
            }
        }
    }

    fn reject(&mut self, complaints: Vec<Complaint>) {
        self.sim(Sim::switch_off);
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
