//! A program image: what it is, which language it speaks on its link, and how it is wired.

use super::pins::{LinkOn, Wires};
use super::{CYCLES_PER_US, ON_PINS};
use crate::boards::Board;
use crate::bus::BusDevice;
use crate::error::SimError;
use crate::floor::LineSensor;
use crate::light::LightSensor;
use crate::maxsonar::MaxSonar;
use crate::obstacle::ObstacleSensor;
use crate::wiring::{Motor, Part, Wiring};
use rumbo_emulator::chip::Chip;
use rumbo_emulator::cpu::Stopped;
use rumbo_emulator::devices::ports::Drive;
use rumbo_emulator::devices::ports::Pin;
use rumbo_emulator::devices::{Event, Input};
use rumbo_emulator::image::Image;
use rumbo_wire::{Decoder, FrameMessage, FromRobot, Received};
use std::collections::BTreeMap;

/// The usual rate of the Bluetooth module [baud].
const LINK_BAUD: u32 = 9600;
/// The pin of the LED, on every board.
const LED: u8 = 13;
/// Time to wait for HELLO, which our program sends as soon as it runs [us].
const BOOT_US: u64 = 600_000;
/// A boot loader has handed over after this [cycles], or never will.
pub(super) const LONGEST_BOOT: u64 = 5_000_000 * CYCLES_PER_US;
/// Room for what a robot sends at once.
const LINE: usize = 128;

/// What a program speaks on its link.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LinkLanguage {
    /// The frames of docs/protocol.md.
    Frames,
    /// The original's lines of text, or nothing.
    Text,
}

/// A program image and what is known about it.
#[derive(Clone, Debug, PartialEq)]
pub struct Firmware {
    name: String,
    image: Image,
    language: LinkLanguage,
    wiring: String,
    board: &'static Board,
    wires: Wires,
    link_baud: u32,
    /// The board's pin of each signal.
    pins: BTreeMap<String, u8>,
    parts: Vec<Part>,
    line_sensors: Vec<LineSensor>,
    obstacle_sensors: Vec<ObstacleSensor>,
    light_sensors: Vec<LightSensor>,
    maxsonars: Vec<MaxSonar>,
    bus: Vec<BusDevice>,
    motors: [Option<Motor>; 2],
}

impl Firmware {
    /// An image called `name`, wired so.
    ///
    /// # Errors
    /// The link's pins are those of a USART, exchanged.
    pub fn new(
        name: &str,
        image: Image,
        language: LinkLanguage,
        (wiring, pins): (&str, &Wiring),
    ) -> Result<Self, SimError> {
        Ok(Self {
            name: name.to_owned(),
            image,
            language,
            wiring: wiring.to_owned(),
            board: pins.board,
            wires: Wires::new(wiring, pins)?,
            pins: pins.pins.clone(),
            parts: pins.parts.clone(),
            line_sensors: pins.line_sensors.clone(),
            obstacle_sensors: pins.obstacle_sensors.clone(),
            light_sensors: pins.light_sensors.clone(),
            maxsonars: pins.maxsonars.clone(),
            bus: pins.bus.clone(),
            motors: pins.motors,
            link_baud: pins.link_baud.unwrap_or(LINK_BAUD),
        })
    }

    /// The same with another image, such as one with more in its flash.
    #[must_use]
    pub fn with_image(self, image: Image) -> Self {
        Self { image, ..self }
    }

    /// The file's name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The board it is for.
    pub fn board(&self) -> &'static Board {
        self.board
    }

    /// The program.
    pub fn image(&self) -> &Image {
        &self.image
    }

    /// Names for pins: the wired ones by what they are for, and all of the board by their numbers.
    pub fn signals(&self) -> Vec<(String, Pin)> {
        let mut signals = self.wires.signals();
        signals.extend(self.board.signals());
        signals
    }

    /// The pins worth an instrument: the wired ones, and the board's LED.
    pub(super) fn metered(&self) -> Vec<(String, Pin)> {
        let led = self.board.pin(LED).map(|pin| ("led".to_owned(), pin));
        let parts = self.parts.iter().filter_map(|part| {
            let name = format!("{}_{}", part.name, part.kind.name());
            Some((name, self.board.pin(part.pin)?))
        });
        let wired = self.wires.signals().into_iter();
        wired.chain(led).chain(parts).collect()
    }

    /// Its sensors for lines on the floor.
    pub fn line_sensors(&self) -> &[LineSensor] {
        &self.line_sensors
    }

    /// Its infrared sensors for obstacles.
    pub fn obstacle_sensors(&self) -> &[ObstacleSensor] {
        &self.obstacle_sensors
    }

    /// Its light sensors.
    pub fn light_sensors(&self) -> &[LightSensor] {
        &self.light_sensors
    }

    /// Its range finders that measure by themselves.
    pub fn maxsonars(&self) -> &[MaxSonar] {
        &self.maxsonars
    }

    /// The devices on its two-wire bus.
    pub fn bus(&self) -> &[BusDevice] {
        &self.bus
    }

    /// The motors of a shield, left and right.
    pub(super) fn motors(&self) -> [Option<Motor>; 2] {
        self.motors
    }

    /// What else is at its pins.
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// What it speaks on its link.
    pub fn language(&self) -> LinkLanguage {
        self.language
    }

    /// Name of the wiring.
    pub fn wiring(&self) -> &str {
        &self.wiring
    }

    /// The board's number of a pin by its number or name (`7`, `A0`), by what is wired to it (`left_enable`), or by the part
    /// at it.
    #[must_use]
    pub fn find(&self, name: &str) -> Option<u8> {
        let part = self.parts.iter().find(|part| part.name == name);
        let named = self.number_of(name).or(part.map(|part| part.pin));
        named.or_else(|| self.board.numbered(name))
    }

    /// The names that [`Firmware::find`] knows beside the board's own.
    pub fn found(&self) -> impl Iterator<Item = &str> + Clone {
        let parts = self.parts.iter().map(|part| part.name.as_str());
        self.pins.keys().map(String::as_str).chain(parts)
    }

    /// The board's number of the pin that a signal is on.
    pub(super) fn number_of(&self, signal: &str) -> Option<u8> {
        self.pins.get(signal).copied()
    }

    /// All signals with the board's numbers of their pins.
    pub(super) fn numbers(&self) -> impl Iterator<Item = (&str, u8)> {
        let pins = self.pins.iter();
        pins.map(|(signal, number)| (signal.as_str(), *number))
    }

    /// The same as the board calls it.
    pub(super) fn pin_of(&self, signal: &str) -> Option<String> {
        Some(self.board.shown(self.number_of(signal)?))
    }

    /// Whether an encoder's output B is wired.
    pub(crate) fn needs_direction(&self) -> bool {
        self.wires.encoders[2..].iter().any(Option::is_some)
    }

    /// The USART that the Bluetooth module is on, if the wiring has one; [`ON_PINS`] where it is on other pins.
    pub fn link_usart(&self) -> Option<u8> {
        match self.wires.link? {
            LinkOn::Usart(usart) => Some(usart),
            LinkOn::Pins { .. } => Some(ON_PINS),
        }
    }

    /// Rate of the Bluetooth module \[baud\].
    pub fn link_baud(&self) -> u32 {
        self.link_baud
    }

    /// The names of the sonars after left, right and front.
    pub fn other_sonars(&self) -> &[String] {
        &self.wires.other_sonars
    }

    pub(super) fn wires(&self) -> &Wires {
        &self.wires
    }
}

/// How a program begins on a chip with nothing attached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Opening {
    /// What it speaks.
    pub language: LinkLanguage,
    /// The USARTs whose transmitter it has switched on; not checked where it sends frames.
    pub transmits: [bool; 4],
}

/// Runs a program for a moment on a chip with nothing attached, and looks for a frame of ours among what it sends.
#[must_use]
pub fn opening(board: &Board, image: &Image) -> Opening {
    let mut chip = Chip::new(image);
    for pin in board.receivers().chain(board.pulled_up()) {
        chip.input(0, Input::Pin(pin, Some(true)));
    }
    chip.pass_boot_loader(LONGEST_BOOT);
    let start = chip.cycle();
    let mut decoders: [Decoder<LINE>; 4] = Default::default();
    // In slices, so that output is seen soon.
    for slice in 1..=10 {
        let stopped = chip.run_until(start + slice * BOOT_US / 10 * CYCLES_PER_US);
        for output in chip.take_outputs() {
            let Event::Byte { usart, byte, .. } = output.event else {
                continue;
            };
            let decoder = decoders.get_mut(usize::from(usart));
            let received = decoder.and_then(|decoder| decoder.push(byte as u8));
            if let Some(Received::Frame(body)) = received
                && FromRobot::from_body(&body).is_ok()
            {
                return Opening {
                    language: LinkLanguage::Frames,
                    transmits: [false; 4],
                };
            }
        }
        if matches!(stopped, Stopped::Ended(_)) {
            break;
        }
    }
    // A transmitter that is on holds its idle line high.
    let mut transmits = [false; 4];
    for (transmits, pin) in transmits.iter_mut().zip(board.transmitters()) {
        *transmits = pin.is_some_and(|pin| chip.devices().drive(pin) == Drive::High);
    }
    Opening {
        language: LinkLanguage::Text,
        transmits,
    }
}
