//! A program image for the Mega: what it is, which language it speaks on its link, and the wiring that it is for.

use super::CYCLES_PER_US;
use super::pins::{Wires, board_signals, chip_pin};
use crate::files::bounded::read_at_most;
use crate::files::{FileError, RobotFile, ScenarioFile, Wiring};
use rumbo_control::mode::ModeId;
use rumbo_emulator::chip::Chip;
use rumbo_emulator::cpu::Stopped;
use rumbo_emulator::devices::ports::Drive;
use rumbo_emulator::devices::ports::Pin;
use rumbo_emulator::devices::{Event, Input};
use rumbo_emulator::image::Image;
use rumbo_wire::{Decoder, FromRobot, Message, Received};
use std::io;
use std::path::Path;

/// Rate of the Bluetooth module [baud].
pub const LINK_BAUD: f64 = 9600.0;
/// Receiving and transmitting pins of the USARTs on the board.
const RECEIVERS: [u8; 4] = [0, 19, 17, 15];
const TRANSMITTERS: [u8; 4] = [1, 18, 16, 14];
/// Longest file of an image, with all that a debugger wants to know [bytes].
const LONGEST: u64 = 16 << 20;
/// Our program says HELLO as soon as it runs; this long is waited for it [us].
const BOOT_US: u64 = 600_000;
/// A boot loader has handed over after this [cycles], or never will.
pub(super) const LONGEST_BOOT: u64 = 5_000_000 * CYCLES_PER_US;
/// Room for what a robot says at once.
const LINE: usize = 128;

/// What a program speaks on its link.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Language {
    /// The frames of docs/protocol.md.
    Frames,
    /// The original's lines of text, or nothing.
    Text,
}

/// A program with all that is known of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Firmware {
    name: String,
    image: Image,
    language: Language,
    wiring: String,
    wires: Wires,
}

impl Firmware {
    /// Reads an image, listens to how it begins, and wires it: as `wiring` says, or else as the language and the scenario
    /// suggest.
    ///
    /// # Errors
    /// The file is no program for this chip, or the robot has no such wiring.
    pub fn load(
        path: &Path,
        wiring: Option<&str>,
        robot: &RobotFile,
        scenario: &ScenarioFile,
    ) -> Result<Self, FileError> {
        let image = read(path)?;
        let name = path.file_name().map_or_else(
            || path.display().to_string(),
            |name| name.to_string_lossy().into_owned(),
        );
        let (language, transmits) = begin(&image);
        let wiring = match wiring {
            Some(wiring) => wiring.to_owned(),
            None => default_wiring(language, transmits, robot, scenario),
        };
        let wires = Wires::new(&wiring, find(robot, &wiring)?)?;
        Ok(Self {
            name,
            image,
            language,
            wiring,
            wires,
        })
    }

    /// The file's name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The program.
    pub fn image(&self) -> &Image {
        &self.image
    }

    /// Names for pins: the wired ones by what they are for, and all of the board by their numbers.
    pub fn signals(&self) -> Vec<(String, Pin)> {
        let mut signals = self.wires.signals();
        signals.extend(board_signals());
        signals
    }

    /// What it speaks on its link.
    pub fn language(&self) -> Language {
        self.language
    }

    /// Name of the wiring.
    pub fn wiring(&self) -> &str {
        &self.wiring
    }

    /// The USART that the Bluetooth module is on, if the wiring has one.
    pub fn link_usart(&self) -> Option<u8> {
        self.wires.link
    }

    pub(super) fn wires(&self) -> &Wires {
        &self.wires
    }
}

/// Reads an image.
///
/// # Errors
/// The file is no program for this chip.
pub fn read(path: &Path) -> Result<Image, FileError> {
    let bytes = bytes(path)?;
    let shown = path.display();
    Image::parse(&bytes).map_err(|error| FileError::Setting(format!("firmware {shown}: {error}")))
}

/// The bytes of an image's file.
///
/// # Errors
/// No file of a size that an image can have.
pub fn bytes(path: &Path) -> Result<Vec<u8>, FileError> {
    let read = std::fs::metadata(path).and_then(|about| match about.is_file() {
        true => read_at_most(path, LONGEST),
        false => Err(io::Error::other("no file")),
    });
    read.map_err(|error| {
        let shown = path.display();
        FileError::Setting(format!("firmware {shown}: cannot be read ({error}); give the .elf or .hex that the compiler made"))
    })
}

fn find<'a>(robot: &'a RobotFile, wiring: &str) -> Result<&'a Wiring, FileError> {
    robot.wirings.get(wiring).ok_or_else(|| FileError::Unknown {
        kind: "wiring",
        name: wiring.to_owned(),
        near: robot.wirings.keys().cloned().collect(),
    })
}

/// Our program knows the final build only; of another one, the report's build for this experiment. If the program has not
/// switched on the transmitter of that build's link, but that of another build's: that one.
fn default_wiring(
    language: Language,
    transmits: [bool; 4],
    robot: &RobotFile,
    scenario: &ScenarioFile,
) -> String {
    let name = match (language, scenario.rig.as_str(), scenario.mode) {
        (Language::Frames, ..) => "final",
        (_, "front_single", ModeId::FrontDistance) => "mode_1",
        (_, "front_pair" | "side_pair_left" | "side_pair_right", _) => "modes_2_to_4",
        (_, _, ModeId::WheelSpeed | ModeId::StraightLine | ModeId::Waypoints | ModeId::Manual) => {
            "modes_5_to_7"
        }
        _ => "final",
    };
    let fits = |name: &str| {
        let wiring = robot.wirings.get(name);
        let wires = wiring.and_then(|wiring| Wires::new(name, wiring).ok());
        let link = wires.and_then(|wires| wires.link);
        link.is_some_and(|usart| transmits[usize::from(usart)])
    };
    let mut names = robot.wirings.keys();
    let found = match names.len() {
        0 | 1 => names.next(),
        _ if fits(name) => None,
        _ => names.find(|other| fits(other)),
    };
    found.map_or_else(|| name.to_owned(), Clone::clone)
}

/// Lets a chip with nothing attached begin, looks for a frame of ours among what it sends, and for the USARTs whose transmitter is on.
fn begin(image: &Image) -> (Language, [bool; 4]) {
    let mut chip = Chip::new(image);
    for pin in RECEIVERS.into_iter().filter_map(chip_pin) {
        chip.input(0, Input::Pin(pin, Some(true)));
    }
    chip.pass_boot_loader(LONGEST_BOOT);
    let start = chip.cycle();
    let mut decoders: [Decoder<LINE>; 4] = Default::default();
    // In slices, so that what is said is seen soon.
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
                return (Language::Frames, [false; 4]);
            }
        }
        if matches!(stopped, Stopped::Ended(_)) {
            break;
        }
    }
    // A transmitter that is on holds its idle line high.
    let transmits = TRANSMITTERS.map(|number| {
        let pin = chip_pin(number);
        pin.is_some_and(|pin| chip.devices().drive(pin) == Drive::High)
    });
    (Language::Text, transmits)
}
