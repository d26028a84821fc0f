//! The simulated robot behind the interface of a session's target.

mod debugging;
mod playing;
mod programs;

use crate::hand::{self, HAND};
use crate::in_hand::InHand;
use crate::play::Experiment;
use crate::prepare::{Prepared, prepare};
use crate::program::{Held, OwnProgram, Sketches};
use crate::sight;
use rumbo_control::mode::ModeId;
use rumbo_control::params::Params;
use rumbo_experiment::files::{FileError, Library, Overrides};
use rumbo_log::{Burst, Choice, ExperimentState, Level, Manifest, ProgramState, Scene, Truth};
use rumbo_session::{
    Abilities, EditedWorld, GivenProgram, LinkNews, Shown, ShownSketch, Standing, Target,
    TargetError,
};
use rumbo_sim::Sim;
use rumbo_sim::boards::Board;
use rumbo_sim::debugging::Debugging;
use rumbo_sim::mega::{Mega, USB};
use rumbo_wire::Command;
use serde_json::Value;
use std::collections::VecDeque;

/// Another program at the USB port of an emulated Mega.
pub trait Cable: Send {
    /// What the other program has sent since the last call.
    fn read(&mut self) -> &[u8];

    /// What the Mega has sent.
    fn write(&mut self, bytes: &[u8]);
}

/// A simulated robot, with what is connected to it.
pub struct SimulatedRobot {
    pub(crate) library: Library,
    /// The overrides of the command line; the page chooses scenario, world and rig.
    pub(crate) overrides: Overrides,
    /// An image that was dropped on the page, in place of that of the overrides.
    pub(crate) held: Option<Held>,
    pub(crate) sim: Sim,
    debugging: Option<Debugging>,
    /// The page's debugger has the program; then `sim` is a copy of what it holds.
    pub(crate) in_hand: Option<InHand>,
    usb: Option<Box<dyn Cable>>,
    /// The program that the user gave, if it is one for the emulated Mega.
    pub(crate) program: Option<OwnProgram>,
    pub(crate) sketches: Option<Sketches>,
    pub(crate) manifest: Manifest,
    mode: ModeId,
    /// When the instruments are read next \[us\].
    reading_due_us: u64,
    /// The cycles of the emulated program are counted.
    profiling: bool,
    /// The emulated program's end has been reported.
    ended: bool,
    /// What has happened to the program and is not reported yet.
    pub(crate) news: VecDeque<LinkNews>,
    pub(crate) scene: Scene,
    first_commands: Vec<Command>,
    /// Its scenario commands it, or has done so since its start.
    pub(crate) experiment: Option<Experiment>,
}

impl SimulatedRobot {
    /// The robot of a choice at its start, by the overrides.
    ///
    /// # Errors
    /// The problems of the files that they name.
    pub fn new(overrides: Overrides, choice: Choice) -> Result<Self, FileError> {
        Self::of(Library::new(), overrides, choice)
    }

    /// The same with the files of a library.
    ///
    /// # Errors
    /// The same.
    pub fn of(library: Library, overrides: Overrides, choice: Choice) -> Result<Self, FileError> {
        let Prepared {
            sim,
            mode,
            mut scene,
            first_commands,
            manifest,
        } = prepare(&library, &overrides, None, &choice, &[])?.swap_remove(0);
        if let Some(world) = &scene.choice.world
            && !scene.worlds.contains(world)
        {
            scene.worlds.push(world.clone());
        }
        let caveat = sim.mega().and_then(Mega::data_sheet);
        let caveat = caveat.map(|text| LinkNews::Program(Level::Info, text));
        Ok(Self {
            library,
            overrides,
            held: None,
            sim,
            debugging: None,
            in_hand: None,
            usb: None,
            program: None,
            sketches: None,
            manifest,
            mode,
            reading_due_us: 0,
            profiling: false,
            ended: false,
            news: caveat.into_iter().collect(),
            scene,
            first_commands,
            experiment: None,
        })
    }

    /// Lets a debugger in.
    pub fn debug(&mut self, debugging: Debugging) {
        self.debugging = Some(debugging);
    }

    /// Connects another program to the USB port of the emulated Mega.
    pub fn plug_in(&mut self, usb: Box<dyn Cable>) {
        self.usb = Some(usb);
    }

    /// Names the program that runs on the emulated Mega, and renews it by its workshop.
    pub fn own_program(&mut self, program: OwnProgram) {
        self.program = Some(program);
    }

    /// Makes images of the programs of the page, and shows it examples. Without it only images are taken.
    pub fn take_sketches(&mut self, sketches: Sketches) {
        self.sketches = Some(sketches);
    }

    /// The board of the emulated chip, if there is one.
    #[must_use]
    pub fn chip_board(&self) -> Option<&'static Board> {
        Some(self.sim.mega()?.firmware().board())
    }
}

/// Sends bytes to a USART of the emulated chip, over the link if it is the link's; whether there is a chip. To [`HAND`] what
/// a hand does.
pub fn type_to(sim: &mut Sim, usart: u8, bytes: &[u8]) -> bool {
    if usart == HAND {
        rumbo_experiment::hand::act(sim, bytes);
        return true;
    }
    let Some(mega) = sim.mega_mut() else {
        return false;
    };
    if mega.firmware().link_usart() == Some(usart) {
        sim.send(bytes);
    } else {
        mega.type_in(usart, bytes);
    }
    true
}

impl SimulatedRobot {
    /// Makes it accept the bytes meant for another robot, timed by that one's clock.
    pub fn be_ghost(&mut self) {
        self.sim.be_ghost();
    }

    /// Lifts the robot so that its wheels turn freely, or puts it down.
    pub fn lift(&mut self, wheels_in_air: bool) {
        self.sim.lift(wheels_in_air);
    }

    /// Its parameters, as drawn for the seed.
    #[must_use]
    pub fn params(&self) -> &rumbo_plant::params::Params {
        self.sim.params()
    }

    /// Moves the robot.
    pub fn place(&mut self, Standing { at, estimated }: Standing) {
        let at = rumbo_plant::contact::Pose {
            x_m: at.x_m,
            y_m: at.y_m,
            heading_rad: at.heading_rad,
        };
        let estimate = rumbo_control::Pose {
            x_m: estimated.x_m as f32,
            y_m: estimated.y_m as f32,
            heading_rad: estimated.heading_rad as f32,
        };
        self.sim.place(at, estimate);
    }
}

impl Target for SimulatedRobot {
    fn now_us(&self) -> u64 {
        let reached_us = self.in_hand.as_ref().map(InHand::reached_us);
        reached_us.unwrap_or_else(|| self.sim.now_us())
    }

    fn advance(&mut self, dt_us: u64) -> Result<(), TargetError> {
        if let Some(in_hand) = &mut self.in_hand {
            in_hand.pass();
            self.look();
            return Ok(());
        }
        if let (Some(usb), Some(mega)) = (&mut self.usb, self.sim.mega_mut()) {
            mega.type_in(USB, usb.read());
        }
        if let Some(experiment) = &mut self.experiment {
            experiment.pass(&mut self.sim, dt_us);
            return Ok(());
        }
        // After a breakpoint, back to the multiples of the step.
        let until_us = (self.sim.now_us() / dt_us.max(1) + 1) * dt_us;
        match &mut self.debugging {
            Some(debugging) => debugging.advance(&mut self.sim, until_us),
            None => self.sim.advance(until_us),
        }
        Ok(())
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), TargetError> {
        if !self.plays() {
            self.act(|sim| sim.send(bytes));
        }
        Ok(())
    }

    fn receive(&mut self, into: &mut Vec<u8>) {
        if let Some(experiment) = &mut self.experiment {
            experiment.receive(into);
        }
        if let Some(in_hand) = &mut self.in_hand {
            in_hand.receive(into);
        } else if !self.plays() {
            self.sim.receive(into);
        }
    }

    fn play(&mut self, parameters: &[(u8, f32)]) -> Result<(), TargetError> {
        if self.program.as_ref().is_some_and(OwnProgram::is_rejected) {
            return Err(TargetError::NotCompiled);
        }
        self.begin_experiment(parameters)
            .map_err(|error| TargetError::Setup(error.to_string()))
    }

    fn end_play(&mut self) {
        if let Some(experiment) = &mut self.experiment {
            experiment.stop();
        }
    }

    fn experiment(&self) -> Option<ExperimentState> {
        self.experiment.as_ref().map(|each| each.state.clone())
    }

    fn scripted(&mut self) -> Vec<Burst> {
        let experiment = self.experiment.as_mut();
        experiment.map(Experiment::scripted).unwrap_or_default()
    }

    fn parameters(&self) -> Option<Params> {
        self.experiment.as_ref()?.parameters
    }

    fn baud(&self) -> u32 {
        self.sim.baud()
    }

    fn manifest(&self) -> Manifest {
        self.manifest.clone()
    }

    fn abilities(&self) -> Abilities {
        sight::abilities(&self.sim, self.mode)
    }

    fn truth(&self) -> Option<Truth> {
        Some(match &self.in_hand {
            Some(in_hand) => in_hand.truth(),
            None => sight::truth(&self.sim),
        })
    }

    fn shown(&mut self) -> Vec<Shown> {
        if let Some(in_hand) = &mut self.in_hand {
            let shown = in_hand.take_shown().into_iter();
            return shown.chain(hand::moved(&self.sim)).collect();
        }
        match sight::reading_due(&self.sim, &mut self.reading_due_us) {
            true => {
                let shown = sight::shown(&mut self.sim);
                shown.into_iter().chain(hand::moved(&self.sim)).collect()
            }
            false => Vec::new(),
        }
    }

    fn scene(&self) -> Option<Scene> {
        Some(self.scene.clone())
    }

    fn consoles(&mut self) -> Vec<(u8, Vec<u8>)> {
        let said = match &mut self.in_hand {
            Some(in_hand) => in_hand.take_consoles(),
            None => sight::consoles(&mut self.sim),
        };
        if let (Some(usb), Some((USB, bytes))) = (&mut self.usb, said.first()) {
            usb.write(bytes);
        }
        said
    }

    fn program(&self) -> Option<ProgramState> {
        self.program_state()
    }

    fn news(&mut self) -> Option<LinkNews> {
        self.renew_program();
        if let Some(debugging) = &mut self.debugging {
            let news = debugging.take_news().into_iter();
            self.news.extend(news.map(LinkNews::Held));
        }
        if !self.ended {
            let ended = self.sim.verdict().map(LinkNews::Ended);
            let stands = || {
                let mega = self.sim.mega()?;
                let (name, why) = (mega.firmware().name(), mega.standstill()?);
                let why = format!("firmware {name}: {why}");
                Some(LinkNews::Program(Level::Warning, why))
            };
            let end = ended.or_else(stands);
            self.ended = end.is_some();
            self.news.extend(end);
        }
        self.news.pop_front()
    }

    fn type_in(&mut self, usart: u8, text: &str) -> Result<(), TargetError> {
        match self.act(|sim| type_to(sim, usart, text.as_bytes())) {
            true => Ok(()),
            false => Err(TargetError::NoChip),
        }
    }

    fn profile(&mut self, on: bool) -> Result<(), TargetError> {
        if self.sim.mega().is_none() {
            return Err(TargetError::NoChip);
        }
        if self.in_hand.is_some() {
            return Err(TargetError::Debugged);
        }
        self.profiling = on;
        self.begin_profile();
        Ok(())
    }

    fn supply_motors(&mut self, on: bool) {
        self.act(|sim| sim.supply_motors(on));
    }

    fn run_program(&mut self, program: GivenProgram) -> Result<(), TargetError> {
        self.take_program(program)
    }

    fn sketch(&mut self, example: Option<&str>) -> ShownSketch {
        self.source(example)
    }

    fn ask_debugger(&mut self, request: &Value) -> Result<(), TargetError> {
        self.pass_to_debugger(request)
    }

    fn take_debug(&mut self) -> Vec<Value> {
        let in_hand = self.in_hand.as_mut();
        in_hand.map(InHand::take_messages).unwrap_or_default()
    }

    fn first_commands(&self) -> Vec<Command> {
        self.first_commands.clone()
    }

    fn reset(&mut self, choice: &Choice) -> Result<(), TargetError> {
        // The page chooses among names it was given; it opens no files.
        let Scene {
            experiments,
            worlds,
            ..
        } = &self.scene;
        let offered = experiments.iter().any(|each| each.name == choice.scenario)
            && choice.world.iter().all(|world| worlds.contains(world));
        if !offered {
            return Err(TargetError::NotOffered);
        }
        if self.program.as_ref().is_some_and(OwnProgram::is_rejected) {
            return Err(TargetError::NotCompiled);
        }
        self.start_again(choice.clone())
            .map_err(|error| TargetError::Setup(error.to_string()))
    }

    fn world(&mut self, given: Option<&str>) -> EditedWorld {
        self.to_edit(given)
    }

    fn drive_in(&mut self, world: &str) -> Result<Choice, TargetError> {
        self.start_in(world)
    }
}

impl SimulatedRobot {
    /// Its scenario commands it.
    fn plays(&self) -> bool {
        self.experiment.as_ref().is_some_and(Experiment::goes_on)
    }

    /// Takes another simulation, at its start.
    pub(crate) fn start_with(&mut self, sim: Sim, manifest: Manifest) {
        (self.sim, self.in_hand) = (sim, None);
        if let Some(debugging) = &mut self.debugging {
            debugging.forget();
        }
        self.begin_profile();
        (self.reading_due_us, self.ended) = (0, false);
        self.manifest = manifest;
        self.experiment = None;
    }

    /// Starts again from time 0, as switched off and on again: saved parameters persist.
    pub(crate) fn start_again(&mut self, choice: Choice) -> Result<(), FileError> {
        let memories = [self.sim.memory()];
        let held = self.held.as_ref();
        let fresh =
            prepare(&self.library, &self.overrides, held, &choice, &memories)?.swap_remove(0);
        // What the command line added to the lists stays there.
        let Scene {
            experiments,
            worlds,
            world_titles,
            ..
        } = std::mem::take(&mut self.scene);
        self.start_with(fresh.sim, fresh.manifest);
        self.mode = fresh.mode;
        self.first_commands = fresh.first_commands;
        self.scene = Scene {
            experiments,
            worlds,
            world_titles,
            ..fresh.scene
        };
        Ok(())
    }
}
