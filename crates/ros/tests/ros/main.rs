//! A robot in the messages of ROS 2.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "helpers of tests too"
)]

mod convert;
mod surroundings;
mod types;
