//! The lab: simulated robots as the targets of sessions, with their world and its experiments.
//!
//! A [`SimulatedRobot`] needs no files, threads or clocks: `rumbo lab` runs it behind the station, the browser in a
//! worker. What only a computer has is plugged in: a compiler for sketches ([`Sketches`]), debuggers
//! ([`Holder`]), a port for other programs ([`Cable`]).

mod calibration;
mod hand;
mod hash;
mod in_hand;
mod live;
pub mod manifest;
mod play;
mod prepare;
mod program;
mod robot;
mod robots;
pub mod run_log;
mod scene;
mod sight;
mod world;

pub use calibration::calibration;
pub use hand::HAND;
pub use hash::{recorded_hash, run_hash};
pub use in_hand::{Attach, Holder};
pub use live::Live;
pub use program::{Made, Make, OwnProgram, Sketches, Workshop, problem};
pub use robot::{Cable, SimulatedRobot, type_to};
pub use scene::{others, scene};
pub use world::{EDITED, edited_world};
