//! A robot as a node of ROS 2.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "helpers of tests too"
)]

mod convert;
mod navigate;
mod node;
mod parameters;
mod types;
