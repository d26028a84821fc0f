//! Several robots in one world, in lockstep.
//!
//! Each robot is a [`Sim`] with its own program, and a body in the worlds of all others. The robots are advanced by at most
//! a millisecond. At the beginning of each step every robot gets the poses and velocities that the others have then; what
//! they do within the step it meets in the next one. So the order in which they are advanced makes no difference. A fleet
//! of one is bit for bit the single run.

mod approach;

use crate::sim::Sim;
use approach::Approaches;
use rumbo_plant::moving::{Body, Course};
use rumbo_plant::sonar::{Ping, SonarId};
use rumbo_plant::world::{Obstacle, ShapeError};
use std::borrow::BorrowMut;
use thiserror::Error;

/// Longest step, and the grid it keeps to [us].
const STEP_US: u64 = 1_000;

/// What robots in one world are to each other; at least one. They themselves are the caller's, in the same order at each
/// call.
#[derive(Clone, Debug)]
pub struct Fleet {
    /// Each as the others meet it.
    bodies: Vec<Body>,
    /// Those that do not go on as they did, and how far at most each has jumped [m]; kept for its memory.
    changed: Vec<(usize, f64)>,
    /// Bodies of the world that are no robots.
    movers: usize,
    /// Pings so far of each sonar of each robot.
    pings: Vec<[u64; SonarId::ALL.len()]>,
    approaches: Approaches,
}

/// Why robots cannot be in one world.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum FleetError {
    /// These two would stand inside each other.
    #[error("robots {one} and {other} stand inside each other; move one of them", one = .0 + 1, other = .1 + 1)]
    Inside(usize, usize),
    /// There are none.
    #[error("there is no robot")]
    Empty,
    /// There are more than a world has room for.
    #[error("there are more robots and movers than the 63 that fit; leave some out")]
    TooMany,
    /// Their clocks show different times.
    #[error("the robots' clocks show different times")]
    Clocks,
}

/// What a robot met.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Met {
    /// A wall or a box, by its index in the world.
    Obstacle(usize),
    /// A mover, by its index in the world.
    Mover(usize),
    /// Another robot, by its index in the fleet.
    Robot(usize),
}

/// A contact of a robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Encounter {
    /// Its end of the step in which it began [us].
    pub at_us: u64,
    /// With what.
    pub met: Met,
    /// Closing speed of the points that met [m/s].
    pub speed_m_s: f64,
}

impl Fleet {
    /// Robots that stand in the same world at the same time.
    ///
    /// # Errors
    /// Two of them inside each other, clocks that differ, none, or too many.
    pub fn new<S: BorrowMut<Sim>>(robots: &mut [S]) -> Result<Self, FleetError> {
        let mut robots: Vec<&mut Sim> = robots.iter_mut().map(BorrowMut::borrow_mut).collect();
        let Some(now_us) = robots.first().map(|first| first.now_us()) else {
            return Err(FleetError::Empty);
        };
        if robots.iter().any(|robot| robot.now_us() != now_us) {
            return Err(FleetError::Clocks);
        }
        let bodies = robots.iter().map(|robot| robot.body());
        let bodies = bodies.collect::<Result<Vec<_>, _>>();
        let bodies = bodies.map_err(|_: ShapeError| FleetError::TooMany)?;
        let outlines: Vec<Obstacle> = std::iter::zip(&*robots, &bodies)
            .map(|(robot, body)| body.outline(&robot.motion().pose))
            .collect();
        for (second, outline) in outlines.iter().enumerate() {
            let within = |first: &Obstacle| first.overlaps(outline);
            if let Some(first) = outlines[..second].iter().position(within) {
                return Err(FleetError::Inside(first, second));
            }
        }
        let movers = robots
            .first()
            .map_or(0, |robot| robot.world().bodies().len());
        for (own, robot) in robots.iter_mut().enumerate() {
            for (_, body) in bodies.iter().enumerate().filter(|(other, _)| *other != own) {
                robot.join(body.clone()).map_err(|_| FleetError::TooMany)?;
            }
        }
        Ok(Self {
            approaches: Approaches::new(&bodies, robots.iter().map(|robot| robot.pose())),
            pings: vec![[0; SonarId::ALL.len()]; robots.len()],
            changed: Vec::with_capacity(robots.len()),
            bodies,
            movers,
        })
    }

    /// Advances all robots to this time [us].
    pub fn advance<S: BorrowMut<Sim>>(&mut self, robots: &mut [S], until_us: u64) {
        if let [only] = robots {
            return only.borrow_mut().advance(until_us);
        }
        let mut robots: Vec<&mut Sim> = robots.iter_mut().map(BorrowMut::borrow_mut).collect();
        while let Some(now_us) = robots.first().map(|first| first.now_us())
            && now_us < until_us
        {
            let end_us = ((now_us / STEP_US + 1) * STEP_US).min(until_us);
            self.meet(&mut robots, now_us);
            for robot in robots.iter_mut() {
                robot.advance(end_us);
            }
            let poses = robots.iter().map(|robot| robot.pose());
            self.approaches.measure(&self.bodies, poses);
            if robots.iter().any(|robot| robot.now_us() < end_us) {
                // At a breakpoint.
                return;
            }
        }
    }

    /// Each robot gets the poses and velocities of the others, and their pings of the last step. No sonar is so near to
    /// another robot's that a burst, 450 us after its trigger, would have arrived before.
    fn meet(&mut self, robots: &mut [&mut Sim], now_us: u64) {
        let mut pings = Vec::new();
        let counted = std::iter::zip(&*robots, &mut self.pings).enumerate();
        counted.for_each(|(index, (robot, counts))| robot.pings_since(index, counts, &mut pings));
        self.changed.clear();
        for (index, (robot, body)) in std::iter::zip(&*robots, &mut self.bodies).enumerate() {
            let from = robot.motion();
            if !body.stands_as(&from) {
                let at_us = now_us;
                let jump_m = body.turn_to(now_us, Course::Straight { at_us, from });
                self.changed.push((index, jump_m));
            }
        }
        for (own, robot) in robots.iter_mut().enumerate() {
            let others = self.changed.iter().filter(|(other, _)| *other != own);
            robot.meet(others.map(|&(other, jump_m)| {
                let number = self.movers + other - usize::from(other > own);
                (number, &self.bodies[other], jump_m)
            }));
            let others = pings.iter().filter(|(other, _)| *other != own);
            let heard: Vec<Ping> = others.map(|(_, ping)| *ping).collect();
            robot.receive_pings(&heard);
        }
    }

    /// The least distance that two robots have had [m]; infinite for one that is none.
    pub fn closest_m(&self, one: usize, other: usize) -> f64 {
        self.approaches.closest_m(one, other)
    }

    /// The contacts of the robot of this number so far, in order.
    pub fn encounters(&self, robot: usize, sim: &Sim) -> Vec<Encounter> {
        let standing = sim.world().obstacles().len();
        let met = |index: usize| match index.checked_sub(standing) {
            None => Met::Obstacle(index),
            Some(body) => match body.checked_sub(self.movers) {
                None => Met::Mover(body),
                Some(other) => Met::Robot(other + usize::from(other >= robot)),
            },
        };
        let touches = sim.touches().iter();
        touches
            .map(|touch| Encounter {
                at_us: touch.at_us,
                met: met(touch.obstacle),
                speed_m_s: touch.speed_m_s,
            })
            .collect()
    }
}
