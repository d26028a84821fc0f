//! A robot file: the robot's physics, its sensors' positions, and its control parameters.
//!
//! ```toml
//! title = "The robot of the report"
//! board = "mega"         # or "uno"; a Mega if it is left out
//! [rig.final.front]      # one table per rig and sonar
//! x_m = 0.13
//! on_servo = true
//! [wiring.final]         # signal = pin of the board
//! front_echo = 3
//! battery = { pin = 54, ratio = 2.0 }   # a divider to A0, where one is wired
//! [parameters]           # control parameters that differ from their defaults
//! [plant.battery]        # physics; what is left out is nominal
//! open_circuit_v = 7.4
//! ```

use super::error::{FileError, did_you_mean};
use super::parameters::read_parameters;
use super::read::{Allowed, Source, Table};
use super::value::ANGLE;
use rumbo_control::params::ParamId;
use rumbo_plant::params::Params;
use rumbo_plant::plant::{Mount, Rig};
use rumbo_sim::boards::{BOARDS, Board};
use rumbo_sim::wiring::{Divider, SIGNALS, Wiring};
use std::collections::{BTreeMap, BTreeSet};

/// Position of a sonar on the body.
const MOUNT: Allowed = Allowed::new(-1.0, 1.0, "m");
/// Ratio of a divider.
const RATIO: Allowed = Allowed::new(1.0, 20.0, "1");
/// Flash and SRAM of an ATmega2560.
const FLASH: Allowed = Allowed::new(1.0, 256.0 * 1024.0, "count");
const SRAM: Allowed = Allowed::new(1.0, 8.0 * 1024.0, "count");

/// A robot, as `robots/*.toml` describes it.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotFile {
    /// Its name in scenarios and commands: the file's name without `.toml`.
    pub name: String,
    /// One line for people.
    pub title: String,
    /// What its programs run on.
    pub board: &'static Board,
    /// The text it was read from, kept for the log's manifest.
    pub text: String,
    /// Physics, from `[plant.*]`: nominal values where the file has none.
    pub plant: Params,
    /// Where the sonars sit, by the name of the rig. At least one. In a pair on one side, `left` is the one in front.
    pub rigs: BTreeMap<String, Rig>,
    /// Which signal is on which pin, by the name of the wiring.
    pub wirings: BTreeMap<String, Wiring>,
    /// Control parameters that differ from their defaults, from `[parameters]`; sent to the robot before arming.
    pub parameters: Vec<(ParamId, f32)>,
    /// The firmware's limits on the chip.
    pub firmware: FirmwareCaps,
}

/// Maximum size of an image, from `[firmware]`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FirmwareCaps {
    /// Flash, in bytes.
    pub flash_bytes: u32,
    /// Static SRAM, in bytes.
    pub sram_bytes: u32,
}

impl Default for FirmwareCaps {
    fn default() -> Self {
        Self {
            flash_bytes: 128 * 1024,
            sram_bytes: 3 * 1024,
        }
    }
}

impl RobotFile {
    /// Reads a robot.
    ///
    /// # Errors
    /// All problems of the text, by line of `file`.
    pub fn parse(name: &str, file: &str, text: &str) -> Result<Self, FileError> {
        let source = Source::new(file, text);
        let parsed = source.parse()?;
        let root = source.root(&parsed);
        let title = root
            .required_text("title", "one line that says what the robot is")
            .value;
        let board = read_board(&root);
        let mut plant = Params::default();
        for (key, value) in read_plant(&root.table("plant"), "") {
            if let Err(error) = plant.set(&key, value) {
                root.complain_here(&error.to_string());
            }
        }
        let rigs = named(&root.table("rig"), read_rig);
        if rigs.is_empty() {
            root.complain_here("has no rig: add a table [rig.NAME.front] (or left, right) with x_m, y_m, angle_deg");
        }
        let wirings = named(&root.table("wiring"), |table| read_wiring(table, board));
        let parameters = read_parameters(&root.table("parameters"));
        let firmware = read_caps(&root.table("firmware"));
        root.finish();
        source.verdict()?;
        Ok(Self {
            name: name.into(),
            title,
            board,
            text: text.into(),
            plant,
            rigs,
            wirings,
            parameters,
            firmware,
        })
    }
}

/// The tables below `table`, whose keys are names.
fn named<T>(table: &Table<'_, '_>, read: impl Fn(&Table<'_, '_>) -> T) -> BTreeMap<String, T> {
    table
        .keys()
        .into_iter()
        .map(|key| (key.value.to_owned(), read(&table.table(key.value))))
        .collect()
}

/// The plant's values in a table, by dotted key; `prefix` is the path of the table, e.g. `wheels.left.`.
pub(crate) fn read_plant(table: &Table<'_, '_>, prefix: &str) -> BTreeMap<String, f64> {
    let (mut values, mut sections) = (BTreeMap::new(), BTreeSet::new());
    for limit in Params::limits() {
        let Some(below) = limit.key.strip_prefix(prefix) else {
            continue;
        };
        if let Some((section, _)) = below.split_once('.') {
            sections.insert(section.to_owned());
        } else if let Some(value) =
            table.number(below, Allowed::new(limit.min, limit.max, limit.unit))
        {
            values.insert(limit.key, value);
        }
    }
    for section in sections {
        values.extend(read_plant(
            &table.table(&section),
            &format!("{prefix}{section}."),
        ));
    }
    table.finish();
    values
}

fn read_rig(table: &Table<'_, '_>) -> Rig {
    let mount = |sonar| {
        let mount = table.table(sonar);
        let place = Mount {
            x_m: mount.required_number("x_m", MOUNT),
            y_m: mount.number("y_m", MOUNT).unwrap_or(0.0),
            angle_rad: mount.number("angle_deg", ANGLE).unwrap_or(0.0).to_radians(),
            on_servo: mount.flag("on_servo").is_some_and(|flag| flag.value),
        };
        mount.finish();
        table.has(sonar).then_some(place)
    };
    let rig = Rig {
        left: mount("left"),
        right: mount("right"),
        front: mount("front"),
    };
    table.finish();
    rig
}

fn read_board(root: &Table<'_, '_>) -> &'static Board {
    let Some(name) = root.text("board") else {
        return <&Board>::default();
    };
    Board::named(&name.value).unwrap_or_else(|| {
        let known: Vec<String> = BOARDS.map(|board| board.name.to_owned()).into();
        root.complain("board", name.line, &name.value, &did_you_mean(&known));
        <&Board>::default()
    })
}

fn read_wiring(table: &Table<'_, '_>, board: &'static Board) -> Wiring {
    let mut wiring = Wiring {
        board,
        battery: read_divider(&table.table("battery"), table.has("battery"), board),
        ..Wiring::default()
    };
    let pins = Allowed::new(0.0, board.last_pin().into(), "count");
    for signal in SIGNALS {
        let Some(pin) = table.placed_number(signal, pins) else {
            continue;
        };
        let number = pin.value as u8;
        if let Some((other, _)) = wiring.pins.iter().find(|(_, taken)| **taken == number) {
            let remedy = format!("{other} is on that pin already: give each signal its own");
            table.complain(signal, pin.line, &number.to_string(), &remedy);
        }
        wiring.pins.insert(signal.to_owned(), number);
    }
    table.finish();
    wiring
}

fn read_divider(table: &Table<'_, '_>, wired: bool, board: &Board) -> Option<Divider> {
    let (first, last) = (board.first_analogue.into(), board.last_pin().into());
    let pins = Allowed::new(first, last, "count");
    let divider = wired.then(|| Divider {
        input: (table.required_number("pin", pins) - first) as u8,
        ratio: table.required_number("ratio", RATIO),
    });
    table.finish();
    divider
}

fn read_caps(table: &Table<'_, '_>) -> FirmwareCaps {
    let caps = FirmwareCaps::default();
    let bytes = |key, allowed, otherwise| {
        table
            .number(key, allowed)
            .map_or(otherwise, |bytes| bytes as u32)
    };
    let caps = FirmwareCaps {
        flash_bytes: bytes("flash_bytes", FLASH, caps.flash_bytes),
        sram_bytes: bytes("sram_bytes", SRAM, caps.sram_bytes),
    };
    table.finish();
    caps
}
