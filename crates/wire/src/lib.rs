//! Rumbo's bytes, in both directions and at both ends: frames, messages, the original's text protocol and its CSV.
//!
//! Bytes come in through [`Decoder`], which finds binary frames and lines of text by itself. A frame becomes a
//! message ([`message`]) in [`codec`], a line becomes a command or a row of telemetry in [`text`]; both are checked
//! values, and acting on them is left to other crates. On the way out, [`codec`] turns a message into a
//! [`Frame`] and [`text`] formats a line.
//!
//! Nothing here allocates, panics, or formats with `core::fmt` on the robot's side. The bytes are described for
//! people in `docs/protocol.md`, which a test keeps true.
#![no_std]

mod bytes;
pub mod codec;
pub mod csv;
mod decimal;
pub mod decoder;
pub mod frame;
mod line_ending;
mod malformed;
pub mod message;
#[cfg(feature = "names")]
mod names;
mod quantise;
pub mod text;
mod text_error;
mod text_line;
mod text_parse;
mod text_published;
mod text_row;
mod text_telemetry;
mod text_units;
#[cfg(feature = "names")]
mod words;

pub use codec::FrameMessage;
pub use decoder::{Decoder, Received};
pub use frame::{Frame, FrameBody, Kind, crc as crc16};
pub use line_ending::LineEnding;
pub use malformed::Malformed;
pub use message::*;

/// The example of the README is a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
