//! Grading: an assignment's scenarios and seeds driven by each hand-in's program, and points for what truly happened.
//!
//! ```text
//! assignment.toml ─► Assignment (tests, rubric)     HandIn (an image, or why there is none)
//!                          └──────────────┬──────────────┘
//!                     a run for each test and seed ─► metrics ─► Mark
//! ```
//!
//! Metrics come from ground truth and from the pins; what a program says counts for nothing. What never happened earns
//! nothing. The same image gets the same mark.

mod assignment;
mod mark;
mod runs;

pub use assignment::{Assignment, Criterion, Test, Words};
pub use mark::{Line, Mark};
pub use runs::{HandIn, grade};
