//! The signals of a wiring on the pins of the chip.

use crate::drivers::Driver;
use crate::error::SimError;
use crate::floor::FloorReading;
use crate::wiring::{Divider, Motor, SONARS, Wiring};
use rumbo_emulator::devices::ports::Pin;
use rumbo_plant::sonar::SonarId;

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
    /// On this output of a shield's register.
    Register(u8),
    /// On this output of a shield's chip on the two-wire bus.
    Output(u8),
}

impl DriverInput {
    pub(super) fn pin(self) -> Option<Pin> {
        match self {
            Self::Pin(pin) => Some(pin),
            Self::Low | Self::High | Self::Register(_) | Self::Output(_) => None,
        }
    }
}

/// Where the Bluetooth module is connected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LinkOn {
    /// To a USART of the chip.
    Usart(u8),
    /// To other pins, on which a program makes a serial port of its own.
    Pins {
        /// Where the chip receives.
        receive: Option<Pin>,
        /// Where it sends.
        transmit: Option<Pin>,
    },
}

/// A wiring in terms of the chip. Pairs are left and right, sonars are as the plant counts them.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Wires {
    pub(super) driver: &'static Driver,
    /// Latch, clock, data and enable of a shield's register.
    pub(super) register: Option<[Pin; 4]>,
    /// The inputs of each half, as [`INPUTS`].
    pub(super) bridges: [[DriverInput; 4]; 2],
    /// Outputs A of both, then outputs B.
    pub(super) encoders: [Option<Pin>; 4],
    pub(super) servo: Option<Pin>,
    pub(super) servo_reversed: bool,
    pub(super) triggers: [Option<Pin>; SonarId::ALL.len()],
    pub(super) echoes: [Option<Pin>; SonarId::ALL.len()],
    /// Names of the sonars after left, right and front.
    pub(super) other_sonars: Vec<String>,
    /// What the Bluetooth module is on.
    pub(super) link: Option<LinkOn>,
    /// The battery's divider.
    pub(super) battery: Option<Divider>,
    /// Lines that something holds high: serial ones that idle, and faults of a driver that has none.
    pub(super) held_high: [Option<Pin>; 4],
    /// Lines that the program charges.
    pub(super) charged: Vec<Pin>,
}

impl Wires {
    /// The wired pins by what they are for: `left_enable`, `front_echo`, `servo`.
    pub(super) fn signals(&self) -> Vec<(String, Pin)> {
        let mut named = Vec::new();
        for (index, side) in ["left", "right"].into_iter().enumerate() {
            let bridge = self.bridges[index];
            let inputs = INPUTS[..3].iter().zip(bridge);
            named.extend(inputs.map(|(input, on)| (format!("{side}_{input}"), on.pin())));
            named.push((format!("{side}_encoder"), self.encoders[index]));
            named.push((format!("{side}_encoder_b"), self.encoders[index + 2]));
        }
        named.push(("standby".to_owned(), self.bridges[0][3].pin()));
        let others = self.other_sonars.iter().map(String::as_str);
        for (index, sonar) in SONARS.into_iter().chain(others).enumerate() {
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
    /// The link's pins are those of a USART, exchanged.
    pub(super) fn new(name: &str, wiring: &Wiring) -> Result<Self, SimError> {
        let number = |signal: &str| wiring.pins.get(signal).copied();
        let pin = |signal: &str| number(signal).and_then(|number| wiring.board.pin(number));
        let driver = wiring.driver;
        let input = |signal: &str, otherwise: DriverInput| match wiring.held.get(signal) {
            Some(true) => DriverInput::High,
            Some(false) => DriverInput::Low,
            None => pin(signal).map_or(otherwise, DriverInput::Pin),
        };
        let on_board = |number: u8| wiring.board.pin(number);
        let on_shield = |motor: Motor| {
            let (speed, [first, second]) = driver.shield?.inputs_of(motor.number);
            let (forward, backward) = match motor.reversed {
                true => (second, first),
                false => (first, second),
            };
            if driver.shield?.address.is_some() {
                let [speed, forward, backward] =
                    [speed, forward, backward].map(DriverInput::Output);
                return Some([speed, forward, backward, DriverInput::High]);
            }
            let [forward, backward] = [forward, backward].map(DriverInput::Register);
            let speed = DriverInput::Pin(on_board(speed)?);
            Some([speed, forward, backward, DriverInput::High])
        };
        let bridge = |index: usize, side: &str| {
            if driver.shield.is_some() {
                let motor = wiring.motors[index].and_then(on_shield);
                return motor.unwrap_or_default();
            }
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
        let lines = |end: &str| {
            let others = wiring.other_sonars.iter().map(String::as_str);
            let mut pins = [None; SonarId::ALL.len()];
            for (own, sonar) in pins.iter_mut().zip(SONARS.into_iter().chain(others)) {
                *own = pin(&format!("{sonar}_{end}"));
            }
            pins
        };
        Ok(Self {
            driver,
            register: driver.shield.and_then(|shield| {
                let lines = shield.lines?.map(on_board);
                let [Some(latch), Some(clock), Some(data), Some(enable)] = lines else {
                    return None;
                };
                Some([latch, clock, data, enable])
            }),
            bridges: [bridge(0, "left"), bridge(1, "right")],
            encoders: [
                "left_encoder",
                "right_encoder",
                "left_encoder_b",
                "right_encoder_b",
            ]
            .map(pin),
            servo: pin("servo"),
            servo_reversed: wiring.servo_reversed,
            triggers: lines("trigger"),
            echoes: lines("echo"),
            other_sonars: wiring.other_sonars.clone(),
            link: link_on(name, wiring)?,
            battery: wiring.battery,
            held_high: ["link_rx", "debug_rx", "left_fault", "right_fault"].map(pin),
            charged: {
                let sensors = wiring.line_sensors.iter();
                let charged = sensors.filter(|sensor| sensor.reading == FloorReading::Discharge);
                charged.filter_map(|sensor| on_board(sensor.pin)).collect()
            },
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
            .chain(self.charged.iter().copied())
            .chain(
                self.register
                    .into_iter()
                    .flat_map(|[latch, _, _, enable]| [latch, enable]),
            )
            .collect()
    }
}

/// What a wiring's link is on, if it has one.
fn link_on(name: &str, wiring: &Wiring) -> Result<Option<LinkOn>, SimError> {
    let number = |signal: &str| wiring.pins.get(signal).copied();
    let (receive, transmit) = (number("link_rx"), number("link_tx"));
    if receive.is_none() && transmit.is_none() {
        return Ok(None);
    }
    let board = wiring.board;
    if let Some(usart) = board.usart(receive, transmit) {
        return Ok(Some(LinkOn::Usart(usart)));
    }
    if let Some(usart) = board.usart(transmit, receive) {
        return Err(SimError::LinkExchanged {
            wiring: name.to_owned(),
            board,
            usart,
        });
    }
    let pin = |number: Option<u8>| number.and_then(|number| board.pin(number));
    let (receive, transmit) = (pin(receive), pin(transmit));
    Ok(Some(LinkOn::Pins { receive, transmit }))
}

/// The USART of a wiring's link, if it is on one.
#[must_use]
pub fn link_usart(wiring: &Wiring) -> Option<u8> {
    match link_on("", wiring) {
        Ok(Some(LinkOn::Usart(usart))) => Some(usart),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn link(receive: u8, transmit: u8) -> Result<Option<LinkOn>, SimError> {
        let mut wiring = Wiring::default();
        wiring.pins.insert("link_rx".into(), receive);
        wiring.pins.insert("link_tx".into(), transmit);
        link_on("mine", &wiring)
    }

    #[test]
    fn a_link_is_on_a_usart_or_on_any_other_pins_and_exchanged_pins_are_named() {
        assert_eq!(link(19, 18), Ok(Some(LinkOn::Usart(1))));
        assert!(matches!(link(10, 11), Ok(Some(LinkOn::Pins { .. }))));
        let error = link(18, 19).unwrap_err().to_string();
        assert!(
            error.contains("wiring mine: link_rx and link_tx are exchanged")
                && error.contains("link_rx = 19"),
            "{error}"
        );
    }
}
