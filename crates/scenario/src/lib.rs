//! Rumbo's experiments: the robot against the plant, metrics, identification.

pub mod files;
