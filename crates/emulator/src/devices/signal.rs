//! What crosses the boundary of the chip: inputs and events, each with its cycle.

use super::ports::{Drive, Pin};

/// Something from outside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Input {
    /// A pin is driven to a level, or released (`None`).
    Pin(Pin, Option<bool>),
    /// A byte arrives at a USART's RXD pin as a frame of 8 data bits, no parity and one stop bit, whose start bit begins at
    /// this cycle, or when the frame before it is over. The line idles high. What the chip makes of it depends on the USART's own
    /// settings: another `baud` gives other bytes and frame errors.
    Serial {
        /// USART 0 to 3.
        usart: u8,
        /// What is sent.
        byte: u8,
        /// The sender's rate [bit/s].
        baud: u32,
    },
    /// The same with any frame: 9 data bits, parity, a break.
    Frame {
        /// USART 0 to 3.
        usart: u8,
        /// The line's levels after the start bit, the lowest bit first: data, parity, stop bits.
        bits: u16,
        /// How many of them count, up to 16.
        count: u8,
        /// The sender's rate [bit/s].
        baud: u32,
    },
    /// The voltage on an analog input from now on; as a digital level, a half of the supply and above is high. A pin that is driven to a
    /// level has the supply's voltage or none.
    Volts {
        /// ADC0 to ADC15; 16 is the pin AREF, 17 and 18 are the comparator's AIN0 and AIN1.
        channel: u8,
        /// Against ground [V], 0 to 5.
        volts: f64,
    },
    /// What a device on the two-wire bus does with the byte that [`Event::TwoWire`] announced, until that byte is over.
    TwoWire(Reply),
    /// The chip is reset.
    Reset(Cause),
}

/// What a device on the two-wire bus does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reply {
    /// It acknowledges the byte that it gets.
    Acknowledge,
    /// It sends this one.
    Byte(u8),
}

/// A byte that begins on the two-wire bus, with the chip as the master.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Transfer {
    /// A device is addressed: its address in the upper seven bits, and whether it is to send.
    Address(u8),
    /// The addressed device gets this byte.
    Write(u8),
    /// The addressed device is to send one.
    Read,
    /// The transmission ends: a stop.
    End,
}

/// Something to the outside, at its cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Output {
    /// When.
    pub cycle: u64,
    /// What.
    pub event: Event,
}

/// What the chip did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event {
    /// It drives a pin differently. Includes the edges of PWM and of serial lines.
    Pin(Pin, Drive),
    /// A USART has sent a frame: the end of its last stop bit.
    Byte {
        /// USART 0 to 3.
        usart: u8,
        /// Its data bits, 5 to 9.
        byte: u16,
        /// The rate at which the chip sent it [bit/s].
        baud: f64,
    },
    /// A timer drives a pin with another PWM from this cycle on; `None` when it lets go of the pin or counts without PWM.
    Duty {
        /// The output.
        pin: Pin,
        /// What it does there.
        pwm: Option<Pwm>,
    },
    /// A byte begins on the two-wire bus; announced where it was asked for ([`crate::chip::Chip::watch_two_wire`]). The run pauses, for
    /// [`Input::TwoWire`]: without one nobody answers.
    TwoWire(Transfer),
    /// The chip was reset, and starts over.
    Reset(Cause),
}

/// A pulse-width modulated output.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pwm {
    /// Share of the time for which the pin is high, 0 to 1.
    pub share: f64,
    /// Cycles from one pulse to the next; `None` if the level is constant (the timer stands) or a pin clocks the timer.
    pub period_cycles: Option<u64>,
}

/// Why the chip was reset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// The supply was switched on.
    PowerOn,
    /// The reset pin.
    External,
    /// The supply sagged.
    BrownOut,
    /// The watchdog ran out.
    Watchdog,
}

/// The level of a pin from a cycle on, driven by the chip or from outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Level {
    /// When.
    pub cycle: u64,
    /// Which pin.
    pub pin: Pin,
    /// The level.
    pub high: bool,
}
