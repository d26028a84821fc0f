//! The devices on the two-wire bus (I2C) of a board: what answers at which address, byte by byte.
//!
//! The chip tells of each byte that it begins on the bus; the addressed device replies. Nothing is done between them.

mod hd44780;
mod mpu6050;
mod pca9685;
mod ssd1306;

use hd44780::Text;
use mpu6050::Mpu6050;
pub(crate) use mpu6050::{Interrupt, Motion};
use pca9685::Pca9685;
use rumbo_emulator::devices::{Reply, Transfer};
use ssd1306::Pixels;
use std::collections::BTreeSet;
use std::ops::RangeInclusive;

/// The most addresses that a program asks in vain before it counts as one that searches the bus.
const SEARCHED: usize = 3;

/// A device on the bus, as a robot file has it.
#[derive(Clone, Debug, PartialEq)]
pub struct BusDevice {
    /// What the robot file calls it.
    pub name: String,
    /// What it is.
    pub kind: DeviceKind,
    /// Its address, 7 bits.
    pub address: u8,
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
    /// An SSD1306 with 128 columns.
    Ssd1306 {
        /// 32 or 64.
        rows: u8,
    },
    /// An HD44780 behind a PCF8574.
    Hd44780 {
        /// Characters in a row.
        columns: u8,
        /// Rows of characters.
        rows: u8,
    },
}

impl DeviceKind {
    /// One of each, as it is where the robot file says nothing more.
    pub const ALL: [Self; 3] = [
        Self::Mpu6050 {
            at_m: [0.0; 2],
            axes: [1, 2, 3],
            interrupt: None,
        },
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
            Self::Ssd1306 { .. } => "ssd1306",
            Self::Hd44780 { .. } => "hd44780",
        }
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
            Self::Mpu6050 { .. } => Vec::new(),
            Self::Ssd1306 { .. } => vec![
                ("128x64", Self::Ssd1306 { rows: 64 }),
                ("128x32", Self::Ssd1306 { rows: 32 }),
            ],
            Self::Hd44780 { .. } => vec![("16x2", text(16, 2)), ("20x4", text(20, 4))],
        }
    }
}

#[derive(Clone, Debug)]
enum Device {
    Mpu6050(Mpu6050),
    Pixels(Pixels),
    Text(Text),
}

/// The bus.
#[derive(Clone, Debug, Default)]
pub(crate) struct Bus {
    devices: Vec<(BusDevice, Device)>,
    addressed: Option<usize>,
    shield_addressed: bool,
    /// Where nobody answered.
    in_vain: BTreeSet<u8>,
    /// What each display showed when it was last looked at.
    shown: Vec<String>,
    /// The chip of a motor shield, and its address.
    shield: Option<(u8, Box<Pca9685>)>,
}

impl Bus {
    /// The bus with these devices, and a motor shield at this address, just switched on.
    pub(crate) fn new(devices: &[BusDevice], shield: Option<u8>) -> Self {
        let made = |(number, device): (usize, &BusDevice)| {
            let made = match device.kind {
                DeviceKind::Mpu6050 { axes, .. } => {
                    Device::Mpu6050(Mpu6050::new(number as u32, axes))
                }
                DeviceKind::Ssd1306 { rows } => Device::Pixels(Pixels::new(rows)),
                DeviceKind::Hd44780 { columns, rows } => Device::Text(Text::new(columns, rows)),
            };
            (device.clone(), made)
        };
        let devices: Vec<_> = devices.iter().enumerate().map(made).collect();
        Self {
            shown: vec![String::new(); devices.len()],
            devices,
            shield: shield.map(|address| (address, Box::new(Pca9685::new()))),
            ..Self::default()
        }
    }

    /// The chip of a motor shield.
    pub(crate) fn shield(&self) -> Option<&Pca9685> {
        self.shield.as_ref().map(|(_, chip)| &**chip)
    }

    /// The same for the shield, if it is the one that is addressed.
    fn serve_shield(&mut self, transfer: Transfer) -> Option<Reply> {
        let (_, chip) = self.shield.as_mut()?;
        match transfer {
            Transfer::Address(_) => chip.address(),
            Transfer::Write(byte) => chip.write(byte),
            Transfer::Read => return Some(Reply::Byte(chip.read())),
            Transfer::End => return None,
        }
        Some(Reply::Acknowledge)
    }

    /// A byte begins in this cycle: the reply of the device that it is for.
    pub(crate) fn transfer(&mut self, transfer: Transfer, cycle: u64) -> Option<Reply> {
        if let Transfer::Address(byte) = transfer {
            let address = byte >> 1;
            let found = |(device, _): &(BusDevice, Device)| device.address == address;
            self.addressed = self.devices.iter().position(found);
            let of_shield = self.shield.as_ref().map(|(address, _)| *address);
            self.shield_addressed = of_shield == Some(address);
            if self.addressed.is_none() && !self.shield_addressed {
                self.in_vain.insert(address);
            }
        }
        if self.shield_addressed {
            return self.serve_shield(transfer);
        }
        let (_, device) = self.devices.get_mut(self.addressed?)?;
        match transfer {
            Transfer::Address(_) => {
                match device {
                    Device::Mpu6050(imu) => imu.address(),
                    Device::Pixels(pixels) => pixels.address(),
                    Device::Text(_) => {}
                }
                Some(Reply::Acknowledge)
            }
            Transfer::Write(byte) => {
                match device {
                    Device::Mpu6050(imu) => imu.write(byte),
                    Device::Pixels(pixels) => pixels.write(byte),
                    Device::Text(text) => text.write(byte, cycle),
                }
                Some(Reply::Acknowledge)
            }
            Transfer::End => None,
            Transfer::Read => Some(Reply::Byte(match device {
                Device::Mpu6050(imu) => imu.read(),
                Device::Pixels(pixels) => pixels.read(),
                Device::Text(text) => text.read(cycle),
            })),
        }
    }

    /// The inertial sensors, each with its entry of the robot file.
    pub(crate) fn imus(&mut self) -> impl Iterator<Item = (&BusDevice, &mut Mpu6050)> {
        let devices = self.devices.iter_mut();
        devices.filter_map(|(device, made)| match made {
            Device::Mpu6050(imu) => Some((&*device, imu)),
            _ => None,
        })
    }

    /// What the displays show that have changed since the last call: lines `name=content`.
    pub(crate) fn changed(&mut self) -> Vec<String> {
        let mut lines = Vec::new();
        for ((device, made), shown) in self.devices.iter_mut().zip(&mut self.shown) {
            let content = match made {
                Device::Pixels(pixels) => pixels.take_changed().then(|| pixels.content()),
                Device::Text(text) => text.take_changed().then(|| text.content()),
                Device::Mpu6050(_) => None,
            };
            if let Some(content) = content.filter(|content| content != shown) {
                lines.push(format!("{}={content}\n", device.name));
                *shown = content;
            }
        }
        lines
    }

    /// What people wonder about: what the displays show in the end, addresses that nobody answers, what is not modelled.
    pub(crate) fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        for (BusDevice { name, .. }, made) in &self.devices {
            notes.extend(match made {
                Device::Pixels(pixels) => {
                    pixels.drawn().map(|drawn| format!("{name} shows\n{drawn}"))
                }
                Device::Text(text) => text.drawn().map(|drawn| format!("{name} shows\n{drawn}")),
                Device::Mpu6050(imu) => imu.oddity().map(|oddity| format!("{name}: {oddity}")),
            });
            if let Device::Text(text) = made
                && text.lost() > 0
            {
                notes.push(format!(
                    "{name}: {} bytes came while the display was busy and are lost; wait 2 ms after clear and home",
                    text.lost()
                ));
            }
        }
        if (1..=SEARCHED).contains(&self.in_vain.len()) {
            let asked = self
                .in_vain
                .iter()
                .map(|address| format!("0x{address:02x}"));
            let devices = self.devices.iter();
            let devices = devices.map(|(device, _)| (device.name.as_str(), device.address));
            let shield = self.shield.iter();
            let shield = shield.map(|(address, _)| ("the motor shield", *address));
            let there = devices.chain(shield);
            let there = there.map(|(name, address)| format!("{name} at 0x{address:02x}"));
            let there = there.collect::<Vec<_>>().join(", ");
            let there = match there.is_empty() {
                true => "nothing is; the robot file has devices, e.g. parts.imu = { mpu6050 = 0x68 } in its [wiring.NAME]".into(),
                false => format!("there are {there}"),
            };
            let asked = asked.collect::<Vec<_>>().join(", ");
            notes.push(format!(
                "nobody answers at {asked} on the two-wire bus: {there}"
            ));
        }
        notes
    }
}

/// A text for lines that are only ASCII, as JSON has it.
fn quoted(text: &str) -> String {
    let mut quoted = String::from('"');
    for letter in text.chars() {
        match letter {
            '"' | '\\' => quoted.extend(['\\', letter]),
            ' '..='~' => quoted.push(letter),
            other => quoted.push_str(&format!("\\u{:04x}", u32::from(other))),
        }
    }
    quoted + "\""
}

/// Bytes in hexadecimal.
fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
