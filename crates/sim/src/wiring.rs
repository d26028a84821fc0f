//! Which signal is on which pin of the board.

use crate::boards::Board;
use crate::bus::BusDevice;
use crate::drivers::Driver;
use crate::floor::LineSensor;
use crate::light::LightSensor;
use crate::maxsonar::MaxSonar;
use crate::obstacle::ObstacleSensor;
use crate::remote::Key;
use std::collections::BTreeMap;

/// The sonars that the control core knows, as the plant counts them.
pub const SONARS: [&str; 3] = ["left", "right", "front"];

/// The signals that a wiring may place: enable and direction inputs of the bridge, its outputs that are low where something
/// is wrong with a motor, encoders, servo, sonars and UARTs.
pub const SIGNALS: [&str; 24] = [
    "left_enable",
    "left_forward",
    "left_backward",
    "left_encoder",
    "left_encoder_b",
    "left_fault",
    "right_enable",
    "right_forward",
    "right_backward",
    "right_encoder",
    "right_encoder_b",
    "right_fault",
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
    /// The motor of a shield that each wheel is on, left and right, where the driver is one.
    pub motors: [Option<Motor>; 2],
    /// Inputs of the driver that are held high or low instead, as by a jumper.
    pub held: BTreeMap<String, bool>,
    /// Sensors for lines on the floor.
    pub line_sensors: Vec<LineSensor>,
    /// Infrared sensors for obstacles.
    pub obstacle_sensors: Vec<ObstacleSensor>,
    /// Light sensors.
    pub light_sensors: Vec<LightSensor>,
    /// Range finders that measure by themselves.
    pub maxsonars: Vec<MaxSonar>,
    /// What else is at pins: what a person works, and what shows something.
    pub parts: Vec<Part>,
    /// The devices on the two-wire bus.
    pub bus: Vec<BusDevice>,
    /// Rate of the Bluetooth module, where it is not the usual one \[baud\].
    pub link_baud: Option<u32>,
    /// The servo is mounted the other way round: longer pulses turn it to the right.
    pub servo_reversed: bool,
    /// Names of the sonars other than left, right and front, each with the signals `NAME_trigger` and `NAME_echo`.
    pub other_sonars: Vec<String>,
    /// The divider that brings the battery's voltage to an analogue input, where there is one.
    pub battery: Option<Divider>,
}

/// A motor of a shield.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Motor {
    /// 1 is M1.
    pub number: u8,
    /// What the shield calls forward drives the wheel backward.
    pub reversed: bool,
}

impl Wiring {
    /// The board's pins that a shield takes: those of its register, and the PWM of the motors that are wired.
    pub fn shield_pins(&self) -> impl Iterator<Item = u8> {
        let motors = self.motors.into_iter().flatten();
        let shield = self.driver.shield.filter(|_| self.motors != [None; 2]);
        let lines = shield.and_then(|shield| shield.lines);
        let speeds = motors.filter_map(move |motor| {
            lines?;
            Some(shield?.inputs_of(motor.number).0)
        });
        let bus = shield.filter(|shield| shield.address.is_some());
        let bus = bus.map(|_| self.board.two_wire);
        let (lines, bus) = (lines.into_iter().flatten(), bus.into_iter().flatten());
        lines.chain(bus).chain(speeds)
    }

    /// Whether a device is on the two-wire bus.
    pub fn has_bus(&self) -> bool {
        self.bus.iter().any(|device| device.address().is_some())
    }

    /// The name of what is on a pin of the board, if anything is: a signal, a part, a line sensor, the two-wire bus.
    #[must_use]
    pub fn owner_of(&self, pin: u8) -> Option<&str> {
        let signals = self.pins.iter().map(|(name, on)| (name.as_str(), *on));
        let parts = self.parts.iter().map(|part| (part.name.as_str(), part.pin));
        let sensors = self.line_sensors.iter();
        let sensors = sensors.map(|sensor| (sensor.name.as_str(), sensor.pin));
        let obstacles = self.obstacle_sensors.iter();
        let obstacles = obstacles.map(|sensor| (sensor.name.as_str(), sensor.pin));
        let lights = self.light_sensors.iter();
        let lights = lights.map(|sensor| (sensor.name.as_str(), sensor.pin));
        let ranges = self.maxsonars.iter().flat_map(|sensor| {
            let pins = [Some(sensor.pin), sensor.rx];
            pins.into_iter()
                .flatten()
                .map(|pin| (sensor.name.as_str(), pin))
        });
        let beside = self.bus.iter();
        let beside = beside.flat_map(|device| device.pins().map(|pin| (device.name.as_str(), pin)));
        let lines = self.board.two_wire.map(|pin| ("the two-wire bus", pin));
        let lines = lines.into_iter().filter(|_| self.has_bus());
        let shield = self.shield_pins().map(|pin| ("the motor shield", pin));
        let mut all = signals
            .chain(shield)
            .chain(parts)
            .chain(sensors)
            .chain(obstacles)
            .chain(beside)
            .chain(lights)
            .chain(ranges)
            .chain(lines);
        all.find(|(_, on)| *on == pin).map(|(name, _)| name)
    }
}

/// Something at a pin that a person works or looks at.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part {
    /// What the robot file calls it.
    pub name: String,
    /// What it is.
    pub kind: PartKind,
    /// The board's pin.
    pub pin: u8,
    /// The level that a resistor gives an open button or switch, which closes to the other one; without a resistor it closes
    /// to GND, and open it floats or follows the chip's pull-up.
    pub resistor: Option<bool>,
    /// The keys of the remote control of an infrared receiver.
    pub keys: Vec<Key>,
}

/// What a part is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PartKind {
    /// Closed while it is pressed.
    Button,
    /// Stays closed or open.
    Switch,
    /// A voltage from 0 to 5 V.
    Potentiometer,
    /// A light.
    Led,
    /// A sound.
    Buzzer,
    /// A receiver for the remote control in somebody's hand.
    Infrared,
}

impl PartKind {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::Button,
        Self::Switch,
        Self::Potentiometer,
        Self::Led,
        Self::Buzzer,
        Self::Infrared,
    ];

    /// Its key in robot files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Button => "button",
            Self::Switch => "switch",
            Self::Potentiometer => "potentiometer",
            Self::Led => "led",
            Self::Buzzer => "buzzer",
            Self::Infrared => "infrared",
        }
    }

    /// Whether a person works it.
    #[must_use]
    pub const fn is_worked(self) -> bool {
        !matches!(self, Self::Led | Self::Buzzer)
    }
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
