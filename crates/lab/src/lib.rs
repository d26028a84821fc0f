//! The lab: a simulated robot as the target of a session, with its world and its experiments.
//!
//! A [`SimulatedRobot`] needs no files, threads or clocks: `rumbo lab` runs it behind the station, the browser in a
//! worker. What only a computer has is plugged in: a compiler for sketches ([`Sketches`]), debuggers
//! ([`Holder`]), a port for other programs ([`Cable`]).

mod calibration;
mod fleet;
mod hand;
mod hash;
mod in_hand;
mod live;
pub mod manifest;
mod play;
mod prepare;
mod program;
mod robot;
pub mod run_log;
mod scene;
mod sight;
mod world;

pub use calibration::calibration;
pub use fleet::{FleetRobot, fleet};
pub use hand::HAND;
pub use hash::{recorded_hash, run_hash};
pub use in_hand::{Attach, Holder};
pub use live::Live;
pub use program::{Made, Make, OwnProgram, Sketches, Workshop, problem};
pub use robot::{Cable, SimulatedRobot, type_to};
pub use scene::{others, scene};
pub use world::{EDITED, edited_world};
