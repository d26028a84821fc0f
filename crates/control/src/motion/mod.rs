//! Movements that several modes are made of: a turn on the spot ([`turn`]) and a straight line to a point ([`line`]).
//!
//! Each is configuration (from the parameters) apart from state, and one `step` per tick that gives what the wheels are to do and
//! whether it is done. The default of a state is the start of a movement. Derivation: docs/theory/waypoints.md.

pub mod line;
pub mod turn;

pub use line::{Line, LineState, LineStep, Segment};
pub use turn::{Turn, TurnState, TurnStep};

/// Way that a wheel still rolls between the release that is asked for and the bridge letting go: the latch of the inputs, 3 ms to the
/// outputs, and half a pole of the encoder at creeping speed [s].
const RELEASE_DELAY_S: f32 = 0.015;
