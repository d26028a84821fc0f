//! What may be said of a new robot besides its wires: one table, of which options, questions at a terminal and the page's
//! fields are made. Whatever nobody says has a usual value, which is told.

use super::light::{ILLUMINANCE, RESISTANCE};
use super::line::SUPPLY;
use super::obstacle::REACH;
use super::robot::{BAUD, RATIO};
use super::value::Allowed;

/// How the name of a line sensor begins among the pins, before a name of its own.
pub(super) const LINE: &str = "line_";
/// How the name of an infrared switch for obstacles begins.
pub(super) const OBSTACLE: &str = "obstacle_";
/// How that of a Sharp begins, which gives a voltage.
pub(super) const SHARP: &str = "sharp_";
/// How that of a light sensor begins, and that of a MaxSonar.
pub(super) const LIGHT: &str = "light_";
pub(super) const MAXSONAR: &str = "maxsonar_";
/// The signal of an analogue input with a divider of the battery's voltage.
pub const BATTERY: &str = "battery";

/// An answer that may be given, and what it is called.
type Named = (&'static str, &'static str);

/// What may be answered.
#[derive(Debug)]
enum Answer {
    /// One of these.
    Choice(&'static [Named]),
    /// A number, of a count an even one.
    Number(Allowed),
}

/// What it is asked of.
#[derive(Debug)]
enum Of {
    /// Any robot.
    Body,
    /// A robot whose motors are chosen.
    Motors,
    /// One with an encoder.
    Encoder,
    /// One with a signal of this name, or that begins so.
    Signal(&'static str),
    /// One with such a signal on an analogue input.
    Analogue(&'static str),
}

/// Something that may be said of a new robot.
#[derive(Debug)]
pub struct Asked {
    /// Its name in options and among the pins.
    pub key: &'static str,
    /// What a field of a form is called.
    pub label: &'static str,
    /// A sentence for who wonders what that is.
    pub about: &'static str,
    answer: Answer,
    of: Of,
}

/// Rate of the Bluetooth module in place of a pin \[baud\].
pub(super) const LINK_BAUD: &str = "link_baud";
/// In place of a pin, the angle of `servo.write()` at which the servo looks ahead, where that is not 90 \[deg\].
pub(super) const SERVO_AHEAD: &str = "servo_ahead";
/// In place of a pin, `true` where a servo is mounted the other way round and looks to the left at 0.
pub(super) const SERVO_REVERSED: &str = "servo_reversed";
/// What the divider of the battery's voltage divides by.
pub(super) const BATTERY_RATIO: &str = "battery_ratio";
/// That of two resistors alike.
pub(super) const USUAL_RATIO: &str = "2";

/// How far line sensors are apart.
pub(super) const LINE_PITCH: &str = "line_pitch_m";
/// The speed that somebody measured.
pub(super) const TOP_SPEED: &str = "top-speed";
/// Wheels and motors, on which other usual values depend.
pub(super) const WHEELS: &str = "wheels";
pub(super) const MOTOR: &str = "motor";
/// The encoders' count, an option though it is asked only where there are some.
pub(super) const EDGES: &str = "edges";

const YES_NO: Answer = Answer::Choice(&[("false", "no"), ("true", "yes")]);
const LEVELS: Answer = Answer::Choice(&[("high", "high"), ("low", "low")]);
/// From one line sensor to the next.
const PITCH: Allowed = Allowed::new(0.003, 0.1, "m");
const VOLTS: Answer = Answer::Number(SUPPLY);

/// The whole list: what belongs to the body first, each an option of `new robot`; then what stands in place of pins.
/// In their order they are asked.
pub static ASKED: [Asked; 23] = [
    Asked {
        key: WHEELS,
        label: "wheels",
        about: "2 and a castor, or 4, the two of a side driven alike; tracks are 4",
        answer: Answer::Choice(&[("2", "two and a castor"), ("4", "four, or tracks")]),
        of: Of::Body,
    },
    Asked {
        key: MOTOR,
        label: "motors",
        about: "tt are the yellow ones; n20, 6 V, and 25d, 12 V, have gears of metal, and encoders fit",
        answer: Answer::Choice(&[
            ("tt", "TT, yellow, 1:48"),
            ("n20", "N20, 6 V, 1:100"),
            ("25d", "25 mm, 12 V, 1:75"),
        ]),
        of: Of::Motors,
    },
    Asked {
        key: "battery",
        label: "battery",
        about: "Voltage of the battery: 6 of four AA cells, 7.4 or 11.1 of Li-ion ones",
        answer: Answer::Number(Allowed::new(5.6, 12.0, "V")),
        of: Of::Body,
    },
    Asked {
        key: TOP_SPEED,
        label: "speed at full PWM",
        about: "Speed on the floor at full PWM, by tape and clock: the motors get the gears that reach it",
        answer: Answer::Number(Allowed::new(0.02, 3.0, "m/s")),
        of: Of::Body,
    },
    Asked {
        key: "base",
        label: "between the tyres",
        about: "Between the middles of the tyres",
        answer: Answer::Number(Allowed::new(0.03, 0.9, "m")),
        of: Of::Body,
    },
    Asked {
        key: "wheel",
        label: "diameter of the wheels",
        about: "Diameter of the wheels",
        answer: Answer::Number(Allowed::new(0.01, 0.4, "m")),
        of: Of::Body,
    },
    Asked {
        key: EDGES,
        label: "edges in a turn of a wheel",
        about: "Edges of an encoder's output in a turn of the wheel, half of them rising: 748 of 11 pulses behind gears of 34:1",
        answer: Answer::Number(Allowed::new(2.0, 8000.0, "count")),
        of: Of::Encoder,
    },
    Asked {
        key: SERVO_AHEAD,
        label: "servo looks ahead at",
        about: "The angle of servo.write() at which the servo looks ahead",
        answer: Answer::Number(Allowed::new(0.0, 180.0, "deg")),
        of: Of::Signal("servo"),
    },
    Asked {
        key: SERVO_REVERSED,
        label: "servo reversed",
        about: "Mounted the other way round, it looks to the left at 0",
        answer: YES_NO,
        of: Of::Signal("servo"),
    },
    Asked {
        key: LINK_BAUD,
        label: "rate of the Bluetooth module",
        about: "What the sketch begins its port with",
        answer: Answer::Number(BAUD),
        of: Of::Signal("link_rx"),
    },
    Asked {
        key: BATTERY_RATIO,
        label: "divider of the battery",
        about: "What the divider divides the battery's voltage by",
        answer: Answer::Number(RATIO),
        of: Of::Signal(BATTERY),
    },
    Asked {
        key: "line_dark",
        label: "over a dark floor",
        about: "The level of the line sensors over a dark floor",
        answer: LEVELS,
        of: Of::Signal(LINE),
    },
    Asked {
        key: "line_rc",
        label: "QTR-RC",
        about: "Line sensors that the program charges: QTR-RC, Zumo",
        answer: YES_NO,
        of: Of::Signal(LINE),
    },
    Asked {
        key: "line_light_v",
        label: "voltage over a light floor",
        about: "Of line sensors on analogue inputs, measured",
        answer: VOLTS,
        of: Of::Analogue(LINE),
    },
    Asked {
        key: "line_dark_v",
        label: "voltage over a dark floor",
        about: "Of line sensors on analogue inputs, measured",
        answer: VOLTS,
        of: Of::Analogue(LINE),
    },
    Asked {
        key: LINE_PITCH,
        label: "from one line sensor to the next",
        about: "Between their middles: 0.0095 m of a QTR-8",
        answer: Answer::Number(PITCH),
        of: Of::Signal(LINE),
    },
    Asked {
        key: "obstacle_seen",
        label: "before an obstacle",
        about: "The level of the infrared switches before an obstacle",
        answer: LEVELS,
        of: Of::Signal(OBSTACLE),
    },
    Asked {
        key: "obstacle_reach_m",
        label: "reach of the switches",
        about: "How near a thing is that the infrared switches see",
        answer: Answer::Number(REACH),
        of: Of::Signal(OBSTACLE),
    },
    Asked {
        key: "sharp_model",
        label: "Sharps",
        about: "Infrared sensors that give a voltage: 10 to 80 cm, 20 to 150 cm, or 4 to 30 cm",
        answer: Answer::Choice(&[
            ("gp2y0a21", "GP2Y0A21YK"),
            ("gp2y0a02", "GP2Y0A02YK"),
            ("gp2y0a41", "GP2Y0A41SK"),
        ]),
        of: Of::Signal(SHARP),
    },
    Asked {
        key: "light_bright",
        label: "in bright light",
        about: "The light sensors give more or less in bright light: a photoresistor at 5 V more, at GND less",
        answer: LEVELS,
        of: Of::Signal(LIGHT),
    },
    Asked {
        key: "light_resistor_kohm",
        label: "resistor of the divider",
        about: "The resistor that makes a divider with the photoresistor",
        answer: Answer::Number(RESISTANCE),
        of: Of::Analogue(LIGHT),
    },
    Asked {
        key: "light_rated_kohm",
        label: "photoresistor at 10 lx",
        about: "Resistance of the photoresistors at 10 lx: 10 to 20 of a GL5528",
        answer: Answer::Number(RESISTANCE),
        of: Of::Signal(LIGHT),
    },
    Asked {
        key: "light_switch_lux",
        label: "modules switch at",
        about: "Light sensors with a comparator: where their trimmer stands",
        answer: Answer::Number(ILLUMINANCE),
        of: Of::Signal(LIGHT),
    },
];

impl Asked {
    /// Whether it is an option of its own, and stands in place of no pin.
    #[must_use]
    pub fn is_option(&self) -> bool {
        matches!(self.of, Of::Body | Of::Motors | Of::Encoder)
    }

    /// What may be chosen from, each by its name with what it is called; nothing where a number is asked.
    #[must_use]
    pub fn choices(&self) -> &'static [Named] {
        match self.answer {
            Answer::Choice(choices) => choices,
            Answer::Number(_) => &[],
        }
    }

    /// Smallest and largest number, and their unit; none where something is chosen.
    #[must_use]
    pub fn range(&self) -> Option<(f64, f64, &'static str)> {
        match self.answer {
            Answer::Choice(_) => None,
            Answer::Number(Allowed { min, max, unit }) => Some((min, max, unit)),
        }
    }

    /// Checks an answer.
    ///
    /// # Errors
    /// What it must be.
    pub fn check(&self, text: &str) -> Result<(), String> {
        match &self.answer {
            Answer::Choice(choices) => {
                let mut names = choices.iter().map(|(name, _)| *name);
                let known: Vec<&str> = names.clone().collect();
                match names.any(|name| name == text) {
                    true => Ok(()),
                    false => Err(format!("must be {}", known.join(" or "))),
                }
            }
            Answer::Number(allowed) => match text.parse::<f64>() {
                Ok(number) if !allowed.admits(number) => Err(allowed.remedy()),
                Ok(number) if allowed.unit != "count" || number % 2.0 == 0.0 => Ok(()),
                Ok(_) => Err("must be an even number".into()),
                Err(_) => Err(allowed.remedy()),
            },
        }
    }

    /// Whether it matters for a robot with these pins, and such motors.
    pub(super) fn is_of(&self, pins: &[(String, String)], has_gear_motors: bool) -> bool {
        let wired = |name: &'static str| {
            let is_so = move |signal: &str| match name.ends_with('_') {
                true => signal.starts_with(name),
                false => signal == name,
            };
            pins.iter()
                .filter(move |(signal, _)| find(signal).is_none() && is_so(signal))
        };
        match self.of {
            Of::Body => true,
            Of::Motors => has_gear_motors,
            Of::Encoder => pins.iter().any(|(signal, _)| signal.ends_with("_encoder")),
            Of::Signal(name) => wired(name).next().is_some(),
            Of::Analogue(name) => wired(name).any(|(_, pin)| pin.parse::<u8>().is_err()),
        }
    }
}

/// What may be said, by its name.
#[must_use]
pub fn find(key: &str) -> Option<&'static Asked> {
    ASKED.iter().find(|asked| asked.key == key)
}
