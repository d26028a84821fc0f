//! Rumbo's experiments: the robot against the plant, metrics, identification.

mod board;
pub mod files;
pub mod identify;
pub mod metrics;
mod operator;
mod original;
pub mod run;
pub mod sim;
pub mod sonar_fault;
pub mod sonar_stats;
pub mod trace;
