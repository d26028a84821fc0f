//! Rumbo's bytes, in both directions and at both ends: frames, messages, the original's text protocol and its CSV.
#![no_std]

pub mod message;

pub use message::*;
