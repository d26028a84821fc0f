//! One of the devices, whichever it is.

use super::compass::Compass;
use super::hd44780::Text;
use super::hmc5883l::Hmc5883l;
use super::kind::{BusDevice, DeviceKind, Mounted};
use super::mpu6050::Mpu6050;
use super::qmc5883l::Qmc5883l;
use super::ssd1306::Pixels;
use super::vl53l0x::Vl53l0x;
use rumbo_emulator::devices::ports::Drive;
use rumbo_plant::noise::Noise;

/// A device as a model.
#[derive(Clone, Debug)]
pub(super) enum Device {
    Mpu6050(Mpu6050),
    Ranger(Box<Vl53l0x>),
    Qmc5883l(Qmc5883l),
    Hmc5883l(Hmc5883l),
    Pixels(Pixels),
    Text(Text),
}

impl Device {
    /// The device of this number on the bus, just switched on.
    pub(super) fn new(number: u32, device: &BusDevice) -> Self {
        let compass = |Mounted { axes, iron_ut }| Compass::new(number, axes, iron_ut);
        match device.kind {
            DeviceKind::Mpu6050 { axes, .. } => Self::Mpu6050(Mpu6050::new(number, axes)),
            DeviceKind::Vl53l0x { .. } => Self::Ranger(Box::new(Vl53l0x::new(number))),
            DeviceKind::Qmc5883l(mounted) => Self::Qmc5883l(Qmc5883l::new(compass(mounted))),
            DeviceKind::Hmc5883l(mounted) => Self::Hmc5883l(Hmc5883l::new(compass(mounted))),
            DeviceKind::Ssd1306 { rows } => Self::Pixels(Pixels::new(rows)),
            DeviceKind::Hd44780 { columns, rows } => {
                Self::Text(Text::new(columns, rows, device.place))
            }
        }
    }

    /// The address that it answers at in this cycle, if it does; `wired` is the one after power-on.
    pub(super) fn address(&self, wired: Option<u8>, cycle: u64) -> Option<u8> {
        match self {
            Self::Ranger(ranger) => ranger.address(cycle),
            _ => wired,
        }
    }

    /// The chip drives so the pin of one of its lines, as [`BusDevice::pins`] has them.
    pub(super) fn steer(&mut self, line: usize, cycle: u64, drive: Drive) {
        match self {
            // Its board pulls it up.
            Self::Ranger(ranger) => ranger.shut(cycle, drive != Drive::Low),
            Self::Text(text) => text.set(line, drive == Drive::High, cycle),
            _ => {}
        }
    }

    /// A transmission to it begins.
    pub(super) fn begin(&mut self) {
        match self {
            Self::Mpu6050(imu) => imu.address(),
            Self::Ranger(ranger) => ranger.begin(),
            Self::Qmc5883l(chip) => chip.begin(),
            Self::Hmc5883l(chip) => chip.begin(),
            Self::Pixels(pixels) => pixels.address(),
            Self::Text(_) => {}
        }
    }

    pub(super) fn write(&mut self, byte: u8, cycle: u64) {
        match self {
            Self::Mpu6050(imu) => imu.write(byte),
            Self::Ranger(ranger) => ranger.write(byte, cycle),
            Self::Qmc5883l(chip) => chip.write(byte),
            Self::Hmc5883l(chip) => chip.write(byte),
            Self::Pixels(pixels) => pixels.write(byte),
            Self::Text(text) => text.write(byte, cycle),
        }
    }

    pub(super) fn read(&mut self, cycle: u64) -> u8 {
        match self {
            Self::Mpu6050(imu) => imu.read(),
            Self::Ranger(ranger) => ranger.read(cycle),
            Self::Qmc5883l(chip) => chip.read(),
            Self::Hmc5883l(chip) => chip.read(),
            Self::Pixels(pixels) => pixels.read(),
            Self::Text(text) => text.read(cycle),
        }
    }

    /// A compass measures, in whole milliseconds; north is so far to the left of ahead \[rad\].
    pub(super) fn orient(&mut self, north_rad: f64, now_us: u64, noise: &Noise) {
        match self {
            Self::Qmc5883l(chip) => chip.measure(north_rad, now_us, noise),
            Self::Hmc5883l(chip) => chip.measure(north_rad, now_us, noise),
            _ => {}
        }
    }

    /// Where a compass points, clockwise from magnetic north \[rad\].
    pub(super) fn azimuth_rad(&self) -> Option<f64> {
        match self {
            Self::Qmc5883l(chip) => Some(chip.azimuth_rad()),
            Self::Hmc5883l(chip) => Some(chip.azimuth_rad()),
            _ => None,
        }
    }

    /// What it shows, as JSON, if it is a display that has changed since the last call.
    pub(super) fn changed(&mut self) -> Option<String> {
        match self {
            Self::Pixels(pixels) => pixels.take_changed().then(|| pixels.content()),
            Self::Text(text) => text.take_changed().then(|| text.content()),
            _ => None,
        }
    }

    /// What people wonder about: what it shows in the end, what a program asked that is not modelled.
    pub(super) fn notes(&self, name: &str) -> Vec<String> {
        let (drawn, oddity) = match self {
            Self::Pixels(pixels) => (pixels.drawn(), None),
            Self::Text(text) => (text.drawn(), text.oddity()),
            Self::Mpu6050(imu) => (None, imu.oddity().map(str::to_owned)),
            Self::Ranger(ranger) => (None, ranger.oddity().map(str::to_owned)),
            Self::Qmc5883l(_) | Self::Hmc5883l(_) => (None, None),
        };
        let drawn = drawn.map(|drawn| format!("{name} shows\n{drawn}"));
        let oddity = oddity.map(|oddity| format!("{name}: {oddity}"));
        drawn.into_iter().chain(oddity).collect()
    }
}
