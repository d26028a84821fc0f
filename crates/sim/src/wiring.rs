//! Which signal is on which pin of the board.

use crate::boards::Board;
use crate::drivers::Driver;
use std::collections::BTreeMap;

/// The signals that a wiring may place: enable and direction inputs of the bridge, encoders, servo, sonars and UARTs.
pub const SIGNALS: [&str; 22] = [
    "left_enable",
    "left_forward",
    "left_backward",
    "left_encoder",
    "left_encoder_b",
    "right_enable",
    "right_forward",
    "right_backward",
    "right_encoder",
    "right_encoder_b",
    "standby",
    "servo",
    "left_trigger",
    "left_echo",
    "right_trigger",
    "right_echo",
    "front_trigger",
    "front_echo",
    "link_tx",
    "link_rx",
    "debug_tx",
    "debug_rx",
];

/// Signals, of [`SIGNALS`], and the board's pin numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Wiring {
    /// The board.
    pub board: &'static Board,
    /// The motor driver.
    pub driver: &'static Driver,
    /// Pin of each signal.
    pub pins: BTreeMap<String, u8>,
    /// Inputs of the driver that are held high or low instead, as by a jumper.
    pub held: BTreeMap<String, bool>,
    /// Rate of the Bluetooth module, where it is not the usual one \[baud\].
    pub link_baud: Option<u32>,
    /// The divider that brings the battery's voltage to an analogue input, where there is one.
    pub battery: Option<Divider>,
}

/// The inputs of the motor driver, which may be held at a level, and of which several may be on one pin.
#[must_use]
pub fn is_driver_input(signal: &str) -> bool {
    signal == "standby"
        || ["_enable", "_forward", "_backward"]
            .iter()
            .any(|end| signal.ends_with(end))
}

/// A divider between battery and analogue input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Divider {
    /// Analogue input: 0 is A0.
    pub input: u8,
    /// Battery's voltage over that at the input.
    pub ratio: f64,
}
