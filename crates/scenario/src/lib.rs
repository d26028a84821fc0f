//! Rumbo's experiments: the robot against the plant, metrics, identification.

pub mod files;
pub mod identify;
pub mod sonar_stats;
