//! The link: frames, messages and text, as the documents say.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "helpers of tests too"
)]

#[path = "../common/mod.rs"]
mod common;
mod messages;
mod protocol_doc;
mod stream;
mod text;
