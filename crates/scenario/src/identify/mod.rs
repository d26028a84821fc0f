//! The plant's parameters from recorded runs.
//!
//! ```text
//! CSV ─► log ─► replay: the recorded duty on a plant ─► residuals (problem) ─► search and fit ─► parameters, uncertainties
//!                                                                                         ├─► score: RMSE, R^2 per run
//!                                                                                         ├─► rewrite: [plant] of a robot file
//!                                                                                         └─► plot: measured against simulated
//! ```
//!
//! What differs from run to run, the battery's voltage and the floor's friction, is fitted per run as a nuisance;
//! [`check`] fits nothing else. Derivation and choice of the unknowns: [`problem`].

pub use error::IdentifyError;
pub use fit::{Check, GENERATIONS, Identification, Identified, check, identify};
pub use log::DriveLog;
pub use plot::Plot;
pub use replay::Nuisance;
pub use rewrite::rewrite;
pub use score::{RunScore, WheelError};

pub mod problem;

mod error;
mod fit;
mod log;
mod plot;
mod replay;
mod report;
mod rewrite;
mod score;

#[cfg(test)]
mod tests;
