//! The plant's parameters from recorded runs, and how noisy their sonars were.
//!
//! ```text
//! files ─► recordings: CSVs of the original program (dialect), logs of ours (stretches)
//!            ├─► log ─► replay: the recorded duty on a plant ─► residuals (problem) ─► search and fit
//!            │     └─► pair: which sonar is which ─► wall: distances      │
//!            │            score: RMSE, R^2 per run ◄─────────────────┤ parameters, uncertainties
//!            │            plot: measured and simulated ◄─────────────┤
//!            │            rewrite: [plant] of a robot file ◄─────────┘
//!            └─► sonar_stats: noise, outliers and losses, beside those of the plant's sonars
//! ```
//!
//! What differs from run to run, the battery's voltage, the floor's friction and scrubbing, is a nuisance per run;
//! [`check`] fits nothing else. Derivation and choice of the unknowns: `problem`.
//!
//! It knows the plant, and the texts it is given: no scenario, no simulator, no files of the project.

pub mod dialect;
pub mod plan;
pub mod sonar_stats;

mod contradiction;
mod descent;
mod doubts;
mod error;
mod fit;
mod foreign;
mod log;
mod pair;
mod plot;
mod problem;
mod progress;
mod recordings;
mod replay;
mod report;
mod residuals;
mod rewrite;
mod row;
mod score;
mod shown;
mod stretches;
mod unknowns;
mod wall;

#[cfg(test)]
mod tests;

pub use error::IdentifyError;
pub use fit::{
    AgainstTruth, GENERATIONS, Identification, Identified, check, identify, leave_one_out,
};
pub use foreign::lacks;
pub use log::{DriveLog, RobotProgram};
pub use pair::{Correlation, SonarPair};
pub use plot::plot;
pub use progress::FitProgress;
pub use recordings::{Recordings, RecordingsOutcome};
pub use replay::Nuisance;
pub use rewrite::rewrite;
pub use score::{RunScore, WheelError};
pub use stretches::{BATTERY, IN_THE_AIR, ON_THE_FLOOR, Stretches, stretches};
