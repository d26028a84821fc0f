//! The simulated robots of one world, which share the simulation: one, or several.
//!
//! The first one's session has the time, and starts all of them again; the others go with it.

use crate::hand::{self, HAND};
use crate::prepare::{Prepared, chosen, prepare};
use crate::program::Held;
use crate::sight;
use rumbo_experiment::files::{FileError, Kind, Library, Overrides, fleet_around};
use rumbo_log::{Choice, Other, ReadingSource, Scene};
use rumbo_session::Shown;
use rumbo_sim::Sim;
use rumbo_sim::fleet::Fleet;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// The library with the scenario of the choice as one of so many robots, if they are several.
pub(crate) fn with_copies(
    library: Library,
    overrides: &Overrides,
    choice: &Choice,
    robots: usize,
) -> Result<Library, FileError> {
    if robots <= 1 {
        return Ok(library);
    }
    let scenario = library.scenario(&choice.scenario)?;
    if !scenario.fleet.is_empty() {
        return Err(FileError::Setting(format!(
            "{robots} robots: scenario {} has robots of its own; leave their number out",
            scenario.name
        )));
    }
    let setup = library.setup(&choice.scenario, &chosen(overrides, choice))?;
    let text = scenario.text + &fleet_around(&setup, robots)?;
    Ok(library.holding(Kind::Scenario, &choice.scenario, &text))
}

/// All of them, at least one.
pub(crate) struct Robots {
    fleet: Fleet,
    pub(crate) all: Vec<Prepared>,
    /// Counts the starts.
    pub(crate) start: u32,
}

impl Robots {
    /// At most this many robots of a choice, at their start.
    pub(crate) fn begin(
        library: &Library,
        overrides: &Overrides,
        image: Option<&Held>,
        choice: &Choice,
        memories: &[Vec<u8>],
        most: usize,
    ) -> Result<Self, FileError> {
        let mut all = prepare(library, overrides, image, choice, memories)?;
        all.truncate(most);
        let several = all.len() > 1;
        for Prepared { scene, .. } in &mut all {
            // Another scenario may have another number of robots.
            scene
                .experiments
                .retain(|experiment| !several || experiment.name == choice.scenario);
            let world = scene.choice.world.iter();
            let own: Vec<_> = world
                .filter(|it| !scene.worlds.contains(it))
                .cloned()
                .collect();
            scene.worlds.extend(own);
        }
        let mut sims: Vec<&mut Sim> = all.iter_mut().map(|robot| &mut robot.sim).collect();
        let fleet = Fleet::new(&mut sims).map_err(|error| {
            FileError::Setting(format!("scenario {}: {error}", choice.scenario))
        })?;
        Ok(Self {
            fleet,
            all,
            start: 0,
        })
    }

    /// Takes these in place of all, at their start.
    pub(crate) fn renew(&mut self, mut fresh: Self) {
        for (fresh, before) in std::iter::zip(&mut fresh.all, &mut self.all) {
            // What the command line and the page added to the lists stays there.
            let before = std::mem::take(&mut before.scene);
            fresh.scene = Scene {
                experiments: before.experiments,
                worlds: before.worlds,
                world_titles: before.world_titles,
                ..std::mem::take(&mut fresh.scene)
            };
        }
        fresh.start = self.start + 1;
        *self = fresh;
    }

    /// Advances all of them to this time \[us\].
    pub(crate) fn advance(&mut self, until_us: u64) {
        let sims = self.all.iter_mut().map(|robot| &mut robot.sim);
        self.fleet.advance(&mut sims.collect::<Vec<_>>(), until_us);
    }

    /// What is seen of what a robot's own instruments do not show: where the others are, and things that were moved.
    pub(crate) fn around(&self, number: usize) -> Option<Shown> {
        if let [only] = &self.all[..] {
            return hand::moved(&only.sim);
        }
        let others = self.all.iter().enumerate();
        let others = others.filter(|(other, _)| *other != number);
        let signals = others
            .flat_map(|(_, robot)| Other::signals(robot.name(), sight::truth(&robot.sim).pose));
        Some((ReadingSource::Others, signals.collect()))
    }

    /// What is typed has an effect that all of them see, and their logs too.
    pub(crate) fn admit(&self, usart: u8, text: &str) -> bool {
        self.all.len() == 1 || usart != HAND || text.starts_with("robot=")
    }
}

/// The robots, for each of their sessions.
#[derive(Clone)]
pub(crate) struct Shared(Arc<Mutex<Robots>>);

impl Shared {
    pub(crate) fn new(robots: Robots) -> Self {
        Self(Arc::new(Mutex::new(robots)))
    }

    /// Also after a thread has panicked: that is reported when its session ends.
    pub(crate) fn lock(&self) -> MutexGuard<'_, Robots> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
