//! Many robots stepped together, by a caller that looks at them and commands them on the way.
//!
//! A [`Robot`] is a run that the caller steps: by its scenario's commands it is bit for bit that of [`crate::run::run`],
//! without its records. Taken by the caller it has no link: commands reach the control core at once. A [`Batch`] steps
//! its robots on the threads of the current rayon pool, a single one on the caller's; robots share nothing, so the number
//! of threads does not matter.
//!
//! A [`Team`] is the robots of a scenario with several, in one world: they go on together.

mod pilot;
mod robot;
mod team;

pub use pilot::{Driver, TRUE};
pub use robot::Robot;
pub use rumbo_control::policy::OBSERVED;
pub use team::Team;

use crate::files::{FileError, Setup};
#[cfg(feature = "host")]
use rayon::prelude::*;
use rumbo_plant::world::World;
use std::sync::{Arc, OnceLock};

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
        let setup = Arc::new(setup);
        let world = OnceLock::new();
        let robots = make_all(seeds, |seed| make(&setup, driver, *seed, &world))?;
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

    /// Puts new robots of these seeds in place of those of these numbers; a number beyond the last robot is passed over.
    ///
    /// # Errors
    /// As [`Batch::new`]; all robots stay as they are then.
    pub fn renew(&mut self, renewed: &[(usize, u64)]) -> Result<(), FileError> {
        let robots = make_all(renewed, |(_, seed)| {
            make(&self.setup, self.driver, *seed, &self.world)
        })?;
        for ((index, _), robot) in renewed.iter().zip(robots) {
            if let Some(slot) = self.robots.get_mut(*index) {
                *slot = robot;
            }
        }
        Ok(())
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
fn make_all<T: Sync>(
    of: &[T],
    make: impl Fn(&T) -> Result<Robot, FileError> + Sync,
) -> Result<Vec<Robot>, FileError> {
    match of {
        [only] => Ok(vec![make(only)?]),
        _ => of.par_iter().map(&make).collect(),
    }
}

#[cfg(not(feature = "host"))]
fn make_all<T>(
    of: &[T],
    make: impl Fn(&T) -> Result<Robot, FileError>,
) -> Result<Vec<Robot>, FileError> {
    of.iter().map(make).collect()
}
