//! Rumbo's report: every experiment of the course's report, run and written up as one HTML page without any external part.
//!
//! ```text
//! EXPERIMENTS ─► Plan (setups; those beside a recorded run once more with its references) ─► run on all threads ─► Data ─► html
//! ```
//!
//! A chapter (`chapters/`) is one experiment: what it is for, rig and wiring, control scheme, the mathematics, the figures, the metrics
//! against their limits. Figures are drawn by `plot` (values) and `drawing` (everything else) as SVG inside the page. Whatever a reader
//! sees is a [`text::Text`], English and Spanish side by side. The same version, seed and files give the same bytes.

mod chapters;
mod complaints;
mod data;
mod drawing;
mod judge;
mod metric_names;
mod page;
mod plan;
mod plot;
pub mod real;
mod respond;
mod signals;
mod summary;
pub mod text;
mod told;

pub use chapters::{EXPERIMENTS, Experiment};
pub use data::Data;
pub use plan::{Plan, Request};
pub use signals::Outcome;
pub use summary::html;
