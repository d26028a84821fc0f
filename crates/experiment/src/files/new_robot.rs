//! A robot file to start from: a board, a driver and pins as text with comments, and which known robot that looks like.

use super::error::FileError;
use super::{Kind, Library, RobotFile};
use rumbo_sim::boards::Board;
use rumbo_sim::drivers::{Direction, Driver};
use rumbo_sim::wiring::{SIGNALS, Wiring, is_driver_input};
use std::fmt::Write;

/// A driver that is chosen with its enables held by jumpers.
pub const JUMPERS: &str = "-jumpers";
/// Share of the pins from which on a robot looks like another one.
const ALIKE: f64 = 0.5;
/// Name of the wiring and the rig.
const OWN: &str = "own";

/// What is at pins besides motors, sonars and links, by how its name begins: the key of a robot file.
pub const ACCESSORIES: [(&str, &str); 6] = [
    ("line", "line"),
    ("button", "button"),
    ("switch", "switch"),
    ("pot", "potentiometer"),
    ("led", "led"),
    ("buzzer", "buzzer"),
];
/// Says in place of a line sensor that a dark floor is `low` or `high`.
const DARK: &str = "line_dark";
/// Rate of the Bluetooth module in place of a pin \[baud\].
pub const LINK_BAUD: &str = "link_baud";
/// Line sensors are so far apart \[m\].
const PITCH_M: f64 = 0.015;

/// What an accessory is and what it is called: `line_left` is a line sensor `left`.
#[must_use]
pub fn accessory(signal: &str) -> Option<(&'static str, &str)> {
    let (prefix, name) = signal.split_once('_').unwrap_or((signal, signal));
    let (_, kind) = ACCESSORIES.iter().find(|(known, _)| *known == prefix)?;
    Some((kind, name))
}

/// What a robot is made of.
#[derive(Clone, Debug)]
pub struct NewRobot {
    /// Its name.
    pub name: String,
    /// Its board.
    pub board: &'static Board,
    /// Its motor driver.
    pub driver: &'static Driver,
    /// Jumpers hold the driver's enables.
    pub jumpers: bool,
    /// Signals and their pins, as they were given: numbers or names.
    pub pins: Vec<(String, String)>,
}

/// The signals that a robot with such a driver needs to drive, for people; `-` stands for both ways of a direction input.
#[must_use]
pub fn needed(driver: &Driver, jumpers: bool) -> Vec<String> {
    let mut needed = Vec::new();
    for side in ["left", "right"] {
        if driver.has_enable && !jumpers {
            needed.push(format!("{side}_enable"));
        }
        needed.push(format!("{side}_forward"));
        if driver.direction == Direction::Two {
            needed.push(format!("{side}_backward"));
        }
    }
    needed
}

/// What a signal is connected to, for people.
fn meaning(signal: &str, driver: &Driver) -> String {
    let (side, input) = signal.split_once('_').unwrap_or(("", signal));
    match input {
        "enable" => format!("PWM of the {side} motor"),
        "forward" if driver.direction == Direction::One => {
            format!("direction of the {side} motor: high is forward")
        }
        "backward" if driver.direction == Direction::One => {
            format!("direction of the {side} motor: high is backward")
        }
        "forward" => format!("input of the {side} motor whose high drives forward"),
        "backward" => "input of the same whose high drives backward".into(),
        "encoder" => format!("output A of the {side} encoder, or its only one"),
        "encoder_b" => "output B of the same, which tells the direction".into(),
        "trigger" => format!("sonar {side}: Trig"),
        "echo" => format!("sonar {side}: Echo"),
        "tx" if side == "link" => "where the board sends to the Bluetooth module".into(),
        "rx" if side == "link" => "where the board receives from it".into(),
        "tx" | "rx" => "the USB cable".into(),
        "standby" => "low switches both motors off".into(),
        _ => signal.into(),
    }
}

impl NewRobot {
    /// The robot's file.
    #[must_use]
    pub fn text(&self) -> String {
        let Self {
            name,
            board,
            driver,
            ..
        } = self;
        let given = |signal: &str| self.pins.iter().any(|(own, _)| own == signal);
        let mut text = format!(
            "# {name}. Pins are numbers, or names as \"A0\"; docs/sketches.md tells of all keys.\n#\n# Frames: the origin is the \
             middle of the wheels' axis, x forward, y left, angles counter-clockwise from x.\n\ntitle = \"{name} ({}, {})\"\n\
             board = \"{}\"\ndriver = \"{}\"\n",
            board.title, driver.title, board.name, driver.name
        );
        let mut put = |line: String| {
            text.push_str(&line);
            text.push('\n');
        };
        for (sonar, place) in [
            ("front", "x_m = 0.11"),
            ("left", "x_m = 0.05\ny_m = 0.07\nangle_deg = 90"),
            ("right", "x_m = 0.05\ny_m = -0.07\nangle_deg = -90"),
        ] {
            if given(&format!("{sonar}_trigger")) {
                put(format!(
                    "\n# Where that sonar sits: measure it.\n[rig.{OWN}.{sonar}]\n{place}"
                ));
                if sonar == "front" && given("servo") {
                    put("on_servo = true".into());
                }
            }
        }
        put(format!("\n[wiring.{OWN}]"));
        for signal in SIGNALS {
            let held = self.jumpers && signal.ends_with("_enable");
            let pin = self
                .pins
                .iter()
                .find(|(own, _)| own == signal)
                .map(|(_, pin)| pin);
            let value = match (pin, held) {
                (_, true) => "\"high\"".to_owned(),
                (Some(pin), _) if pin.parse::<u8>().is_ok() => pin.clone(),
                (Some(pin), _) => format!("{pin:?}"),
                (None, _) => continue,
            };
            let about = match held {
                true => "its jumper is on".to_owned(),
                false => meaning(signal, driver),
            };
            put(format!("{:24}# {about}", format!("{signal} = {value}")));
        }
        if let Some((_, baud)) = self.pins.iter().find(|(signal, _)| signal == LINK_BAUD) {
            let _ = writeln!(
                text,
                "{:24}# rate of the Bluetooth module",
                format!("link_baud = {baud}")
            );
        }
        text.push_str(&self.accessories());
        let _ = write!(
            text,
            "\n# Measure it. What is left out, motors, friction and sonars, is nominal and not identified.\n[plant.body]\n\
             base_m = 0.13           # between the middles of the tyres\nlength_m = 0.20\nwidth_m = 0.15\ncentre_ahead_m = 0.03\n\n\
             [plant.wheels.left]\nradius_m = 0.0325\n\n[plant.wheels.right]\nradius_m = 0.0325\n"
        );
        if given("left_encoder") || given("right_encoder") {
            text.push_str(
                "\n# A disc on the wheel; of a sensor on the motor's shaft edges_per_motor_turn, and gear_ratio in [plant.motor].\n\
                 [plant.encoder]\nslots = 20\n",
            );
        }
        text
    }

    /// Line sensors, from left to right as they were given, and what a person works or looks at.
    fn accessories(&self) -> String {
        let pin = |pin: &str| match pin.parse::<u8>() {
            Ok(_) => pin.to_owned(),
            Err(_) => format!("{pin:?}"),
        };
        let given = |of_line: bool| {
            let given = self.pins.iter().filter(|(signal, _)| signal != DARK);
            given.filter_map(move |(signal, at)| {
                let (kind, name) = accessory(signal)?;
                ((kind == "line") == of_line).then(|| (kind, name, pin(at), at))
            })
        };
        let dark = self.pins.iter().find(|(signal, _)| signal == DARK);
        let dark = dark.map_or_else(String::new, |(_, level)| format!(", dark = {level:?}"));
        let mut text = String::new();
        let sensors = given(true).count();
        for (index, (_, name, pin, at)) in given(true).enumerate() {
            if index == 0 {
                let _ = write!(
                    text,
                    "\n# Sensors that look down, from left to right: measure where they are. Over a dark floor they are high, unless\n\
                     # dark = \"low\".\n[wiring.{OWN}.line]\n"
                );
            }
            let y_m = PITCH_M * (0.5 * (sensors as f64 - 1.0) - index as f64);
            let analogue = if at.starts_with(['A', 'a']) {
                ", analogue = true"
            } else {
                ""
            };
            let _ = writeln!(
                text,
                "{name} = {{ pin = {pin}, x_m = 0.09, y_m = {y_m:.4}{analogue}{dark} }}"
            );
        }
        for (index, (kind, name, pin, _)) in given(false).enumerate() {
            if index == 0 {
                let _ = write!(
                    text,
                    "\n# To press, to turn and to look at.\n[wiring.{OWN}.parts]\n"
                );
            }
            let _ = writeln!(text, "{name} = {{ {kind} = {pin} }}");
        }
        text
    }

    /// The file, checked.
    ///
    /// # Errors
    /// What is wrong with its pins.
    pub fn checked(&self) -> Result<(String, RobotFile), FileError> {
        let text = self.text();
        let file = RobotFile::parse(&self.name, &format!("{}.toml", self.name), &text)?;
        Ok((text, file))
    }
}

/// What does not suit a wiring's board, though a robot may be built so, a line each.
#[must_use]
pub fn remarks(wiring: &Wiring) -> Vec<String> {
    let Wiring {
        board,
        driver,
        pins,
        ..
    } = wiring;
    let listed = |pins: &[u8]| -> String {
        let pins: Vec<String> = pins.iter().map(|pin| board.shown(*pin)).collect();
        pins.join(", ")
    };
    let mut remarks = Vec::new();
    let modulated = |signal: &str| match driver.has_enable
        && !wiring.held.contains_key(&left_or_right(signal, "enable"))
    {
        true => signal.ends_with("_enable"),
        false => signal.ends_with("_forward") || signal.ends_with("_backward"),
    };
    for (signal, pin) in pins {
        let shown = board.shown(*pin);
        let speed = is_driver_input(signal) && signal != "standby" && modulated(signal);
        if speed && !board.pwm.contains(pin) {
            remarks.push(format!(
                "{signal} = {shown}: no PWM on that pin, so that analogWrite() only switches; PWM is on {}",
                listed(board.pwm)
            ));
        }
        if speed && pins.contains_key("servo") && board.servo_takes.contains(pin) {
            remarks.push(format!(
                "{signal} = {shown}: no PWM there while the Servo library drives a servo, whose timer makes it; take another one of {}",
                listed(board.pwm)
            ));
        }
        if signal.ends_with("_encoder") && !board.interrupts.contains(pin) {
            remarks.push(format!(
                "{signal} = {shown}: attachInterrupt() has none on that pin, only on {}; a pin-change interrupt works",
                listed(board.interrupts)
            ));
        }
        if *pin < 2 && !signal.starts_with("debug") && !signal.starts_with("link") {
            remarks.push(format!("{signal} = {shown}: pins 0 and 1 are the USB cable's; nothing else works on them beside Serial"));
        }
        if signal == "link_rx" && !board.listens(*pin) {
            remarks.push(format!("{signal} = {shown}: SoftwareSerial cannot receive on that pin of the {}; it can on 10 to 13, A8 to A15", board.title));
        }
    }
    remarks
}

/// What a turn of a wheel counts, of a robot with encoders.
#[must_use]
pub fn counted(robot: &RobotFile) -> Option<String> {
    let has = |wiring: &Wiring| {
        wiring
            .pins
            .keys()
            .any(|signal| signal.ends_with("_encoder"))
    };
    robot.wirings.values().any(has).then(|| {
        let edges = match robot.plant.encoder.slots {
            0.0 => robot.plant.encoder.edges_per_motor_turn * robot.plant.motor.gear_ratio,
            slots => 2.0 * slots,
        };
        format!(
            "a turn of a wheel gives {edges} edges on each output of its encoder, half of them rising: [plant.encoder], and \
             gear_ratio in [plant.motor]; the sketch must count with the same"
        )
    })
}

/// The signal of the same side for another input.
fn left_or_right(signal: &str, input: &str) -> String {
    let side = signal.split_once('_').map_or("", |(side, _)| side);
    format!("{side}_{input}")
}

/// A known robot whose pins are like these.
#[derive(Clone, Debug, PartialEq)]
pub struct Alike {
    /// Its name.
    pub robot: String,
    /// Signals that are on the same pins.
    pub same: usize,
    /// Signals that both have.
    pub of: usize,
    /// Those that are elsewhere there, each with its pin there.
    pub others: Vec<(String, String)>,
}

/// The known robot that a wiring looks like most, if there is one.
///
/// # Errors
/// A robot of ours that cannot be read.
pub fn looks_like(library: &Library, wiring: &Wiring) -> Result<Option<Alike>, FileError> {
    let mut best: Option<Alike> = None;
    for name in library.list(Kind::Robot) {
        let robot = library.robot(&name)?;
        if robot.board.chip != wiring.board.chip {
            continue;
        }
        for own in robot.wirings.values() {
            let alike = compare(&name, wiring, own);
            let share = alike.same as f64 / alike.of.max(1) as f64;
            let better = best.as_ref().is_none_or(|best| alike.same > best.same);
            if share >= ALIKE && alike.same > 2 && better {
                best = Some(alike);
            }
        }
    }
    Ok(best)
}

fn compare(name: &str, wiring: &Wiring, own: &Wiring) -> Alike {
    let motors = |signal: &&String| !signal.starts_with("debug");
    let both = wiring
        .pins
        .keys()
        .filter(motors)
        .filter(|signal| own.pins.contains_key(*signal));
    let (same, others): (Vec<&String>, Vec<&String>) =
        both.partition(|signal| wiring.pins[*signal] == own.pins[*signal]);
    Alike {
        robot: name.to_owned(),
        same: same.len(),
        of: same.len() + others.len(),
        others: others
            .into_iter()
            .map(|signal| (signal.clone(), own.board.shown(own.pins[signal])))
            .collect(),
    }
}
