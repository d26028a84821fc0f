//! A robot file: the robot's physics, its sensors' positions, and its control parameters.
//!
//! ```toml
//! title = "The robot of the report"
//! board = "mega"         # or "uno", "nano"; a Mega if it is left out
//! driver = "l298n"       # or another one of `rumbo_sim::drivers`; an L298N if it is left out
//! [rig.final.front]      # one table per rig and sonar
//! x_m = 0.13
//! on_servo = true
//! [wiring.final]         # signal = pin of the board
//! front_echo = 3
//! left_enable = "high"   # an input of the driver that a jumper holds
//! parts.start = { button = 8 }          # and others: [`super::parts`]
//! battery = { pin = "A0", ratio = 2.0 } # a divider to A0, where one is wired
//! [parameters]           # control parameters that differ from their defaults
//! [plant.battery]        # physics; what is left out is nominal
//! open_circuit_v = 7.4
//! ```

use super::error::FileError;
use super::light::read_light_sensors;
use super::line::read_line_sensors;
use super::maxsonar::read_maxsonars;
use super::named::read_named;
use super::obstacle::read_obstacle_sensors;
use super::parameters::read_parameters;
use super::parts::read_parts;
use super::pin::{Wired, read_pin, read_wired};
use super::read::{Allowed, Source, Table};
use super::sonars::{
    read_other_sonars, read_rig, report_unplaced, report_untriggered, report_unwired, signals,
};
use rumbo_control::params::ParamId;
use rumbo_plant::params::Params;
use rumbo_plant::plant::Mounts;
use rumbo_sim::boards::{BOARDS, Board};
use rumbo_sim::drivers::{DRIVERS, Direction, Driver};
use rumbo_sim::wiring::{Divider, Motor, Wiring, is_driver_input};
use std::collections::{BTreeMap, BTreeSet};

/// Ratio of a divider.
pub(super) const RATIO: Allowed = Allowed::new(1.0, 20.0, "1");
/// Rates of a Bluetooth module.
pub(super) const BAUD: Allowed = Allowed::new(1200.0, 1_382_400.0, "count");
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
    /// Its motor driver.
    pub driver: &'static Driver,
    /// The text it was read from, kept for the log's manifest.
    pub text: String,
    /// Physics, from `[plant.*]`: nominal values where the file has none.
    pub plant: Params,
    /// Where the sonars sit, by the name of the rig; none on a robot without sonars. In a pair on one side, `left` is the one in front.
    pub rigs: BTreeMap<String, Mounts>,
    /// The names of its other sonars, as [`Mounts::others`].
    pub other_sonars: Vec<String>,
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
        let board = read_named(&root, "board", &BOARDS, |board| board.name);
        let driver = read_named(&root, "driver", &DRIVERS, |driver| driver.name);
        let mut plant = Params {
            bridge: driver.bridge(),
            ..Params::default()
        };
        for (key, value) in read_plant(&root.table("plant"), "") {
            if let Err(error) = plant.set(&key, value) {
                root.complain_here(&error.to_string());
            }
        }
        let rig = root.table("rig");
        let other_sonars = read_other_sonars(&rig);
        let rigs = named(&rig, |table| read_rig(table, &other_sonars));
        let wirings = named(&root.table("wiring"), |table| {
            read_wiring(table, board, driver, &other_sonars)
        });
        report_unwired(&rig, &other_sonars, wirings.values());
        let parameters = read_parameters(&root.table("parameters"));
        let firmware = read_caps(&root.table("firmware"));
        root.finish();
        source.verdict()?;
        Ok(Self {
            name: name.into(),
            title,
            board,
            driver,
            text: text.into(),
            plant,
            rigs,
            other_sonars,
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
    let disc = ["slots", "edges_per_motor_turn"].map(|key| format!("encoder.{key}"));
    if disc.iter().all(|key| values.contains_key(key)) && values[&disc[0]] > 0.0 {
        table.complain_here(
            "slots counts a disc on the wheel, edges_per_motor_turn one on the motor's shaft: leave one of them out",
        );
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

fn read_wiring(
    table: &Table<'_, '_>,
    board: &'static Board,
    driver: &'static Driver,
    other_sonars: &[String],
) -> Wiring {
    let mut wiring = Wiring {
        board,
        driver,
        battery: read_divider(&table.table("battery"), table.has("battery"), board),
        servo_reversed: table.flag("servo_reversed").is_some_and(|flag| flag.value),
        other_sonars: other_sonars.to_vec(),
        ..Wiring::default()
    };
    let baud = table.number("link_baud", BAUD);
    wiring.link_baud = baud.map(|baud| baud as u32);
    for signal in signals(other_sonars) {
        let signal = signal.as_str();
        if read_motor(table, signal, &mut wiring) {
            continue;
        }
        let Some((line, wired)) = read_wired(table, signal, board, false) else {
            continue;
        };
        let number = match wired {
            Wired::Pin(number) => number,
            Wired::Held(level) => {
                wiring.held.insert(signal.to_owned(), level);
                continue;
            }
        };
        // One pin may feed several inputs of the driver, and some sonars have one line for both.
        let clashes = |other: &str| {
            let inputs = is_driver_input(signal) && is_driver_input(other);
            let sonar = signal.strip_suffix("_echo");
            !inputs && (sonar.is_none() || sonar != other.strip_suffix("_trigger"))
        };
        let mut taken = wiring.pins.iter().filter(|(_, pin)| **pin == number);
        if let Some((other, _)) = taken.find(|(other, _)| clashes(other)) {
            let remedy = format!("{other} is on that pin already: give each signal its own");
            table.complain(signal, line, &board.shown(number), &remedy);
        }
        wiring.pins.insert(signal.to_owned(), number);
    }
    report_unplaced(table, other_sonars);
    read_parts(&table.table("parts"), &mut wiring);
    read_line_sensors(&table.table("line"), &mut wiring);
    read_obstacle_sensors(&table.table("obstacle"), &mut wiring);
    read_light_sensors(&table.table("light"), &mut wiring);
    read_maxsonars(&table.table("maxsonar"), &mut wiring);
    report_untriggered(table, &wiring);
    suits_driver(table, &wiring);
    for (signal, pin) in &wiring.pins {
        if wiring.shield_pins().any(|taken| taken == *pin) {
            table.complain_here(&format!(
                "{signal} = {}: the motor shield has that pin; take another one",
                board.shown(*pin)
            ));
        }
    }
    table.finish();
    wiring
}

/// Reads the motor of a shield that a wheel is on, if the driver is a shield and the signal tells of one.
fn read_motor(table: &Table<'_, '_>, signal: &str, wiring: &mut Wiring) -> bool {
    let Some(shield) = wiring.driver.shield else {
        return false;
    };
    let (side, way) = signal.split_once('_').unwrap_or_default();
    let side = ["left", "right"].iter().position(|known| *known == side);
    let (Some(side), true) = (side, ["forward", "backward"].contains(&way)) else {
        return false;
    };
    let name = match table.is_text(signal) {
        true => table.text(signal),
        false => None,
    };
    let motor = name.as_ref().and_then(|name| shield.motor(&name.value));
    if let Some(number) = motor {
        let reversed = way == "backward";
        if wiring.motors[side]
            .replace(Motor { number, reversed })
            .is_some()
        {
            table.complain_here(&format!(
                "{signal}: a wheel is on one motor; name it {signal} alone if its FORWARD drives {way}"
            ));
        }
    } else if table.has(signal) {
        let (line, value) = name.map_or((0, "a number".into()), |name| (name.line, name.value));
        table.value(signal);
        table.complain(
            signal,
            line,
            &value,
            "must be a motor of the shield, \"M1\" to \"M4\"",
        );
    }
    true
}

/// Reports inputs of the driver that it lacks, and inputs that are missing.
fn suits_driver(table: &Table<'_, '_>, wiring: &Wiring) {
    let driver = wiring.driver;
    let has = |signal: &str| wiring.pins.contains_key(signal) || wiring.held.contains_key(signal);
    if has("standby") && !driver.has_standby {
        table.complain_here(&format!(
            "standby: the {} has no such input; leave it out",
            driver.title
        ));
    }
    for side in ["left", "right"] {
        if has(&format!("{side}_encoder_b")) && !has(&format!("{side}_encoder")) {
            table.complain_here(&format!(
                "{side}_encoder_b is the second output of an encoder, which tells the direction: give {side}_encoder, \
                 the first one, too"
            ));
        }
        let [enable, forward, backward] =
            ["enable", "forward", "backward"].map(|input| format!("{side}_{input}"));
        if has(&enable) && !driver.has_enable {
            table.complain_here(&format!(
                "{enable}: the {} has no such input; its PWM is on {forward} and {backward}",
                driver.title
            ));
        }
        let moves = has(&forward) || has(&backward);
        if moves && driver.has_enable && !has(&enable) {
            table.complain_here(&format!(
                "{enable} is missing, and without it the driver moves nothing: give the pin of its PWM, or \"high\" where \
                 a jumper holds it"
            ));
        }
        let one = match driver.direction {
            Direction::One => Some(("this driver has one direction input", "its high drives")),
            Direction::Pulse => Some(("a servo has one input", "a long pulse drives")),
            Direction::Two | Direction::Motor => None,
        };
        if let (Some((has_one, what)), true, true) = (one, has(&forward), has(&backward)) {
            table.complain_here(&format!(
                "{forward} and {backward}: {has_one}; name it {forward} if {what} forward, else {backward}"
            ));
        }
    }
}

fn read_divider(table: &Table<'_, '_>, wired: bool, board: &Board) -> Option<Divider> {
    let divider = wired.then(|| {
        let ratio = table.required_number("ratio", RATIO);
        let input = read_pin(table, "pin", board, true)? - board.first_analogue;
        Some(Divider { input, ratio })
    });
    table.finish();
    divider.flatten()
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
