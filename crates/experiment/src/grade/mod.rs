//! Grading: drives an assignment's scenarios and seeds with each hand-in's program, and gives points by ground truth.
//!
//! ```text
//! assignment.toml ─► Assignment (tests, rubric)     HandIn (an image, or why there is none)
//!                          └──────────────┬──────────────┘
//!                     a run for each test and seed ─► metrics ─► Mark
//! ```
//!
//! Metrics come from ground truth, from the pins, and from what the emulator sees of the program; its own output is ignored. A value that never came
//! about earns nothing. The same image gets the same mark.

mod assignment;
mod mark;
mod program;
mod runs;
mod visibility;

pub use assignment::{Assignment, Bilingual, Criterion, GradedTest};
pub use mark::{Mark, RubricLine};
pub use runs::{HandIn, grade};
pub use visibility::Visibility;
