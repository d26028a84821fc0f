//! The chip, part by part, against its data sheet and other emulators.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "helpers of tests too"
)]

mod analog;
mod buses;
#[path = "../common/mod.rs"]
mod common;
mod eeprom;
mod gdb;
mod images;
mod instructions;
mod observe;
mod pins;
mod programming;
mod registers;
mod sketches;
mod sleep;
mod snapshot;
mod spi;
mod synchronous;
mod timer_access;
mod timers;
mod twi;
mod uno;
mod usart;
mod verdicts;
mod watchdog;
mod waveforms;
