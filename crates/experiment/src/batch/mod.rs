//! Many robots stepped together, by a caller that looks at them and commands them on the way.
//!
//! A [`Robot`] is a run that the caller steps: by its scenario's commands it is bit for bit that of [`crate::run::run`],
//! without its records. Taken by the caller it has no link: commands reach the control core at once. A [`Group`] is the
//! robots of a seed: one, or those of a scenario with several, in one world. A [`Batch`] steps its groups on the threads
//! of the current rayon pool, a single one on the caller's; groups share nothing, so the number of threads does not
//! matter.

mod group;
mod history;
mod pilot;
mod probe;
mod robot;

pub use group::Group;
pub use pilot::{DrivenBy, TRUE};
pub use probe::{Probe, Pulse};
pub use robot::Robot;
pub use rumbo_control::policy::OBSERVED;

use crate::files::{FileError, Setup};
#[cfg(feature = "host")]
use rayon::prelude::*;
use rumbo_plant::world::World;
use std::sync::{Arc, OnceLock};

/// What defines the robots of a setup in one world: their seed, and what was done to each ([`Robot::history`]).
pub type Life = (u64, Vec<Vec<u8>>);

/// Called after each robot that is made; its error ends the making of others.
pub type Made<'a> = &'a (dyn Fn() -> Result<(), FileError> + Sync);

/// Robots of one setup, a group for each seed. A clone is a snapshot.
#[derive(Clone)]
pub struct Batch {
    /// Of each robot of a group, and who commands it.
    setups: Vec<Arc<Setup>>,
    drivers: Vec<DrivenBy>,
    /// The world of all robots that are in the same.
    world: OnceLock<Arc<World>>,
    groups: Vec<Group>,
}

impl Batch {
    /// The robots of each seed, at their start.
    ///
    /// # Errors
    /// The setup's values do not fit together, a calibration failed, or a program takes no commands of a caller.
    pub fn new(setup: &Setup, driver: DrivenBy, seeds: &[u64]) -> Result<Self, FileError> {
        let lives: Vec<Life> = seeds.iter().map(|seed| (*seed, Vec::new())).collect();
        let drivers = vec![driver; setup.robots().len()];
        Self::of_lives(setup, drivers, &lives, &|| Ok(()))
    }

    /// The robots of these lives; `drivers` has who commands each robot of a group. `made` is called after each robot is
    /// made; its error ends it all.
    ///
    /// # Errors
    /// As [`Batch::new`], that of `made`, or a history that is none.
    pub fn of_lives(
        setup: &Setup,
        drivers: Vec<DrivenBy>,
        lives: &[Life],
        made: Made<'_>,
    ) -> Result<Self, FileError> {
        let setups = setup.robots().iter().cloned().map(Arc::new).collect();
        let mut batch = Self {
            setups,
            drivers,
            world: OnceLock::new(),
            groups: Vec::new(),
        };
        batch.groups = make_all(lives.iter().collect(), |(seed, histories)| {
            let mut group = batch.make(*seed, made)?;
            group.relive(histories)?;
            Ok(group)
        })?;
        Ok(batch)
    }

    fn make(&self, seed: u64, made: Made<'_>) -> Result<Group, FileError> {
        let mut group = Group::new(&self.setups, &self.drivers, seed, made)?;
        if let [only] = group.robots_mut() {
            only.share_world(&self.world);
        }
        Ok(group)
    }

    /// The robots, in the order of their seeds.
    pub fn robots(&self) -> impl Iterator<Item = &Robot> {
        self.groups.iter().flat_map(Group::robots)
    }

    /// A robot, to be commanded.
    pub fn robot_mut(&mut self, index: usize) -> Option<&mut Robot> {
        let mut robots = self.groups.iter_mut().flat_map(Group::robots_mut);
        robots.nth(index)
    }

    /// The lives of all groups, from which [`Batch::of_lives`] makes them again.
    pub fn lives(&self) -> Vec<Life> {
        self.groups.iter().map(Group::life).collect()
    }

    /// Puts new groups of these seeds in place of those of these numbers; a number beyond the last is passed over. `made` is
    /// called after each robot is made; its error ends it all.
    ///
    /// # Errors
    /// As [`Batch::new`], and that of `made`; some of the groups are new then, and others still the old ones.
    pub fn renew(&mut self, renewed: &[(usize, u64)], made: Made<'_>) -> Result<(), FileError> {
        let mut groups = std::mem::take(&mut self.groups);
        let mut seeds = vec![None; groups.len()];
        for (index, seed) in renewed {
            if let Some(slot) = seeds.get_mut(*index) {
                *slot = Some(*seed);
            }
        }
        let slots = groups.iter_mut().zip(seeds);
        let work: Vec<_> = slots
            .filter_map(|(slot, seed)| Some((slot, seed?)))
            .collect();
        // Each old one goes as soon as its new one is there: never are all of them there twice.
        let renewed = make_all(work, |(slot, seed)| {
            *slot = self.make(seed, made)?;
            Ok(())
        });
        self.groups = groups;
        renewed.map(drop)
    }

    /// Advances every robot by this many control ticks of 10 ms.
    pub fn advance(&mut self, ticks: u32) {
        for_all(&mut self.groups, |group| group.advance(ticks));
    }

    /// Has each group, by the number of its first robot, do something.
    pub fn for_each(&mut self, act: impl Fn(usize, &mut Group) + Sync) {
        let robots = self.setups.len();
        let mut work: Vec<_> = self.groups.iter_mut().enumerate().collect();
        for_all(&mut work, |(index, group)| act(*index * robots, group));
    }

    /// Has each group, by the number of its first robot, do something, and advances those that say so by this many ticks;
    /// then writes a row for each robot into `known` and `truth`, in the order of [`OBSERVED`] and [`TRUE`].
    pub fn step(
        &mut self,
        known: &mut [f32],
        truth: &mut [f64],
        ticks: u32,
        act: impl Fn(usize, &mut [Robot]) -> bool + Sync,
    ) {
        let robots = self.setups.len();
        let known = known.chunks_exact_mut(robots * OBSERVED.len());
        let rows = known.zip(truth.chunks_exact_mut(robots * TRUE.len()));
        let mut work: Vec<_> = self.groups.iter_mut().zip(rows).enumerate().collect();
        for_all(&mut work, |(index, (group, (known, truth)))| {
            if act(*index * robots, group.robots_mut()) {
                group.advance(ticks);
            }
            group.observe(known, truth);
        });
    }
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
