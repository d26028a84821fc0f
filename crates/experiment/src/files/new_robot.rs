//! A robot file to start from: a board, a driver and pins as text with comments, and which known robot that looks like.

use super::error::FileError;
use super::new_plant::{encoder, plant};
use super::new_sensors::{
    line_sensors, obstacle_sensors, place_of, quoted, signals, sonars, usual_place,
};
use super::{Kind, Library, RobotFile};
use rumbo_sim::boards::Board;
use rumbo_sim::drivers::{Direction, Driver};
use rumbo_sim::wiring::{Wiring, is_driver_input};

pub use super::new_plant::{GearMotor, MOTORS, Measured, counted};
pub use super::new_sensors::{LINE, OBSTACLE, PITCH, SHARP};
pub use super::sonars::is_of_sonar;

/// A driver that is chosen with its enables held by jumpers.
pub const JUMPERS: &str = "-jumpers";
/// Share of the pins from which on a robot looks like another one.
const ALIKE: f64 = 0.5;
/// Name of the wiring and the rig.
const OWN: &str = "own";

/// Rate of the Bluetooth module in place of a pin \[baud\].
pub const LINK_BAUD: &str = "link_baud";
/// In place of a pin, the angle of `servo.write()` at which the servo looks ahead, where that is not 90 \[deg\].
pub const SERVO_AHEAD: &str = "servo_ahead";
/// In place of a pin, `true` where a servo is mounted the other way round and looks to the left at 0.
pub const SERVO_REVERSED: &str = "servo_reversed";

/// The analogue input with the battery's divider, and what the divider divides by, among the pins.
pub const BATTERY: [&str; 2] = ["battery", "battery_ratio"];

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
    /// It has four wheels, the two of a side driven alike.
    pub four_wheels: bool,
    /// Where sensors sit and look, where that is not the usual place: x and y \[m\], and the direction \[deg\].
    pub sensors: Vec<(String, [f64; 3])>,
    /// What is known of its body.
    pub measured: Measured,
    /// Parts: name, kind, and pin or address.
    pub parts: Vec<[String; 3]>,
}

/// The signals that a robot with such a driver needs to drive, for people; `-` stands for both ways of a direction input.
#[must_use]
pub fn needed(driver: &Driver, jumpers: bool) -> Vec<String> {
    let mut needed = Vec::new();
    for side in ["left", "right"] {
        if driver.has_enable && !jumpers {
            needed.push(format!("{side}_enable"));
        }
        // The servos of a robot look away from each other.
        let mirrored = driver.direction == Direction::Pulse && side == "right";
        needed.push(format!(
            "{side}_{}",
            if mirrored { "backward" } else { "forward" }
        ));
        if driver.direction == Direction::Two {
            needed.push(format!("{side}_backward"));
        }
    }
    needed
}

/// What a signal is connected to, for people.
#[must_use]
pub fn meaning(signal: &str, driver: &Driver) -> String {
    let (side, input) = match is_of_sonar(signal) {
        true => signal.rsplit_once('_'),
        false => signal.split_once('_'),
    }
    .unwrap_or(("", signal));
    match input {
        "enable" => format!("PWM of the {side} motor"),
        "forward" if driver.direction == Direction::Motor => {
            format!("motor of the {side} wheel: FORWARD drives it forward")
        }
        "backward" if driver.direction == Direction::Motor => {
            format!("motor of the {side} wheel: FORWARD drives it backward")
        }
        "forward" | "backward" if driver.direction == Direction::Pulse => {
            format!("servo of the {side} wheel: longer pulses drive it {input}")
        }
        "forward" if driver.direction == Direction::One => {
            format!("direction of the {side} motor: high is forward")
        }
        "backward" if driver.direction == Direction::One => {
            format!("direction of the {side} motor: high is backward")
        }
        "forward" => format!("input of the {side} motor whose high drives forward"),
        "backward" => "input of the same whose high drives backward".into(),
        "encoder" => format!("output A of the {side} encoder, or its only one"),
        "fault" => format!("low where something is wrong with the {side} motor"),
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

/// The keys of a remote control by their codes, as `left=0x20DF1BE4:right=551525220`; behind `raw:` in the other order.
fn own_remote(codes: &str) -> String {
    let (table, codes) = match codes.strip_prefix("raw:") {
        Some(codes) => ("raw_keys", codes),
        None => ("keys", codes),
    };
    let is_bare = |key: &str| {
        key.chars()
            .all(|c| c.is_ascii_alphanumeric() || "-_".contains(c))
    };
    let entry = |code: &str| match code.split_once('=') {
        Some((key, bits)) if is_bare(key) => format!("{key} = {bits}"),
        Some((key, bits)) => format!("{key:?} = {bits}"),
        None => code.to_owned(),
    };
    let codes: Vec<String> = codes.split(':').map(entry).collect();
    format!(", {table} = {{ {} }}", codes.join(", "))
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
        for sonar in sonars(&self.pins) {
            let [x_m, y_m, mut angle_deg] = self.place_of(sonar).unwrap_or_default();
            let on_servo = sonar == "front" && given("servo");
            if on_servo {
                angle_deg += self.servo_askew_deg();
            }
            put(format!(
                "\n# Where that sonar sits: measure it.\n[rig.{OWN}.{sonar}]\nx_m = {x_m}"
            ));
            if [y_m, angle_deg] != [0.0; 2] {
                put(format!("y_m = {y_m}\nangle_deg = {angle_deg}"));
            }
            if on_servo {
                put("on_servo = true".into());
            }
        }
        put(format!("\n[wiring.{OWN}]"));
        for signal in signals(&self.pins) {
            let signal = signal.as_str();
            let held = self.jumpers && signal.ends_with("_enable");
            let pin = self.said(signal);
            let value = match (pin, held) {
                (_, true) => "\"high\"".to_owned(),
                (Some(pin), _) => quoted(pin),
                (None, _) => continue,
            };
            let about = match held {
                true => "its jumper is on".to_owned(),
                false => meaning(signal, driver),
            };
            put(format!("{:23} # {about}", format!("{signal} = {value}")));
        }
        let said = [
            (LINK_BAUD, "rate of the Bluetooth module"),
            (SERVO_REVERSED, "it looks to the left at 0"),
        ];
        for (key, about) in said {
            if let Some(value) = self.said(key) {
                put(format!("{:23} # {about}", format!("{key} = {value}")));
            }
        }
        if let [Some(pin), ratio] = BATTERY.map(|signal| self.said(signal)) {
            let ratio = ratio.unwrap_or("2");
            put(format!(
                "battery = {{ pin = {}, ratio = {ratio} }}  # the battery's voltage, divided by that",
                quoted(pin)
            ));
        }
        for [name, kind, place] in &self.parts {
            let (place, more) = place.split_once(':').unwrap_or((place, ""));
            let number = match place.strip_prefix("0x") {
                Some(digits) => u8::from_str_radix(digits, 16),
                None => place.parse(),
            };
            let place = match number {
                Ok(_) => place.to_owned(),
                Err(_) => format!("{place:?}"),
            };
            // What else such a part may say.
            let more = match (more, kind.as_str()) {
                ("", _) => String::new(),
                (codes, "infrared") if codes.contains('=') => own_remote(codes),
                (keys, "infrared") => format!(", keys = {}", quoted(keys)),
                (to, "button" | "switch") => format!(", to = {to:?}"),
                (size, _) => format!(", size = {size:?}"),
            };
            put(format!("parts.{name} = {{ {kind} = {place}{more} }}"));
        }
        text.push_str(&line_sensors(OWN, &self.pins, &self.sensors));
        text.push_str(&obstacle_sensors(OWN, &self.pins, &self.sensors));
        text.push_str(&plant(driver, self.four_wheels, &self.measured));
        if given("left_encoder") || given("right_encoder") {
            text.push_str(&encoder(&self.measured));
        }
        text
    }

    /// Where a sonar is, as somebody or its name says.
    fn place_of(&self, sonar: &str) -> Option<[f64; 3]> {
        place_of(&self.sensors, sonar).or_else(|| usual_place(sonar))
    }

    /// What stands in place of the pin of a signal.
    fn said(&self, key: &str) -> Option<&str> {
        let mut pins = self.pins.iter();
        pins.find(|(signal, _)| signal == key)
            .map(|(_, value)| value.as_str())
    }

    /// Where what is on the servo looks at 90, as it looks ahead at another angle.
    fn servo_askew_deg(&self) -> f64 {
        let ahead_deg = self.said(SERVO_AHEAD).and_then(|deg| deg.parse().ok());
        let askew_deg = 90.0 - ahead_deg.unwrap_or(90.0);
        match self.said(SERVO_REVERSED) {
            Some("true") => -askew_deg,
            _ => askew_deg,
        }
    }

    /// The file, checked.
    ///
    /// # Errors
    /// What is wrong with its pins.
    pub fn checked(&self) -> Result<(String, RobotFile), FileError> {
        let sonars = sonars(&self.pins);
        if let Some(sonar) = sonars.iter().find(|sonar| self.place_of(sonar).is_none()) {
            return Err(FileError::Setting(format!(
                "{sonar}_trigger: its name does not say where that sonar is, as rear or front_left do; say it, --sensors \
                 {sonar}=0.1:0.03:20, x and y in m, and where it looks in degrees, positive to the left"
            )));
        }
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
        let analogue = driver.direction != Direction::Pulse && signal != "standby";
        let speed = analogue && is_driver_input(signal) && modulated(signal);
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
