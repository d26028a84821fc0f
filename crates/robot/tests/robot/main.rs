//! The robot as the station meets it: commands, reports, safety.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "helpers of tests too"
)]

mod commands;
mod reports;
mod safety;
#[path = "../support/mod.rs"]
mod support;
mod velocity;
