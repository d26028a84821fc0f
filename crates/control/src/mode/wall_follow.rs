//! Mode 4: follow a wall at a commanded distance (memoria 3.2).

use super::{Action, Mode, Situation};
use crate::types::Fault;

/// Names of the states.
#[cfg(feature = "names")]
pub const STATE_NAMES: [&str; 1] = ["follow"];

/// Configuration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallFollow;

/// Memory.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    started: bool,
}

impl Mode for WallFollow {
    type State = State;

    fn step(&self, state: &mut State, _: &Situation) -> Result<Action, Fault> {
        state.started = true;
        Ok(Action::default())
    }
}
