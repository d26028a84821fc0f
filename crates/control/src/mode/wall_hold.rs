//! Mode 3: follow a wall at the distance at which the robot starts (memoria 3.1).

use super::{Action, Mode, Situation};
use crate::types::Fault;

/// Names of the states.
#[cfg(feature = "names")]
pub const STATE_NAMES: [&str; 1] = ["measure"];

/// Configuration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallHold;

/// Memory.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    started: bool,
}

impl Mode for WallHold {
    type State = State;

    fn step(&self, state: &mut State, _: &Situation) -> Result<Action, Fault> {
        state.started = true;
        Ok(Action::default())
    }
}
