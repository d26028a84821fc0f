//! A source-level debugger for programs on the emulated chip, forwards and backwards, and its adapter for editors.
//!
//! ```text
//! ELF file -> symbols: lines, scopes, types            chip -> unwind: frames
//!                 |                                              |
//!                 +--> location, value, expression <-------------+
//!                                 |
//! history: snapshots -> control: breakpoints, steps -> dap: requests in, responses and events out
//! ```
//!
//! Nothing here does I/O or reads a clock: a [world](rumbo_emulator::gdb::DebuggedWorld) advances by the chip's cycles, and
//! while the program stands, so does the world. A [`dap::Adapter`] takes and gives bytes.

pub mod control;
pub mod dap;
mod expression;
mod history;
mod location;
mod spot;
mod stack;
pub mod symbols;
mod unwind;
mod value;
