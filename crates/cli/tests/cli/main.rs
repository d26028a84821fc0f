//! The command line: what it prints, writes and refuses, and the programs it starts.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "helpers of tests too"
)]

mod browser;
mod calibration;
mod command_line;
mod debug;
mod experiments;
mod files;
mod flash;
mod grade;
mod grade_program;
mod hostile;
mod identify;
mod logs;
mod recording;
mod refused;
mod studies;
#[path = "../support/mod.rs"]
mod support;
mod text_robot;
mod tuning;
