//! The session of a robot over links of every quality.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "helpers of tests too"
)]

mod alone;
mod exactly_once;
mod faulty_link;
mod hostile;
mod late_on;
#[path = "../support/link.rs"]
mod link;
mod never_late;
#[path = "../support/mod.rs"]
mod support;
