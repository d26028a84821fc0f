//! What the fuzz targets check, a module each: `check` panics if the claim does not hold for an input. libFuzzer calls
//! them with inputs of its own (`cargo xtask fuzz`), the tests with the seeds.

#![allow(
    clippy::panic,
    clippy::expect_used,
    clippy::ok_expect,
    clippy::unwrap_used,
    reason = "a claim that does not hold is a finding"
)]

pub mod chip;
pub mod devices;
pub mod files;
pub mod image;
pub mod log;
pub mod orders;
pub mod robot;
pub mod wire;
