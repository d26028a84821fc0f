//! Rumbo's report: every experiment of the course's report, run and written up as one HTML page without any external part.
//!
//! ```text
//! EXPERIMENTS ─► Plan (setups; those beside a recorded run once more with its references) ─► run on all threads ─► Data ─► html
//! ```
//!
//! A chapter (`chapters/`) is one experiment. Its text is Markdown in English and Spanish, a file of `content/` with
//! places for values, tables and figures; Rust computes what fills them. Figures are SVG inside the page: `rumbo-plot`
//! draws values, `drawing` what depends on the robot; the other drawings are files. The same version, seed and files give
//! the same bytes.

#[cfg(feature = "host")]
pub mod alike;
mod channel;
mod chapters;
#[cfg(feature = "host")]
pub mod compare;
mod complaints;
mod content;
mod data;
mod drawing;
#[cfg(target_family = "wasm")]
pub mod exports;
#[cfg(feature = "host")]
pub mod grade;
mod judge;
mod language;
mod markdown;
mod metric_names;
mod page;
mod places;
mod plan;
pub mod real;
mod respond;
mod signals;
mod stamp;
mod summary;
#[cfg(feature = "host")]
pub mod sweep;
mod table;
pub mod text;
mod text_rows;
mod words;

pub use chapters::EXPERIMENTS;
pub use content::ContentError;
pub use data::{Data, Experiment};
pub use plan::{Plan, Request};
pub use signals::ReportedRun;
pub use stamp::FileStamp;
pub use summary::html;
