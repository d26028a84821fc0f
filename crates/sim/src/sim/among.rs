//! A robot among others: its body in their worlds, theirs in its own, and their pings.

use super::Sim;
use rumbo_plant::contact::Pose;
use rumbo_plant::moving::{Body, BodyMotion, Course};
use rumbo_plant::sonar::{Ping, SonarId};
use rumbo_plant::world::{ShapeError, World};
use std::sync::{Arc, OnceLock};

impl Sim {
    /// Where the body is.
    pub(crate) fn pose(&self) -> Pose {
        self.state.pose()
    }

    /// Where the body is, and how fast it moves.
    pub(crate) fn motion(&self) -> BodyMotion {
        self.plant.motion(&self.state)
    }

    /// The body as another robot meets it, where it stands now.
    pub(crate) fn body(&self) -> Result<Body, ShapeError> {
        let corners = self.plant.footprint().corners(&Pose::default());
        let at_us = self.now_us();
        let from = self.motion();
        Body::new(corners.to_vec(), Course::Straight { at_us, from })
    }

    /// Other robots are in its world.
    pub(crate) fn is_among_others(&self) -> bool {
        self.among_others
    }

    /// Puts a body into the world.
    pub(crate) fn join(&mut self, body: Body) -> Result<(), ShapeError> {
        self.among_others = true;
        self.plant.add_body(&mut self.state, body)
    }

    /// Adds the pings since there had been so many of each sonar, which is brought up to date, with `robot`, its number
    /// among all.
    pub(crate) fn pings_since(
        &self,
        robot: usize,
        counts: &mut [u64; SonarId::ALL.len()],
        pings: &mut Vec<(usize, Ping)>,
    ) {
        for sonar in SonarId::ALL {
            let state = self.plant.sonar(&self.state, sonar);
            let count = &mut counts[sonar.index()];
            if *count != state.pings() {
                *count = state.pings();
                let speaker = match sonar {
                    SonarId::Other(number) => {
                        u32::MAX - (SonarId::OTHERS * robot) as u32 - u32::from(number)
                    }
                    _ => (3 * robot + sonar.index()) as u32,
                };
                pings.push((robot, state.last_ping(speaker)));
            }
        }
    }

    /// Lets the sonars receive pings of other robots.
    pub(crate) fn receive_pings(&mut self, pings: &[Ping]) {
        self.plant.receive_pings(&mut self.state, pings);
    }

    /// Has bodies of the world, by their numbers, go as these from now on; each has jumped by at most so much [m].
    pub(crate) fn meet<'a>(&mut self, bodies: impl Iterator<Item = (usize, &'a Body, f64)>) {
        self.plant.replace_bodies(&mut self.state, bodies);
    }

    /// Keeps its world in common with others if it is the same as theirs: the first one's.
    pub fn share_world(&mut self, common: &OnceLock<Arc<World>>) {
        self.plant.share_world(common);
    }
}
