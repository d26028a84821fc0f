//! Mode 8: a goal around obstacles, or a lane of boxes (memoria 5).

use super::{Action, Mode, Situation};
use crate::types::Fault;

/// Names of the states.
#[cfg(feature = "names")]
pub const STATE_NAMES: [&str; 1] = ["wait for goal"];

/// What the mission is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Task {
    /// Wait for a goal.
    #[default]
    Wait,
    /// Reach a point, around what stands in the way.
    Goal {
        /// Forward of the origin [m].
        x_m: f32,
        /// Left of the origin [m].
        y_m: f32,
    },
    /// Follow a lane of boxes.
    Lane,
}

/// Configuration of mode 8.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mission;

/// Memory of mode 8.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    started: bool,
}

impl Mode for Mission {
    type State = State;

    fn step(&self, state: &mut State, _: &Situation) -> Result<Action, Fault> {
        state.started = true;
        Ok(Action::default())
    }
}
