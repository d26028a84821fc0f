//! The motor drivers: what their inputs make of a motor, and what they cost of the battery's voltage.
//!
//! The L298N is identified with the report's robot; the others are taken from their data sheets and say so
//! ([`Driver::source`]).

use rumbo_plant::params;
use std::fmt;

/// What one half of a driver does with its motor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stage {
    /// All transistors off.
    Coast,
    /// Driven forward.
    Forward,
    /// Driven backward.
    Backward,
    /// Shorted.
    Brake,
}

use Stage::{Backward, Brake, Coast, Forward};

/// How a half is told its direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// By two inputs.
    Two,
    /// By one, high or low.
    One,
    /// By two outputs of a shield's register: a wheel is on one of its motors.
    Motor,
    /// By the width of pulses: the motor is that of a servo without a stop.
    Pulse,
}

/// A shield on which a chip has the inputs of the motors: a register, 74HC595, those of their directions; or a PCA9685 all.
pub struct Shield {
    /// The board's pins of the register: latch, clock, data, and enable, whose low switches its outputs on.
    pub(crate) lines: Option<[u8; 4]>,
    /// The address of the PCA9685 on the two-wire bus.
    pub(crate) address: Option<u8>,
    /// Of each motor, M1 first, where its PWM is, the board's pin or the PCA9685's output, and the chip's outputs on its inputs, that
    /// of forward first.
    motors: [(u8, [u8; 2]); 4],
}

impl Shield {
    /// The number of a motor by its name, `M1` to `M4`.
    #[must_use]
    pub fn motor(&self, name: &str) -> Option<u8> {
        let number: u8 = name.strip_prefix(['M', 'm'])?.parse().ok()?;
        (1..=self.motors.len() as u8)
            .contains(&number)
            .then_some(number)
    }

    /// Where a motor's PWM is, and the chip's outputs on its inputs.
    pub(crate) fn inputs_of(&self, motor: u8) -> (u8, [u8; 2]) {
        let motors = &self.motors;
        motors[usize::from(motor.saturating_sub(1)) % motors.len()]
    }
}

/// The Adafruit motor shield, version 1, and its many copies: schematic and AFMotor.h.
static MOTOR_SHIELD: Shield = Shield {
    lines: Some([12, 4, 8, 7]),
    address: None,
    motors: [(11, [2, 3]), (3, [1, 4]), (6, [5, 7]), (5, [0, 6])],
};

/// The Adafruit motor shield, version 2: schematic and Adafruit_MotorShield.cpp.
static MOTOR_SHIELD_V2: Shield = Shield {
    lines: None,
    address: Some(0x60),
    motors: [(8, [10, 9]), (13, [11, 12]), (2, [4, 3]), (7, [5, 6])],
};

/// A driver of two motors.
pub struct Driver {
    /// As robot files name it: `l298n`.
    pub name: &'static str,
    /// As people do.
    pub title: &'static str,
    /// Where its numbers are from; nothing where they were identified from recordings.
    pub source: Option<&'static str>,
    /// Whether each half has an enable input.
    pub has_enable: bool,
    /// Its direction inputs.
    pub direction: Direction,
    /// Whether one input, low, switches both halves off.
    pub has_standby: bool,
    /// The shield that it is on, if that decides its pins.
    pub shield: Option<&'static Shield>,
    /// What a half does, by enable (low, high) and by inputs: none high, forward, backward, both.
    pub(crate) does: [[Stage; 4]; 2],
    drop_v: f64,
    drop_ohm: f64,
    diode_v: f64,
    brake_v: f64,
}

/// The L298N, whose losses `[plant.bridge]` has.
pub static L298N: Driver = Driver {
    name: "l298n",
    title: "L298N",
    source: None,
    has_enable: true,
    direction: Direction::Two,
    has_standby: false,
    shield: None,
    // L298 data sheet, "bidirectional DC motor control".
    does: [[Coast; 4], [Brake, Forward, Backward, Brake]],
    drop_v: 1.4,
    drop_ohm: 0.5,
    diode_v: 0.9,
    brake_v: 1.6,
};

/// The L293D.
static L293D: Driver = Driver {
    name: "l293d",
    title: "L293D",
    // Saturation 1.4 V above and 1.2 V below at 0.6 A, diodes 1.3 V; a motor is shorted over one of each.
    source: Some("its data sheet (TI SLRS008)"),
    drop_v: 2.6,
    drop_ohm: 0.0,
    diode_v: 1.3,
    brake_v: 2.5,
    ..L298N
};

/// The TB6612FNG.
static TB6612: Driver = Driver {
    name: "tb6612",
    title: "TB6612FNG",
    // 0.5 ohm above and below together, diodes 1.0 V at 1 A.
    source: Some("its data sheet (Toshiba TB6612FNG, 2014-10-01)"),
    has_standby: true,
    does: [
        [Coast, Brake, Brake, Brake],
        [Coast, Forward, Backward, Brake],
    ],
    drop_v: 0.0,
    drop_ohm: 0.5,
    diode_v: 1.0,
    brake_v: 0.0,
    ..L298N
};

/// The DRV8833.
static DRV8833: Driver = Driver {
    name: "drv8833",
    title: "DRV8833",
    // 0.36 ohm above and below together; no value for its diodes: silicon's.
    source: Some("its data sheet (TI SLVSAR1)"),
    has_enable: false,
    has_standby: true,
    does: [[Coast, Forward, Backward, Brake]; 2],
    drop_v: 0.0,
    drop_ohm: 0.36,
    diode_v: 0.8,
    brake_v: 0.0,
    ..L298N
};

/// The drivers that there are.
pub static DRIVERS: [&Driver; 12] = [
    &L298N,
    &L293D,
    &Driver {
        name: "motor-shield",
        title: "motor shield with L293D and 74HC595",
        source: Some("the data sheet of the L293D (TI SLRS008)"),
        has_enable: false,
        direction: Direction::Motor,
        shield: Some(&MOTOR_SHIELD),
        ..L293D
    },
    &TB6612,
    &Driver {
        name: "motor-shield-v2",
        title: "motor shield with TB6612FNG and PCA9685",
        source: Some("the data sheet of the TB6612FNG"),
        has_enable: false,
        direction: Direction::Motor,
        has_standby: false,
        shield: Some(&MOTOR_SHIELD_V2),
        ..TB6612
    },
    &DRV8833,
    &Driver {
        name: "mx1508",
        title: "MX1508",
        // 1.6 ohm above and below together, of its copy TC1508S: modules have either.
        source: Some("the data sheet of the TC1508S"),
        has_standby: false,
        drop_ohm: 1.6,
        ..DRV8833
    },
    &Driver {
        name: "l9110s",
        title: "L9110S",
        // Both outputs are low where its inputs are alike. 1.40 V above and 0.45 V below at 0.75 A.
        source: Some("its data sheet (ASIC L9110)"),
        has_standby: false,
        does: [[Brake, Forward, Backward, Brake]; 2],
        drop_v: 1.85,
        drop_ohm: 0.0,
        ..DRV8833
    },
    &Driver {
        name: "bts7960",
        title: "two BTS7960 a motor (IBT-2)",
        // 7 mohm above, 9 mohm below, diodes 0.9 V.
        source: Some("its data sheet (Infineon, 2004-12-07)"),
        has_enable: true,
        has_standby: false,
        does: L298N.does,
        drop_ohm: 0.016,
        diode_v: 0.9,
        ..DRV8833
    },
    &Driver {
        name: "vnh5019",
        title: "VNH5019",
        // 18 mohm above and below together, diodes 0.9 V. PWM low switches the lower transistors off: the current flows on
        // through the upper ones, as far as a direction is given.
        source: Some("its data sheet (ST, 15701 Rev 7)"),
        has_enable: true,
        has_standby: false,
        does: [[Coast, Brake, Brake, Brake], L298N.does[1]],
        drop_ohm: 0.018,
        diode_v: 0.9,
        ..DRV8833
    },
    &Driver {
        name: "dir-pwm",
        title: "driver with a direction and a PWM input",
        // Most are a TB6612FNG whose second input is the inverse of the first.
        source: Some("the data sheet of the TB6612FNG"),
        direction: Direction::One,
        has_standby: true,
        does: [[Brake; 4], [Brake, Forward, Backward, Brake]],
        drop_v: 0.0,
        drop_ohm: 0.5,
        diode_v: 1.0,
        brake_v: 0.0,
        ..L298N
    },
    &Driver {
        name: "continuous-servos",
        title: "continuous-rotation servos",
        // What they lose is in their speed and torque.
        source: Some("the data sheet of Parallax's 900-00008, 2.0"),
        direction: Direction::Pulse,
        has_standby: false,
        drop_ohm: 0.0,
        ..DRV8833
    },
];

impl Driver {
    /// The driver of this name.
    #[must_use]
    pub fn named(name: &str) -> Option<&'static Driver> {
        DRIVERS.into_iter().find(|driver| driver.name == name)
    }

    /// Its losses, in place of the nominal ones.
    #[must_use]
    pub fn bridge(&self) -> params::Bridge {
        params::Bridge {
            drop_v: self.drop_v,
            drop_ohm: self.drop_ohm,
            diode_v: self.diode_v,
            brake_v: self.brake_v,
            ..params::Bridge::default()
        }
    }

    /// What it is, and that it was not identified, where so.
    #[must_use]
    pub fn in_words(&self) -> String {
        match self.source {
            None => self.title.to_owned(),
            Some(source) => format!("{}, by {source}, not identified", self.title),
        }
    }
}

/// The report's.
impl Default for &'static Driver {
    fn default() -> Self {
        &L298N
    }
}

impl PartialEq for Driver {
    fn eq(&self, other: &Driver) -> bool {
        self.name == other.name
    }
}

impl Eq for Driver {}

impl fmt::Debug for Driver {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(self.name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_report_s_driver_is_the_nominal_one() {
        assert_eq!(L298N.bridge(), params::Bridge::default());
    }
}
