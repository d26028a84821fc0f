//! Many robots stepped together, by a caller that looks at them and commands them on the way.
//!
//! A [`Robot`] is a run that the caller steps: by its scenario's commands it is bit for bit that of [`crate::run::run`],
//! without its records. Taken by the caller it has no link: commands reach the control core at once. A [`Batch`] steps
//! its robots on the threads of the current rayon pool, a single one on the caller's; robots share nothing, so the number
//! of threads does not matter.
//!
//! A [`Team`] is the robots of a scenario with several, in one world: they go on together.

mod history;
mod pilot;
mod probe;
mod robot;
mod team;

pub use pilot::{Driver, TRUE};
pub use probe::{Probe, Pulse};
pub use robot::Robot;
pub use rumbo_control::policy::OBSERVED;
pub use team::Team;

use crate::files::{FileError, Setup};
#[cfg(feature = "host")]
use rayon::prelude::*;
use rumbo_plant::world::World;
use std::sync::{Arc, OnceLock};

/// What defines a robot of a setup: its seed, and its [`Robot::history`].
pub type Life = (u64, Vec<u8>);

/// Called after each robot that is made; its error ends the making of others.
pub type Made<'a> = &'a (dyn Fn() -> Result<(), FileError> + Sync);

/// Robots of one setup, each with its seed. A clone is a snapshot.
#[derive(Clone)]
pub struct Batch {
    setup: Arc<Setup>,
    driver: Driver,
    /// The world of all robots that are in the same.
    world: OnceLock<Arc<World>>,
    robots: Vec<Robot>,
}

impl Batch {
    /// A robot for each seed, at its start.
    ///
    /// # Errors
    /// The setup's values do not fit together, or its calibration failed.
    pub fn new(setup: Setup, driver: Driver, seeds: &[u64]) -> Result<Self, FileError> {
        let lives: Vec<Life> = seeds.iter().map(|seed| (*seed, Vec::new())).collect();
        Self::of_lives(setup, driver, &lives, &|| Ok(()))
    }

    /// The robots of these lives. `made` is called after each one is made; its error ends it all.
    ///
    /// # Errors
    /// As [`Batch::new`], that of `made`, or a history that is none.
    pub fn of_lives(
        setup: Setup,
        driver: Driver,
        lives: &[Life],
        made: Made<'_>,
    ) -> Result<Self, FileError> {
        let setup = Arc::new(setup);
        let world = OnceLock::new();
        let robots = make_all(lives.iter().collect(), |(seed, history)| {
            let mut robot = make(&setup, driver, *seed, &world)?;
            robot.relive(history)?;
            made().map(|()| robot)
        })?;
        Ok(Self {
            setup,
            driver,
            world,
            robots,
        })
    }

    /// The robots, in the order of their seeds.
    pub fn robots(&self) -> &[Robot] {
        &self.robots
    }

    /// The robots, to be commanded one by one.
    pub fn robots_mut(&mut self) -> &mut [Robot] {
        &mut self.robots
    }

    /// Their lives, from which [`Batch::of_lives`] makes them again.
    pub fn lives(&self) -> Vec<Life> {
        let robots = self.robots.iter();
        robots
            .map(|robot| (robot.seed(), robot.history()))
            .collect()
    }

    /// Puts new robots of these seeds in place of those of these numbers; a number beyond the last robot is passed over.
    /// `made` is called after each one is made; its error ends it all.
    ///
    /// # Errors
    /// As [`Batch::new`], and that of `made`; some of the robots are new then, and others still the old ones.
    pub fn renew(&mut self, renewed: &[(usize, u64)], made: Made<'_>) -> Result<(), FileError> {
        let mut seeds = vec![None; self.robots.len()];
        for (index, seed) in renewed {
            if let Some(slot) = seeds.get_mut(*index) {
                *slot = Some(*seed);
            }
        }
        let slots = self.robots.iter_mut().zip(seeds);
        let work: Vec<_> = slots
            .filter_map(|(slot, seed)| Some((slot, seed?)))
            .collect();
        // Each old one goes as soon as its new one is there: never are all of them there twice.
        let renewed = make_all(work, |(slot, seed)| {
            *slot = make(&self.setup, self.driver, seed, &self.world)?;
            made()
        });
        renewed.map(drop)
    }

    /// Advances every robot by this many control ticks of 10 ms.
    pub fn advance(&mut self, ticks: u32) {
        for_all(&mut self.robots, |robot| robot.advance(ticks));
    }

    /// Has each robot, by its number, do something.
    pub fn for_each(&mut self, act: impl Fn(usize, &mut Robot) + Sync) {
        let mut work: Vec<_> = self.robots.iter_mut().enumerate().collect();
        for_all(&mut work, |(index, robot)| act(*index, robot));
    }

    /// Has each robot, by its number, do something, and advances those that say so by this many ticks; then writes a row
    /// for each robot into `known` and `truth`, in the order of [`OBSERVED`] and [`TRUE`].
    pub fn step(
        &mut self,
        known: &mut [f32],
        truth: &mut [f64],
        ticks: u32,
        act: impl Fn(usize, &mut Robot) -> bool + Sync,
    ) {
        let rows = known
            .chunks_exact_mut(OBSERVED.len())
            .zip(truth.chunks_exact_mut(TRUE.len()));
        let mut work: Vec<_> = self.robots.iter_mut().zip(rows).enumerate().collect();
        for_all(&mut work, |(index, (robot, (known, truth)))| {
            if act(*index, robot) {
                robot.advance(ticks);
            }
            known.copy_from_slice(&robot.observed());
            truth.copy_from_slice(&robot.true_values());
        });
    }
}

fn make(
    setup: &Arc<Setup>,
    driver: Driver,
    seed: u64,
    world: &OnceLock<Arc<World>>,
) -> Result<Robot, FileError> {
    let mut robot = Robot::new(setup, driver, seed)?;
    robot.share_world(world);
    Ok(robot)
}

/// A single one needs no pool, whose threads a fork of this process would lose.
#[cfg(feature = "host")]
fn for_all<T: Send>(work: &mut [T], act: impl Fn(&mut T) + Sync) {
    match work {
        [only] => act(only),
        _ => work.par_iter_mut().for_each(&act),
    }
}

#[cfg(not(feature = "host"))]
fn for_all<T>(work: &mut [T], act: impl Fn(&mut T)) {
    work.iter_mut().for_each(act);
}

#[cfg(feature = "host")]
fn make_all<T: Send, R: Send>(
    of: Vec<T>,
    make: impl Fn(T) -> Result<R, FileError> + Sync,
) -> Result<Vec<R>, FileError> {
    match <[T; 1]>::try_from(of) {
        Ok([only]) => Ok(vec![make(only)?]),
        Err(of) => of.into_par_iter().map(&make).collect(),
    }
}

#[cfg(not(feature = "host"))]
fn make_all<T, R>(
    of: Vec<T>,
    make: impl Fn(T) -> Result<R, FileError>,
) -> Result<Vec<R>, FileError> {
    of.into_iter().map(make).collect()
}
