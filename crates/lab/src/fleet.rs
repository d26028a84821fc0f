//! Several simulated robots in one world, each behind the interface of a session's target.
//!
//! They share the simulation. The first one's session has the time, and starts all of them again; the others go with it.

use crate::hand::HAND;
use crate::prepare::{Prepared, chosen, prepare};
use crate::robot::type_to;
use crate::sight;
use rumbo_experiment::files::{FileError, Kind, Library, Overrides, fleet_around};
use rumbo_log::{Choice, Manifest, Other, Scene, Source, Truth};
use rumbo_session::{Abilities, GivenProgram, LinkNews, Shown, Target, TargetError};
use rumbo_sim::Sim;
use rumbo_sim::fleet::Fleet;
use rumbo_wire::Command;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// One of several robots.
pub struct FleetRobot {
    world: Arc<Mutex<World>>,
    number: usize,
    /// The start that it has seen.
    start: u32,
    /// When the instruments are read next \[us\].
    reading_due_us: u64,
    /// Its program's end has been reported.
    ended: bool,
}

/// All of them.
struct World {
    library: Library,
    overrides: Overrides,
    fleet: Fleet,
    robots: Vec<About>,
    /// Counts the starts.
    start: u32,
}

/// A robot, with what is constant of it between two starts.
struct About {
    sim: Sim,
    name: String,
    mode: rumbo_control::mode::ModeId,
    scene: Scene,
    first_commands: Vec<Command>,
    manifest: Manifest,
}

/// The robots of a scenario with several, at their start, in order; or as many copies of the robot of another one as
/// asked for.
///
/// # Errors
/// The problems of the files that overrides and choice name; copies of robots that are several already.
pub fn fleet(
    library: Library,
    overrides: Overrides,
    choice: &Choice,
    robots: usize,
) -> Result<Vec<FleetRobot>, FileError> {
    let library = with_copies(library, &overrides, choice, robots)?;
    let (fleet, robots) = begin(&library, &overrides, choice, &[])?;
    let count = robots.len();
    let world = Arc::new(Mutex::new(World {
        library,
        overrides,
        fleet,
        robots,
        start: 0,
    }));
    let robot = |number| FleetRobot {
        world: Arc::clone(&world),
        number,
        start: 0,
        reading_due_us: 0,
        ended: false,
    };
    Ok((0..count).map(robot).collect())
}

/// The library with the scenario of the choice as one of so many robots, unless it has robots of its own.
fn with_copies(
    library: Library,
    overrides: &Overrides,
    choice: &Choice,
    robots: usize,
) -> Result<Library, FileError> {
    let scenario = library.scenario(&choice.scenario)?;
    match scenario.fleet.len() {
        0 => {
            let setup = library.setup(&choice.scenario, &chosen(overrides, choice))?;
            let text = scenario.text + &fleet_around(&setup, robots)?;
            Ok(library.holding(Kind::Scenario, &choice.scenario, &text))
        }
        _ if robots > 1 => Err(FileError::Setting(format!(
            "{robots} robots: scenario {} has robots of its own; leave their number out",
            scenario.name
        ))),
        _ => Ok(library),
    }
}

fn begin(
    library: &Library,
    overrides: &Overrides,
    choice: &Choice,
    memories: &[Vec<u8>],
) -> Result<(Fleet, Vec<About>), FileError> {
    let mut robots = Vec::new();
    for prepared in prepare(library, overrides, None, choice, memories)? {
        let Prepared {
            sim,
            mode,
            mut scene,
            first_commands,
            manifest,
        } = prepared;
        // Another scenario may have another number of robots.
        scene
            .experiments
            .retain(|experiment| experiment.name == choice.scenario);
        robots.push(About {
            sim,
            name: manifest.member.clone().unwrap_or_default(),
            mode,
            scene,
            first_commands,
            manifest,
        });
    }
    let fleet = Fleet::new(
        &mut robots
            .iter_mut()
            .map(|about| &mut about.sim)
            .collect::<Vec<_>>(),
    )
    .map_err(|error| FileError::Setting(format!("scenario {}: {error}", choice.scenario)))?;
    Ok((fleet, robots))
}

impl FleetRobot {
    /// What the scenario calls it.
    #[must_use]
    pub fn name(&self) -> String {
        self.of_it(|about| about.name.clone())
    }

    /// The world, also after a thread has panicked: that is reported when its session ends.
    fn shared(&self) -> MutexGuard<'_, World> {
        self.world.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn of_it<T>(&self, what: impl FnOnce(&About) -> T) -> T {
        what(&self.shared().robots[self.number])
    }

    fn sim<T>(&self, what: impl FnOnce(&mut Sim) -> T) -> T {
        what(&mut self.shared().robots[self.number].sim)
    }

    fn leads(&self) -> bool {
        self.number == 0
    }
}

impl World {
    /// Where the others of a robot are.
    fn others(&self, number: usize) -> Shown {
        let others = self.robots.iter().enumerate();
        let others = others.filter(|(other, _)| *other != number);
        let signals = others
            .flat_map(|(_, about)| Other::signals(&about.name, sight::truth(&about.sim).pose));
        (Source::Others, signals.collect())
    }

    /// All start again from time 0, as switched off and on again.
    fn start_again(&mut self, choice: &Choice) -> Result<(), FileError> {
        let memories: Vec<_> = self.robots.iter().map(|about| about.sim.memory()).collect();
        (self.fleet, self.robots) = begin(&self.library, &self.overrides, choice, &memories)?;
        self.start += 1;
        Ok(())
    }
}

impl Target for FleetRobot {
    fn now_us(&self) -> u64 {
        self.sim(|sim| sim.now_us())
    }

    fn advance(&mut self, dt_us: u64) -> Result<(), TargetError> {
        if self.leads() {
            let until_us = self.now_us() + dt_us;
            let mut shared = self.shared();
            let World { fleet, robots, .. } = &mut *shared;
            let mut sims: Vec<_> = robots.iter_mut().map(|about| &mut about.sim).collect();
            fleet.advance(&mut sims, until_us);
        }
        Ok(())
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), TargetError> {
        self.sim(|sim| sim.send(bytes));
        Ok(())
    }

    fn receive(&mut self, into: &mut Vec<u8>) {
        self.sim(|sim| sim.receive(into));
    }

    fn baud(&self) -> u32 {
        self.sim(|sim| sim.baud())
    }

    fn abilities(&self) -> Abilities {
        let mode = self.of_it(|about| about.mode);
        let leads = self.leads();
        Abilities {
            pace: leads,
            reset: leads,
            play: false,
            ..self.sim(|sim| sight::abilities(sim, mode))
        }
    }

    fn manifest(&self) -> Manifest {
        self.of_it(|about| about.manifest.clone())
    }

    fn news(&mut self) -> Option<LinkNews> {
        let start = self.shared().start;
        if std::mem::replace(&mut self.start, start) != start {
            (self.reading_due_us, self.ended) = (0, false);
            // Who has the time knows of it.
            return (!self.leads()).then_some(LinkNews::Renewed);
        }
        let verdict = self.sim(|sim| sim.verdict()).filter(|_| !self.ended);
        self.ended |= verdict.is_some();
        verdict.map(LinkNews::Ended)
    }

    fn truth(&self) -> Option<Truth> {
        Some(self.sim(|sim| sight::truth(sim)))
    }

    fn shown(&mut self) -> Vec<Shown> {
        let mut due_us = self.reading_due_us;
        let due = self.sim(|sim| sight::reading_due(sim, &mut due_us));
        self.reading_due_us = due_us;
        if !due {
            return Vec::new();
        }
        let others = self.shared().others(self.number);
        let own = self.sim(sight::shown);
        own.into_iter().chain([others]).collect()
    }

    fn scene(&self) -> Option<Scene> {
        Some(self.of_it(|about| about.scene.clone()))
    }

    fn first_commands(&self) -> Vec<Command> {
        self.of_it(|about| about.first_commands.clone())
    }

    fn consoles(&mut self) -> Vec<(u8, Vec<u8>)> {
        self.sim(sight::consoles)
    }

    fn type_in(&mut self, usart: u8, text: &str) -> Result<(), TargetError> {
        // The other robots would not see what was moved, nor would their logs.
        if usart == HAND && !text.starts_with("robot=") {
            return Ok(());
        }
        match self.sim(|sim| type_to(sim, usart, text.as_bytes())) {
            true => Ok(()),
            false => Err(TargetError::NoChip),
        }
    }

    fn supply_motors(&mut self, on: bool) {
        self.sim(|sim| sim.supply_motors(on));
    }

    fn run_program(&mut self, _program: GivenProgram) -> Result<(), TargetError> {
        Err(TargetError::Several)
    }

    fn reset(&mut self, choice: &Choice) -> Result<(), TargetError> {
        // The page chooses among names it was given; it opens no files.
        let scene = self.scene().unwrap_or_default();
        let known = scene.choice.scenario == choice.scenario
            && (scene.choice.world == choice.world
                || choice
                    .world
                    .iter()
                    .all(|world| scene.worlds.contains(world)));
        if !self.leads() || !known {
            return Err(TargetError::NotOffered);
        }
        let done = self.shared().start_again(choice);
        done.map_err(|error| TargetError::Setup(error.to_string()))?;
        let start = self.shared().start;
        self.start = start;
        (self.reading_due_us, self.ended) = (0, false);
        Ok(())
    }
}
