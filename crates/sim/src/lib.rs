//! Rumbo's simulator: robot, plant and emulator on one clock.
//!
//! A [`Sim`] is made from a [`Config`]: which robot in which world, and which program is at its pins; a [`fleet`] has
//! several in one world. It knows no
//! files, no command line and no threads; `rumbo-experiment` makes a configuration from files.

mod baseline;
mod board;
pub mod boards;
pub mod bus;
mod config;
pub mod debugging;
pub mod drivers;
pub mod emulated;
mod error;
pub mod fleet;
pub mod floor;
mod instruments;
pub mod light;
pub mod maxsonar;
pub mod mega;
mod notes;
pub mod obstacle;
pub mod remote;
mod sim;
pub mod sonar_fault;
mod source;
mod tape;
pub mod trace;
pub mod wire_fault;
pub mod wiring;

pub use config::{Config, Program};
pub use error::SimError;
pub use instruments::{READING_US, loop_signals};
pub use rumbo_robot::NETWORK_AT;
pub use sim::{ContactStart, Latched, Sim};
pub use tape::{LinkBurst, LinkTape};
