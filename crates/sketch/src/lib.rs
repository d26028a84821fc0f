//! Arduino sketches compiled for a Mega or an Uno as the Arduino IDE does, without the IDE.
//!
//! ```text
//! folder or .ino ─► Source (files in memory, bounded) ─► one C++ file with prototypes ─► objects ─► image.elf
//! core, libraries ─────────────────────────────────────────────────────────────► core.a ─┘
//! ```
//!
//! [`Toolchain`] is a compiler and an Arduino core: those that arduino-cli has installed, else Debian's. [`Compiler`]
//! runs it on a [`Source`], in a [`sandbox`] if the source is not trusted. Products are cached by the hash of all that
//! went into them. The options are those of the core's `platform.txt` and `boards.txt`.

pub mod archive;
mod board;
mod build;
mod bundled;
mod census;
mod compiler;
mod diagnostics;
mod error;
#[cfg(all(test, target_os = "linux"))]
mod escape;
mod examples;
mod headers;
mod layout;
mod libraries;
pub mod limits;
mod options;
mod platformio;
mod preprocess;
mod product;
pub mod sandbox;
pub mod similar;
mod source;
mod toolchain;

pub use board::{BOARDS, Board};
pub use compiler::{Compiler, EXAMPLE, Image, cache, image_of, image_to_debug};
pub use diagnostics::{Diagnostic, Severity};
pub use error::SketchError;
pub use examples::{example, examples, starter};
pub use source::{Given, Source, given, is_program};
pub use toolchain::Toolchain;
