//! Mode 6: straight on by regulating the difference of distance travelled (memoria 4.2).

use super::{Action, Mode, Situation};
use crate::types::Fault;

/// Names of the states.
#[cfg(feature = "names")]
pub const STATE_NAMES: [&str; 1] = ["at rest"];

/// Configuration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StraightLine;

/// Memory.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    started: bool,
}

impl Mode for StraightLine {
    type State = State;

    fn step(&self, state: &mut State, _: &Situation) -> Result<Action, Fault> {
        state.started = true;
        Ok(Action::default())
    }
}
