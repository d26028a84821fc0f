//! An AVR chip, exact to the cycle: an ATmega2560 or an ATmega328P, by its description ([`model`]). It knows the chip
//! only: what is wired to its pins is its caller's business.
//!
//! image file -> [`image`] -> flash -> [`decode`] -> [`cpu`], which meets the peripherals ([`devices`]) through
//! [`io::Io`]. [`chip::Chip`] is all of it, and [`observe`] watches a program while it
//! runs.

pub mod chip;
pub mod cpu;
pub mod decode;
pub mod devices;
pub mod disassemble;
pub mod gdb;
pub mod image;
pub mod io;
pub mod model;
pub mod observe;
mod registers;
pub mod space;
pub mod status;
pub mod verdict;
mod watchpoint;

/// The example of the README is a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
