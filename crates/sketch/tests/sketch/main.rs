//! Sketches of others: compiled in a sandbox.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "helpers of tests too"
)]

mod compile;
mod hostile;
mod ide;
