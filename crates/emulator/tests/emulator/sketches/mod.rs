//! Arduino sketches on the chip: what their pins do, and when. `cargo xtask sketches` builds the images.
#![cfg(test)]

mod board;
mod memory;
mod pins;
mod serial;
mod students;
