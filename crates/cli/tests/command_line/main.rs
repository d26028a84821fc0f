//! What the command says, where it says it, and with which exit status.

#![allow(clippy::unwrap_used, clippy::panic)]

mod import;
mod observe;
mod run;
mod sketch;
#[path = "../support/mod.rs"]
mod support;
mod told;
mod wrong_input;
