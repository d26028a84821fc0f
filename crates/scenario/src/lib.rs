//! Rumbo's experiments: the robot against the plant, metrics.

/// Number of the model: of robot, plant, world and metrics together. Raised with every change of `tests/golden/*.toml`;
/// two runs of the same scenario and seed are comparable bit for bit only within one model.
pub const MODEL: u32 = 1;

mod board;
pub mod calibrate;
pub mod campaign;
pub mod debugging;
pub mod files;
pub mod mega;
pub mod metrics;
pub mod observe;
mod operator;
mod original;
pub mod random_world;
pub mod run;
pub mod shortest_path;
pub mod sim;
pub mod sonar_fault;
pub mod trace;
pub mod wire_fault;
