//! The station: ports, pages, doors and what comes through them.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "helpers of tests too"
)]

mod beside;
mod door;
mod lab;
#[path = "../support/page.rs"]
mod page;
mod port;
mod security;
#[path = "../support/mod.rs"]
mod support;
mod tuning;
mod unplugged;
