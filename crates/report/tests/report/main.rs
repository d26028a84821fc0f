//! The report and its content.

mod content;
mod report;
