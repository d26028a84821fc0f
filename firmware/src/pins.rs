//! The pin table: the final wiring, equal to `[wiring.final]` of `robots/memoria.toml`.
//!
//! Pure data, so that `cargo xtask tidy` can read it on the PC and compare it with the robot file. Which port and bit
//! an Arduino pin is: Arduino Mega 2560 schematic.

/// One pin of the board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Pin {
    /// Its name in the robot file.
    pub(crate) name: &'static str,
    /// Its number on the board.
    pub(crate) arduino: u8,
    /// Its port on the chip, a letter.
    pub(crate) port: u8,
    /// Its bit in the port.
    pub(crate) bit: u8,
}

impl Pin {
    /// Its bit, in place.
    #[inline(always)]
    pub(crate) const fn mask(self) -> u8 {
        1 << self.bit
    }
}

macro_rules! pins {
    ($( $id:ident = $name:literal, $arduino:literal, $port:literal, $bit:literal; )+) => {
        $(
            #[doc = concat!("`", $name, "`")]
            pub(crate) const $id: Pin = Pin { name: $name, arduino: $arduino, port: $port, bit: $bit };
        )+

        /// All of them.
        pub(crate) const ALL: &[Pin] = &[ $( $id, )+ ];
    };
}

pins! {
    LEFT_ENABLE = "left_enable", 6, b'H', 3; // OC4A
    LEFT_FORWARD = "left_forward", 7, b'H', 4;
    LEFT_BACKWARD = "left_backward", 8, b'H', 5;
    LEFT_ENCODER = "left_encoder", 21, b'D', 0; // INT0
    RIGHT_ENABLE = "right_enable", 5, b'E', 3; // OC3A
    RIGHT_FORWARD = "right_forward", 4, b'G', 5;
    RIGHT_BACKWARD = "right_backward", 2, b'E', 4;
    RIGHT_ENCODER = "right_encoder", 20, b'D', 1; // INT1
    SERVO = "servo", 9, b'H', 6; // OC2B
    LEFT_TRIGGER = "left_trigger", 15, b'J', 0;
    LEFT_ECHO = "left_echo", 19, b'D', 2; // INT2
    RIGHT_TRIGGER = "right_trigger", 12, b'B', 6;
    RIGHT_ECHO = "right_echo", 18, b'D', 3; // INT3
    FRONT_TRIGGER = "front_trigger", 14, b'J', 1;
    FRONT_ECHO = "front_echo", 3, b'E', 5; // INT5
    LINK_TX = "link_tx", 16, b'H', 1; // TXD2
    LINK_RX = "link_rx", 17, b'H', 0; // RXD2
    DEBUG_TX = "debug_tx", 1, b'E', 1; // TXD0
    DEBUG_RX = "debug_rx", 0, b'E', 0; // RXD0
}
