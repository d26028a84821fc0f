//! The plant and its sensors.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "helpers of tests too"
)]

mod cone;
mod fidelity;
mod moving;
mod plant;
mod sonar;
