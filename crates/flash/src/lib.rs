//! Writes a program to an Arduino Mega through its boot loader, which speaks STK500v2 (Atmel's application note AVR068),
//! as a state machine without I/O: bytes and times in, bytes and levels of the port's lines out.
//!
//! ```text
//! reset -> sign on -> signature -> page 0 stands still, pages 1.. written -> all of them read back
//! reset -> sign on -> page 0 written -> page 0 read back -> the program starts
//! ```
//!
//! Page 0, where the program begins, comes last. Until then it holds a jump to itself: a board that loses its cable in
//! between stands still, with its pins open, and does not run half a program. The boot loader erases pages in turn,
//! whatever their addresses, and starts over at a reset; that is why all pages are written in order, and why there is a
//! second reset.

mod error;
mod message;
mod programmer;

pub use error::{FlashError, IntoBootSection, Phase};
pub use programmer::{PortAction, Programmer};

/// Baud rate of the Mega's boot loader.
pub const BAUD: u32 = 115_200;
