//! The simulated lab: its world, its clock, programs in place of the core.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "helpers of tests too"
)]

mod bench;
mod calibration;
mod explain;
mod fleet;
mod hand;
mod play;
mod programs;
mod supply;
mod velocity;
mod world;
