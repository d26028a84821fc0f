//! The signals of a wiring on the pins of the chip.

use crate::drivers::Driver;
use crate::error::SimError;
use crate::wiring::{Divider, Wiring};
use rumbo_emulator::devices::ports::Pin;

/// The inputs of one half of the driver.
pub(super) const INPUTS: [&str; 4] = ["enable", "forward", "backward", "standby"];

/// An input of the driver.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum DriverInput {
    /// Not wired, or held low.
    #[default]
    Low,
    /// Held high.
    High,
    /// On this pin.
    Pin(Pin),
}

impl DriverInput {
    pub(super) fn pin(self) -> Option<Pin> {
        match self {
            Self::Pin(pin) => Some(pin),
            Self::Low | Self::High => None,
        }
    }
}

/// A wiring in terms of the chip. Pairs are left and right, triples are left, right and front, as the plant counts.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Wires {
    pub(super) driver: &'static Driver,
    /// The inputs of each half, as [`INPUTS`].
    pub(super) bridges: [[DriverInput; 4]; 2],
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
            let inputs = INPUTS[..3].iter().zip(bridge);
            named.extend(inputs.map(|(input, on)| (format!("{side}_{input}"), on.pin())));
            named.push((format!("{side}_encoder"), encoder));
        }
        named.push(("standby".to_owned(), self.bridges[0][3].pin()));
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
        let number = |signal: &str| wiring.pins.get(signal).copied();
        let pin = |signal: &str| number(signal).and_then(|number| wiring.board.pin(number));
        let driver = wiring.driver;
        let input = |signal: &str, otherwise: DriverInput| match wiring.held.get(signal) {
            Some(true) => DriverInput::High,
            Some(false) => DriverInput::Low,
            None => pin(signal).map_or(otherwise, DriverInput::Pin),
        };
        let bridge = |side: &str| {
            let enable = match driver.has_enable {
                true => input(&format!("{side}_enable"), DriverInput::Low),
                false => DriverInput::High,
            };
            let [forward, backward] = ["forward", "backward"]
                .map(|way| input(&format!("{side}_{way}"), DriverInput::Low));
            // A module holds what nobody wires.
            let standby = input("standby", DriverInput::High);
            [enable, forward, backward, standby]
        };
        let sonars = ["left", "right", "front"];
        Ok(Self {
            driver,
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
            .flat_map(|bridge| bridge.map(DriverInput::pin))
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
    match wiring.board.usart(receive, transmit) {
        Some(usart) => Ok(Some(usart)),
        None => Err(SimError::LinkPins {
            wiring: name.to_owned(),
            board: wiring.board,
            receive,
            transmit,
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
