//! What devices there are for the two-wire bus, as robot files have them. A display of letters may be on pins of its own.

use rumbo_plant::rig::Mount;
use std::ops::RangeInclusive;

/// A device, as a robot file has it.
#[derive(Clone, Debug, PartialEq)]
pub struct BusDevice {
    /// What the robot file calls it.
    pub name: String,
    /// What it is.
    pub kind: DeviceKind,
    /// How it is connected.
    pub place: Place,
}

impl BusDevice {
    /// Its address on the bus after power-on, 7 bits.
    #[must_use]
    pub const fn address(&self) -> Option<u8> {
        self.place.address()
    }

    /// The board's pins that it has beside the bus.
    pub fn pins(&self) -> impl Iterator<Item = u8> {
        let (lines, beside) = match self.place {
            Place::Address(_) => (None, self.kind.pin()),
            Place::Lines(lines) => (Some(lines), None),
        };
        lines.into_iter().flatten().chain(beside)
    }
}

/// How a device is connected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// At this address of the two-wire bus.
    Address(u8),
    /// A display of letters with RS, E and D4 to D7 on these pins of the board, R/W at GND.
    Lines([u8; 6]),
}

impl Place {
    /// Its address, if it is on the bus.
    #[must_use]
    pub const fn address(self) -> Option<u8> {
        match self {
            Self::Address(address) => Some(address),
            Self::Lines(_) => None,
        }
    }
}

/// What a device is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DeviceKind {
    /// An MPU-6050: accelerometer and gyroscope.
    Mpu6050 {
        /// Where it is on the robot, ahead of the wheels' axis and to the left \[m\].
        at_m: [f64; 2],
        /// Where its x, y and z point: 1 forward, 2 left, 3 up; negative the opposite.
        axes: [i8; 3],
        /// The board's pin of its INT output.
        interrupt: Option<u8>,
    },
    /// A VL53L0X: distance by the time that light takes.
    Vl53l0x {
        /// Where it is on the robot, and where it looks.
        mount: Mount,
        /// The board's pin of its XSHUT input, which its board pulls up.
        shutdown: Option<u8>,
    },
    /// A QMC5883L: compass.
    Qmc5883l(Mounted),
    /// An HMC5883L: compass.
    Hmc5883l(Mounted),
    /// An SSD1306 with 128 columns.
    Ssd1306 {
        /// 32 or 64.
        rows: u8,
    },
    /// An HD44780, behind a PCF8574 or on pins of its own.
    Hd44780 {
        /// Characters in a row.
        columns: u8,
        /// Rows of characters.
        rows: u8,
    },
}

/// How a compass is mounted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mounted {
    /// Where its x, y and z point: 1 forward, 2 left, 3 up; negative the opposite.
    pub axes: [i8; 3],
    /// The field of the robot's own iron there, forward and left \[uT\].
    pub iron_ut: [f64; 2],
}

impl DeviceKind {
    /// One of each, as it is where the robot file says nothing more.
    pub const ALL: [Self; 6] = [
        Self::Mpu6050 {
            at_m: [0.0; 2],
            axes: [1, 2, 3],
            interrupt: None,
        },
        Self::Vl53l0x {
            mount: Mount {
                x_m: 0.0,
                y_m: 0.0,
                angle_rad: 0.0,
                on_servo: false,
            },
            shutdown: None,
        },
        Self::Qmc5883l(Mounted {
            axes: [1, 2, 3],
            iron_ut: [0.0; 2],
        }),
        Self::Hmc5883l(Mounted {
            axes: [1, 2, 3],
            iron_ut: [0.0; 2],
        }),
        Self::Ssd1306 { rows: 64 },
        Self::Hd44780 {
            columns: 16,
            rows: 2,
        },
    ];

    /// Its key in robot files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Mpu6050 { .. } => "mpu6050",
            Self::Vl53l0x { .. } => "vl53l0x",
            Self::Qmc5883l(_) => "qmc5883l",
            Self::Hmc5883l(_) => "hmc5883l",
            Self::Ssd1306 { .. } => "ssd1306",
            Self::Hd44780 { .. } => "hd44780",
        }
    }

    /// What of its measurements follows a data sheet, and is not identified from recordings.
    #[must_use]
    pub const fn data_sheet(self) -> Option<&'static str> {
        match self {
            Self::Mpu6050 { .. } => {
                Some("accelerometer and gyroscope: MPU-6050 by its data sheet, not identified")
            }
            Self::Vl53l0x { .. } => {
                Some("distance by light: VL53L0X by its data sheet, not identified")
            }
            Self::Qmc5883l(_) | Self::Hmc5883l(_) => {
                Some("compass: QMC5883L and HMC5883L by their data sheets, not identified")
            }
            Self::Ssd1306 { .. } | Self::Hd44780 { .. } => None,
        }
    }

    /// The board's pin that it has beside the bus.
    #[must_use]
    pub const fn pin(self) -> Option<u8> {
        match self {
            Self::Mpu6050 { interrupt: pin, .. } | Self::Vl53l0x { shutdown: pin, .. } => pin,
            _ => None,
        }
    }

    /// Whether it matters where on the robot it is.
    #[must_use]
    pub const fn has_place(self) -> bool {
        matches!(self, Self::Mpu6050 { .. } | Self::Vl53l0x { .. })
    }

    /// Whether the board can hold it in reset, in which it answers at no address.
    #[must_use]
    pub const fn has_reset(self) -> bool {
        matches!(
            self,
            Self::Vl53l0x {
                shutdown: Some(_),
                ..
            }
        )
    }

    /// The directions that its axes can point to, by their numbers.
    #[must_use]
    pub fn directions() -> [(&'static str, i8); 6] {
        [
            ("forward", 1),
            ("backward", -1),
            ("left", 2),
            ("right", -2),
            ("up", 3),
            ("down", -3),
        ]
    }

    /// The addresses that its jumpers can give it.
    #[must_use]
    pub fn addresses(self) -> Vec<RangeInclusive<u8>> {
        match self {
            Self::Mpu6050 { .. } => vec![0x68..=0x69],
            Self::Vl53l0x { .. } => vec![0x29..=0x29],
            Self::Qmc5883l(_) => vec![0x0D..=0x0D],
            Self::Hmc5883l(_) => vec![0x1E..=0x1E],
            Self::Ssd1306 { .. } => vec![0x3C..=0x3D],
            // PCF8574 and PCF8574A.
            Self::Hd44780 { .. } => vec![0x20..=0x27, 0x38..=0x3F],
        }
    }

    /// The sizes that there are, of a display.
    #[must_use]
    pub fn sizes(self) -> Vec<(&'static str, Self)> {
        let text = |columns, rows| Self::Hd44780 { columns, rows };
        match self {
            Self::Ssd1306 { .. } => vec![
                ("128x64", Self::Ssd1306 { rows: 64 }),
                ("128x32", Self::Ssd1306 { rows: 32 }),
            ],
            Self::Hd44780 { .. } => vec![("16x2", text(16, 2)), ("20x4", text(20, 4))],
            _ => Vec::new(),
        }
    }
}
