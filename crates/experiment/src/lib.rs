//! Rumbo's experiments: files that describe them, runs, metrics, campaigns, calibration.

/// Number of the model: of robot, plant, world and metrics together. Raised with every change of `tests/golden/*.toml`;
/// two runs of the same scenario and seed are comparable bit for bit only within one model.
pub const MODEL: u32 = 15;

pub mod batch;
pub mod calibrate;
pub mod calibration_run;
#[cfg(feature = "host")]
pub mod campaign;
pub mod claims;
#[cfg(feature = "host")]
pub mod compare;
pub mod debugged;
pub mod files;
#[cfg(feature = "host")]
pub mod grade;
pub mod hand;
pub mod metrics;
pub mod note;
pub mod observe;
mod operator;
pub mod quantise;
pub mod random_world;
pub mod run;
pub mod shortest_path;
#[cfg(feature = "host")]
pub mod sweep;
#[cfg(feature = "host")]
pub mod tune;
