//! The simulated robot behind the interface of a session's target.

mod debugging;
mod playing;
mod programs;
mod target;

use crate::hand::HAND;
use crate::in_hand::InHand;
use crate::play::Experiment;
use crate::prepare::Prepared;
use crate::program::{Held, OwnProgram, Sketches};
use crate::robots::{Robots, Shared, with_copies};
use rumbo_experiment::files::{FileError, Library, Overrides};
use rumbo_log::{Choice, Level};
use rumbo_session::{LinkNews, Standing};
use rumbo_sim::Sim;
use rumbo_sim::boards::Board;
use rumbo_sim::debugging::Debugging;
use rumbo_sim::mega::Mega;
use std::collections::VecDeque;

/// Another program at the USB port of an emulated Mega.
pub trait Cable: Send {
    /// What the other program has sent since the last call.
    fn read(&mut self) -> &[u8];

    /// What the Mega has sent.
    fn write(&mut self, bytes: &[u8]);
}

/// A simulated robot, one of those in its world, with what is connected to it. Debuggers, programs of the page and
/// experiments are for one that is alone.
pub struct SimulatedRobot {
    pub(crate) robots: Shared,
    number: usize,
    /// The start that it has seen.
    start: u32,
    pub(crate) library: Library,
    /// The overrides of the command line; the page chooses scenario, world and rig.
    pub(crate) overrides: Overrides,
    /// An image that was dropped on the page, in place of that of the overrides.
    pub(crate) held: Option<Held>,
    debugging: Option<Debugging>,
    /// The page's debugger has the program; then the simulation is a copy of what it holds.
    pub(crate) in_hand: Option<InHand>,
    usb: Option<Box<dyn Cable>>,
    /// The program that the user gave, if it is one for the emulated Mega.
    pub(crate) program: Option<OwnProgram>,
    pub(crate) sketches: Option<Sketches>,
    /// When the instruments are read next \[us\].
    reading_due_us: u64,
    /// The cycles of the emulated program are counted.
    profiling: bool,
    /// The emulated program's end has been reported.
    ended: bool,
    /// What has happened to the program and is not reported yet.
    pub(crate) news: VecDeque<LinkNews>,
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
        let robots = Robots::begin(&library, &overrides, None, &choice, &[], 1)?;
        Ok(Self::one_of(&Shared::new(robots), 0, library, overrides))
    }

    /// The robots of a scenario at their start, in order; or as many copies of its robot as asked for.
    ///
    /// # Errors
    /// The problems of the files that overrides and choice name; copies of robots that are several already.
    pub fn all(
        library: Library,
        overrides: Overrides,
        choice: &Choice,
        robots: usize,
    ) -> Result<Vec<Self>, FileError> {
        let library = with_copies(library, &overrides, choice, robots)?;
        let begun = Robots::begin(&library, &overrides, None, choice, &[], usize::MAX)?;
        let count = begun.all.len();
        let shared = Shared::new(begun);
        let robot = |number| Self::one_of(&shared, number, library.clone(), overrides.clone());
        Ok((0..count).map(robot).collect())
    }

    /// The robot of this number, with the files of all.
    fn one_of(robots: &Shared, number: usize, library: Library, overrides: Overrides) -> Self {
        let robot = Self {
            robots: robots.clone(),
            number,
            start: 0,
            library,
            overrides,
            held: None,
            debugging: None,
            in_hand: None,
            usb: None,
            program: None,
            sketches: None,
            reading_due_us: 0,
            profiling: false,
            ended: false,
            news: VecDeque::new(),
            experiment: None,
        };
        let caveat = robot.sim(|sim| sim.mega().and_then(Mega::data_sheet));
        let caveat = caveat.map(|text| LinkNews::Program(Level::Info, text));
        Self {
            news: caveat.into_iter().collect(),
            ..robot
        }
    }

    /// What a scenario of several calls it; empty for one that is alone.
    #[must_use]
    pub fn name(&self) -> String {
        self.prepared(|robot| robot.name().to_owned())
    }

    pub(crate) fn prepared<T>(&self, what: impl FnOnce(&mut Prepared) -> T) -> T {
        what(&mut self.robots.lock().all[self.number])
    }

    pub(crate) fn sim<T>(&self, what: impl FnOnce(&mut Sim) -> T) -> T {
        self.prepared(|robot| what(&mut robot.sim))
    }

    pub(crate) fn choice(&self) -> Choice {
        self.prepared(|robot| robot.scene.choice.clone())
    }

    fn leads(&self) -> bool {
        self.number == 0
    }

    pub(crate) fn is_alone(&self) -> bool {
        self.robots.lock().all.len() == 1
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
        self.sim(|sim| Some(sim.mega()?.firmware().board()))
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
        self.sim(Sim::be_ghost);
    }

    /// Lifts the robot so that its wheels turn freely, or puts it down.
    pub fn lift(&mut self, wheels_in_air: bool) {
        self.sim(|sim| sim.lift(wheels_in_air));
    }

    /// Its parameters, as drawn for the seed.
    #[must_use]
    pub fn params(&self) -> rumbo_plant::params::Params {
        self.sim(|sim| *sim.params())
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
        self.sim(|sim| sim.place(at, estimate));
    }
}

impl SimulatedRobot {
    /// Its scenario commands it.
    fn plays(&self) -> bool {
        self.experiment.as_ref().is_some_and(Experiment::goes_on)
    }

    /// All of them start again from time 0, as switched off and on again: saved parameters persist.
    pub(crate) fn start_again(&mut self, choice: &Choice) -> Result<(), FileError> {
        let mut robots = self.robots.lock();
        let memories: Vec<_> = robots.all.iter().map(|robot| robot.sim.memory()).collect();
        let (library, held) = (&self.library, self.held.as_ref());
        let count = memories.len();
        let fresh = Robots::begin(library, &self.overrides, held, choice, &memories, count)?;
        robots.renew(fresh);
        self.start = robots.start;
        drop(robots);
        self.forget();
        Ok(())
    }

    /// Nothing is left of what was before its start.
    pub(crate) fn forget(&mut self) {
        self.in_hand = None;
        if let Some(debugging) = &mut self.debugging {
            debugging.forget();
        }
        self.begin_profile();
        (self.reading_due_us, self.ended) = (0, false);
        self.experiment = None;
    }
}
