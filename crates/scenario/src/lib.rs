//! Rumbo's experiments: the robot against the plant, metrics.

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
