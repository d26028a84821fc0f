//! What a hand does with the robot and the things around it; the program does not notice.

use super::{Controller, Sim};
use rumbo_plant::contact::Pose;
use std::collections::BTreeMap;

impl Sim {
    /// Lifts the robot and puts it down elsewhere, if there is room, which it says: the program does not notice.
    pub fn put(&mut self, at: Pose) -> bool {
        let has_room = self.plant.has_room(&self.state, &at);
        if has_room {
            self.state.place(at);
        }
        has_room
    }

    /// Puts something of the world elsewhere, by its distance from where the world has it \[m\], if there is room, which
    /// it says: what has this number among obstacles, then bodies, which take their whole course along.
    pub fn shift(&mut self, thing: usize, to_m: [f64; 2]) -> bool {
        let was_m = self.shifted.get(&thing).copied().unwrap_or_default();
        let by_m = [to_m[0] - was_m[0], to_m[1] - was_m[1]];
        let has_room = self.plant.shift(&mut self.state, thing, by_m);
        if has_room {
            self.shifted.insert(thing, to_m);
        }
        has_room
    }

    /// What stands elsewhere than the world has it, by [`Self::shift`].
    pub fn shifted(&self) -> &BTreeMap<usize, [f64; 2]> {
        &self.shifted
    }

    /// Moves the robot in the world, as a hand would; our native robot's estimated pose is set to `estimate`, relative
    /// to its origin.
    pub fn place(&mut self, at: Pose, estimate: rumbo_control::Pose) {
        self.state.place(at);
        if let Some(Controller::Rumbo(native)) = &mut self.controller {
            native.set_pose(estimate);
        }
    }

    /// Holds a wheel, as a hand would, with so much dry friction [N m]; 0 lets go.
    pub fn hold(&mut self, wheel: rumbo_plant::drivetrain::Side, friction_n_m: f64) {
        self.state.hold(wheel, friction_n_m);
    }

    /// Lifts the robot so that its wheels turn freely, or puts it down where it is.
    pub fn lift(&mut self, wheels_in_air: bool) {
        self.plant.lift(&self.params, wheels_in_air);
    }
}
