//! The plant and its sensors, one by one and in lanes.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "helpers of tests too"
)]

mod cone;
mod lanes;
mod moving;
mod plant;
mod sonar;
