//! The boards: which chip each has, and which of its pins the board numbers how.
//!
//! Sources: the schematics of the Arduino Mega 2560 R3 and the Arduino Uno R3.

use rumbo_emulator::devices::ports::Pin;
use rumbo_emulator::model::{ATMEGA328P, ATMEGA2560, Model};
use std::fmt;

/// A board.
pub struct Board {
    /// As robot files name it: `mega`.
    pub name: &'static str,
    /// As people do: `Arduino Mega`.
    pub title: &'static str,
    /// Its chip.
    pub chip: &'static Model,
    /// Port and bit of each pin, by its number on the board.
    pins: &'static [&'static str],
    /// Receiving and transmitting pin of each USART, by number.
    usarts: &'static [[u8; 2]],
    /// Pins with a resistor of 10 kOhm to the supply on the board.
    pulled_up: &'static [u8],
    /// The pins of the two-wire bus, SDA and SCL.
    pub two_wire: [u8; 2],
    /// The number of pin A0; the others follow.
    pub first_analogue: u8,
    /// The number of the last analogue input, which may have no digital pin.
    pub last_analogue: u8,
    /// Pins with PWM, on which `analogWrite()` does more than switch.
    pub pwm: &'static [u8],
    /// Those that lose it while the Servo library drives servos.
    pub servo_takes: &'static [u8],
    /// Pins on which SoftwareSerial can receive; all where there are none.
    listening: &'static [u8],
    /// Pins with an interrupt for `attachInterrupt()`.
    pub interrupts: &'static [u8],
    /// Whether our own control program fits into its chip.
    pub runs_rumbo: bool,
}

/// The Arduino Mega 2560; 54 to 69 are the analogue inputs A0 to A15.
pub static MEGA: Board = Board {
    name: "mega",
    title: "Arduino Mega",
    chip: &ATMEGA2560,
    pins: &[
        "E0", "E1", "E4", "E5", "G5", "E3", "H3", "H4", "H5", "H6", "B4", "B5", "B6", "B7", "J1",
        "J0", "H1", "H0", "D3", "D2", "D1", "D0", "A0", "A1", "A2", "A3", "A4", "A5", "A6", "A7",
        "C7", "C6", "C5", "C4", "C3", "C2", "C1", "C0", "D7", "G2", "G1", "G0", "L7", "L6", "L5",
        "L4", "L3", "L2", "L1", "L0", "B3", "B2", "B1", "B0", "F0", "F1", "F2", "F3", "F4", "F5",
        "F6", "F7", "K0", "K1", "K2", "K3", "K4", "K5", "K6", "K7",
    ],
    usarts: &[[0, 1], [19, 18], [17, 16], [15, 14]],
    // Of the two-wire bus.
    pulled_up: &[20, 21],
    two_wire: [20, 21],
    first_analogue: 54,
    last_analogue: 69,
    pwm: &[2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 44, 45, 46],
    servo_takes: &[44, 45, 46],
    listening: &[
        10, 11, 12, 13, 14, 15, 50, 51, 52, 53, 62, 63, 64, 65, 66, 67, 68, 69,
    ],
    interrupts: &[2, 3, 18, 19, 20, 21],
    runs_rumbo: true,
};

/// The Arduino Uno; 14 to 19 are the analogue inputs A0 to A5.
pub static UNO: Board = Board {
    name: "uno",
    title: "Arduino Uno",
    chip: &ATMEGA328P,
    pins: &[
        "D0", "D1", "D2", "D3", "D4", "D5", "D6", "D7", "B0", "B1", "B2", "B3", "B4", "B5", //
        "C0", "C1", "C2", "C3", "C4", "C5",
    ],
    usarts: &[[0, 1]],
    pulled_up: &[],
    two_wire: [18, 19],
    first_analogue: 14,
    last_analogue: 19,
    pwm: &[3, 5, 6, 9, 10, 11],
    servo_takes: &[9, 10],
    listening: &[],
    interrupts: &[2, 3],
    // Its state alone takes more than the 2 KB of SRAM.
    runs_rumbo: false,
};

/// The Arduino Nano: the Uno's pins of the same numbers, and A6 and A7, which are analogue inputs only.
pub static NANO: Board = Board {
    name: "nano",
    title: "Arduino Nano",
    last_analogue: 21,
    ..UNO
};

/// The boards that there are.
pub static BOARDS: [&Board; 3] = [&MEGA, &UNO, &NANO];

impl Board {
    /// The board of this name.
    #[must_use]
    pub fn named(name: &str) -> Option<&'static Board> {
        BOARDS.into_iter().find(|board| board.name == name)
    }

    /// The chip's pin that the board numbers so.
    #[must_use]
    pub fn pin(&self, number: u8) -> Option<Pin> {
        let mut place = self.pins.get(usize::from(number))?.chars();
        let (letter, bit) = (place.next()?, place.next()?.to_digit(10)?);
        Pin::new(letter, bit as u8)
    }

    /// The converter's channel at a pin.
    pub(crate) fn channel(&self, number: u8) -> Option<u8> {
        let analogue = self.first_analogue..=self.last_analogue;
        analogue
            .contains(&number)
            .then(|| number - self.first_analogue)
    }

    /// The highest number of a pin.
    #[must_use]
    pub fn last_pin(&self) -> u8 {
        self.last_analogue
    }

    /// The number of a pin by its name: `A3`, `D5`, `5`.
    #[must_use]
    pub fn numbered(&self, name: &str) -> Option<u8> {
        let analogue = name.strip_prefix(['A', 'a']);
        let digits = analogue
            .or_else(|| name.strip_prefix(['D', 'd']))
            .unwrap_or(name);
        let number: u8 = digits.parse().ok()?;
        let number = match analogue {
            Some(_) => number.checked_add(self.first_analogue)?,
            None => number,
        };
        (number <= self.last_pin()).then_some(number)
    }

    /// Whether SoftwareSerial can receive on a pin, or a USART does.
    #[must_use]
    pub fn listens(&self, number: u8) -> bool {
        let usart = self.usarts.iter().any(|[receive, _]| *receive == number);
        usart || self.listening.is_empty() || self.listening.contains(&number)
    }

    /// A pin for people: `5`, `A3`.
    #[must_use]
    pub fn shown(&self, number: u8) -> String {
        match number.checked_sub(self.first_analogue) {
            Some(analogue) => format!("A{analogue}"),
            None => number.to_string(),
        }
    }

    /// The board's pins by their numbers: `pin_02`.
    pub(crate) fn signals(&self) -> impl Iterator<Item = (String, Pin)> {
        let numbers = 0..=self.last_pin();
        numbers.filter_map(|number| Some((format!("pin_{number:02}"), self.pin(number)?)))
    }

    /// The USART on these pins.
    pub(crate) fn usart(&self, receive: Option<u8>, transmit: Option<u8>) -> Option<u8> {
        let found = self.usarts.iter().position(|[own_receive, own_transmit]| {
            receive == Some(*own_receive) && transmit == Some(*own_transmit)
        });
        found.map(|usart| usart as u8)
    }

    /// The pins on which its USARTs receive.
    pub(crate) fn receivers(&self) -> impl Iterator<Item = Pin> {
        self.usarts
            .iter()
            .filter_map(|[receive, _]| self.pin(*receive))
    }

    /// The pins that are high where nothing is connected.
    pub(crate) fn pulled_up(&self) -> impl Iterator<Item = Pin> {
        self.pulled_up.iter().filter_map(|pin| self.pin(*pin))
    }

    /// The pins on which its USARTs transmit, by number of the USART.
    pub(crate) fn transmitters(&self) -> impl Iterator<Item = Option<Pin>> {
        self.usarts.iter().map(|[_, transmit]| self.pin(*transmit))
    }

    /// Receiving and transmitting pin of a USART that it has.
    pub(crate) fn usart_pins(&self, usart: u8) -> [u8; 2] {
        self.usarts
            .get(usize::from(usart))
            .copied()
            .unwrap_or_default()
    }
}

/// The Mega, for which most robots are.
impl Default for &'static Board {
    fn default() -> Self {
        &MEGA
    }
}

impl PartialEq for Board {
    fn eq(&self, other: &Board) -> bool {
        self.name == other.name
    }
}

impl Eq for Board {}

impl fmt::Debug for Board {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(self.name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pin_of_a_board_is_another_pin_of_the_chip() {
        for (board, count) in [(&MEGA, 70), (&UNO, 20)] {
            let mut pins: Vec<_> = (0..count)
                .map(|number| board.pin(number).unwrap())
                .collect();
            pins.sort_unstable();
            pins.dedup();
            assert_eq!(pins.len(), usize::from(count));
            assert_eq!(board.pin(count), None);
        }
    }
}
