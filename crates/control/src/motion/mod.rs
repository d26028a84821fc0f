//! Movements that several modes share: a turn on the spot ([`turn`]) and a straight line to a point ([`line`]); both
//! end in a planned [`stop`].
//!
//! Each is configuration (from the parameters) apart from state, and one `step` per tick that returns the request for
//! the wheels and whether it is done. The default state is the start of a movement. Derivation:
//! docs/theory/waypoints.md.

pub mod line;
pub mod stop;
pub mod turn;

pub use line::{Line, LineState, LineStep, Segment};
pub use stop::{Stop, StopState, Stopping};
pub use turn::{Turn, TurnState, TurnStep};

/// Speed of the wheels' contact points below which they do not turn steadily [m/s].
pub const CREEP_M_S: f32 = 0.03;
