//! Our own image for the Mega, on the emulated chip: the same bits as the native robot, and its interrupts' times.
//! `cargo xtask firmware` builds it.
#![cfg(test)]

mod board;
mod debugger;
mod edges;
mod experiments;
mod faults;
mod float;
mod in_time;
mod interrupts;
mod pins;
mod same_bits;
mod saved;
mod soak;
mod state;
mod talk;
mod tape;
mod through_pins;
mod world;

/// The full check, not the gate: all ticks and seeds.
fn is_full() -> bool {
    std::env::var_os("RUMBO_FULL").is_some()
}
