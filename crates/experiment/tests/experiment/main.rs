//! Experiments: their files, single runs, batches, and the requirements of each mode.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "helpers of tests too"
)]

mod batch;
mod closed_loop;
mod emulated;
mod files;
mod fleet;
mod golden;
mod moving;
mod quantise;

/// The full check, not the gate: all seeds.
fn is_full() -> bool {
    std::env::var_os("RUMBO_FULL").is_some()
}
