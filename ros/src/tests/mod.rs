//! The node without a robot and without a middleware.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests too")]

mod navigate;
mod node;
mod parameters;
mod station;
