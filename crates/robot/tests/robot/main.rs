//! The robot as the station meets it: commands, reports, safety.

mod commands;
mod reports;
mod safety;
#[path = "../support/mod.rs"]
mod support;
mod velocity;
