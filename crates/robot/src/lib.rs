//! Rumbo's robot: one tick from bytes and edges to duty and telemetry.
//!
//! bytes -> [`Robot::receive`]: decoder -> ledger (each command once) -> supervisor, mode, parameters;
//! sensors -> [`Robot::tick`]: supervisor (link alive?) -> pilot (estimate, mode, drive layer) -> governor -> reporter -> outbox;
//! [`Robot::transmit`] -> bytes; [`latch`]: the interrupts' stamps as inputs of the tick;
//! [`Robot::recall`] and [`Robot::store`]: parameters from and to the EEPROM.
//!
//! No clock, no pins, no waiting, no allocation: the firmware, the emulated chip and the simulator run this same
//! robot. The bytes are described in `docs/protocol.md`.
#![no_std]

mod clock;
mod encoders;
mod governor;
pub mod latch;
mod ledger;
#[cfg(not(target_arch = "avr"))]
mod loops;
mod outbox;
mod pilot;
mod policy;
mod report;
mod robot;
mod sonars;
mod store;
mod supervisor;
mod text;

#[cfg(not(target_arch = "avr"))]
pub use loops::Loops;
pub use policy::NETWORK_AT;
pub use robot::{Robot, RobotConfig};
pub use store::{Cell, START_AT};
