//! The Arduino Mega's pin numbers as pins of the chip, and the signals of a wiring on them.
//!
//! Source of the table: the schematic of the Arduino Mega 2560 R3; numbers 54 to 69 are the analogue inputs A0 to A15.

use crate::error::SimError;
use crate::wiring::{Divider, Wiring};
use rumbo_emulator::devices::ports::Pin;

/// Port letter and bit of each digital pin, by its number on the board.
const PINS: [(char, u8); 70] = [
    ('E', 0),
    ('E', 1),
    ('E', 4),
    ('E', 5),
    ('G', 5),
    ('E', 3),
    ('H', 3),
    ('H', 4),
    ('H', 5),
    ('H', 6),
    ('B', 4),
    ('B', 5),
    ('B', 6),
    ('B', 7),
    ('J', 1),
    ('J', 0),
    ('H', 1),
    ('H', 0),
    ('D', 3),
    ('D', 2),
    ('D', 1),
    ('D', 0),
    ('A', 0),
    ('A', 1),
    ('A', 2),
    ('A', 3),
    ('A', 4),
    ('A', 5),
    ('A', 6),
    ('A', 7),
    ('C', 7),
    ('C', 6),
    ('C', 5),
    ('C', 4),
    ('C', 3),
    ('C', 2),
    ('C', 1),
    ('C', 0),
    ('D', 7),
    ('G', 2),
    ('G', 1),
    ('G', 0),
    ('L', 7),
    ('L', 6),
    ('L', 5),
    ('L', 4),
    ('L', 3),
    ('L', 2),
    ('L', 1),
    ('L', 0),
    ('B', 3),
    ('B', 2),
    ('B', 1),
    ('B', 0),
    ('F', 0),
    ('F', 1),
    ('F', 2),
    ('F', 3),
    ('F', 4),
    ('F', 5),
    ('F', 6),
    ('F', 7),
    ('K', 0),
    ('K', 1),
    ('K', 2),
    ('K', 3),
    ('K', 4),
    ('K', 5),
    ('K', 6),
    ('K', 7),
];
/// Receiving and transmitting pin of USART 0 to 3.
const USARTS: [[u8; 2]; 4] = [[0, 1], [19, 18], [17, 16], [15, 14]];

/// The chip's pin that the board numbers so.
pub fn chip_pin(number: u8) -> Option<Pin> {
    let (letter, bit) = *PINS.get(usize::from(number))?;
    Pin::new(letter, bit)
}

/// The board's pins by their numbers: `pin_02`.
pub(super) fn board_signals() -> impl Iterator<Item = (String, Pin)> {
    let numbers = 0..PINS.len() as u8;
    numbers.filter_map(|number| Some((format!("pin_{number:02}"), chip_pin(number)?)))
}

/// Enable and direction inputs of one half of the bridge; what is not wired stays low.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct BridgePins {
    pub(super) enable: Option<Pin>,
    pub(super) forward: Option<Pin>,
    pub(super) backward: Option<Pin>,
}

/// A wiring in terms of the chip. Pairs are left and right, triples are left, right and front, as the plant counts.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Wires {
    pub(super) bridges: [BridgePins; 2],
    pub(super) encoders: [Option<Pin>; 2],
    pub(super) servo: Option<Pin>,
    pub(super) triggers: [Option<Pin>; 3],
    pub(super) echoes: [Option<Pin>; 3],
    /// The USART that the Bluetooth module is on.
    pub(super) link: Option<u8>,
    /// The battery's divider.
    pub(super) battery: Option<Divider>,
    /// Lines that idle high because something sends on them.
    pub(super) receivers: [Option<Pin>; 2],
}

impl Wires {
    /// The wired pins by what they are for: `left_enable`, `front_echo`, `servo`.
    pub(super) fn signals(&self) -> Vec<(String, Pin)> {
        let mut named = Vec::new();
        for (side, (bridge, encoder)) in ["left", "right"]
            .into_iter()
            .zip(self.bridges.iter().zip(self.encoders))
        {
            named.extend([
                (format!("{side}_enable"), bridge.enable),
                (format!("{side}_forward"), bridge.forward),
                (format!("{side}_backward"), bridge.backward),
                (format!("{side}_encoder"), encoder),
            ]);
        }
        for (index, sonar) in ["left", "right", "front"].into_iter().enumerate() {
            named.push((format!("{sonar}_trigger"), self.triggers[index]));
            named.push((format!("{sonar}_echo"), self.echoes[index]));
        }
        named.push(("servo".to_owned(), self.servo));
        let wired = |(name, pin): (String, Option<Pin>)| Some((name, pin?));
        named.into_iter().filter_map(wired).collect()
    }
}

impl Wires {
    /// # Errors
    /// The link's pins are those of no USART.
    pub(super) fn new(name: &str, wiring: &Wiring) -> Result<Self, SimError> {
        let pin = |signal: &str| wiring.pins.get(signal).copied().and_then(chip_pin);
        let bridge = |side: &str| BridgePins {
            enable: pin(&format!("{side}_enable")),
            forward: pin(&format!("{side}_forward")),
            backward: pin(&format!("{side}_backward")),
        };
        let sonars = ["left", "right", "front"];
        Ok(Self {
            bridges: [bridge("left"), bridge("right")],
            encoders: [pin("left_encoder"), pin("right_encoder")],
            servo: pin("servo"),
            triggers: sonars.map(|sonar| pin(&format!("{sonar}_trigger"))),
            echoes: sonars.map(|sonar| pin(&format!("{sonar}_echo"))),
            link: link_usart(name, wiring)?,
            battery: wiring.battery,
            receivers: [pin("link_rx"), pin("debug_rx")],
        })
    }

    /// The pins whose outputs the robot feels.
    pub(super) fn felt(&self) -> Vec<Pin> {
        let bridges = self.bridges.iter();
        bridges
            .flat_map(|bridge| [bridge.enable, bridge.forward, bridge.backward])
            .chain([self.servo])
            .chain(self.triggers)
            .flatten()
            .collect()
    }
}

/// The USART of a wiring's link, if it has one.
///
/// # Errors
/// The link's pins are those of no USART.
pub fn link_usart(name: &str, wiring: &Wiring) -> Result<Option<u8>, SimError> {
    let pin = |signal: &str| wiring.pins.get(signal).copied();
    let (receive, transmit) = (pin("link_rx"), pin("link_tx"));
    if receive.is_none() && transmit.is_none() {
        return Ok(None);
    }
    let mut usarts = (0..).zip(USARTS);
    let found = usarts.find(|(_, [rx, tx])| receive == Some(*rx) && transmit == Some(*tx));
    match found {
        Some((usart, _)) => Ok(Some(usart)),
        None => Err(SimError::LinkPins {
            wiring: name.to_owned(),
            receive,
            transmit,
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pin_of_the_board_is_another_pin_of_the_chip() {
        let mut pins: Vec<_> = (0..70).map(|number| chip_pin(number).unwrap()).collect();
        pins.sort_unstable();
        pins.dedup();
        assert_eq!(pins.len(), 70);
        assert_eq!(chip_pin(70), None);
    }

    #[test]
    fn a_link_on_pins_without_a_usart_is_refused_with_those_that_have_one() {
        let mut wiring = Wiring::default();
        wiring.pins.insert("link_rx".into(), 10);
        wiring.pins.insert("link_tx".into(), 11);
        let error = Wires::new("mine", &wiring).unwrap_err().to_string();
        assert!(
            error.contains("wiring mine: link_rx = 10") && error.contains("19 and 18"),
            "{error}"
        );
    }
}
