//! Mode 2: stop square to a wall at a distance from it (memoria 2.2).

use super::{Action, Mode, Situation};
use crate::types::Fault;

/// Names of the states.
#[cfg(feature = "names")]
pub const STATE_NAMES: [&str; 1] = ["approach"];

/// Configuration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrontAlign;

/// Memory.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    started: bool,
}

impl Mode for FrontAlign {
    type State = State;

    fn step(&self, state: &mut State, _: &Situation) -> Result<Action, Fault> {
        state.started = true;
        Ok(Action::default())
    }
}
