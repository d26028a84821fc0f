//! An ATmega2560, exact to the cycle. It knows the chip only: what is wired to its pins is its caller's business.
//!
//! image file -> [`image`] -> flash -> [`decode`] -> [`cpu`], which meets the peripherals through [`io::Io`].

pub mod cpu;
pub mod decode;
pub mod image;
pub mod io;
pub mod status;
pub mod verdict;
