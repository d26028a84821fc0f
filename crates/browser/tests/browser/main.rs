//! The lab as the page's worker runs it, with a simulated robot and with one at a serial port.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "helpers of tests too"
)]

mod fleet;
mod lab;
mod robot;
