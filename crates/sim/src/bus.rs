//! The devices on the two-wire bus (I2C) of a board, and displays of letters on pins: what answers at which address, byte by byte.
//!
//! The chip tells of each byte that it begins on the bus; the addressed device replies. Nothing is done between them.

mod compass;
mod device;
mod hd44780;
mod hmc5883l;
pub mod kind;
mod mpu6050;
mod pca9685;
mod qmc5883l;
mod ssd1306;
pub(crate) mod vl53l0x;

use device::Device;
pub use kind::{BusDevice, DeviceKind, Mounted, Place};
use mpu6050::Mpu6050;
pub(crate) use mpu6050::{Interrupt, Motion};
use pca9685::Pca9685;
use rumbo_emulator::devices::ports::Drive;
use rumbo_emulator::devices::{Reply, Transfer};
use rumbo_plant::noise::Noise;
use std::collections::BTreeSet;
use vl53l0x::Vl53l0x;

/// The most addresses that a program asks in vain before it counts as one that searches the bus.
const SEARCHED: usize = 3;

/// A device, and what becomes of it.
#[derive(Clone, Debug)]
struct Member {
    wired: BusDevice,
    device: Device,
    /// A transmission is for it.
    addressed: bool,
    /// What it showed when it was last looked at.
    shown: String,
}

/// The bus.
#[derive(Clone, Debug, Default)]
pub(crate) struct Bus {
    members: Vec<Member>,
    shield_addressed: bool,
    /// Where nobody answered.
    in_vain: BTreeSet<u8>,
    /// Where several answered at once.
    disputed: BTreeSet<u8>,
    /// The chip of a motor shield, and its address.
    shield: Option<(u8, Box<Pca9685>)>,
}

impl Bus {
    /// The bus with these devices, and a motor shield at this address, just switched on.
    pub(crate) fn new(devices: &[BusDevice], shield: Option<u8>) -> Self {
        let member = |(number, wired): (usize, &BusDevice)| Member {
            wired: wired.clone(),
            device: Device::new(number as u32, wired),
            addressed: false,
            shown: String::new(),
        };
        Self {
            members: devices.iter().enumerate().map(member).collect(),
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

    /// A transmission for this address begins.
    fn call(&mut self, address: u8, cycle: u64) {
        let mut answers = 0;
        for member in &mut self.members {
            let own = member.device.address(member.wired.address(), cycle);
            member.addressed = own == Some(address);
            answers += usize::from(member.addressed);
        }
        let of_shield = self.shield.as_ref().map(|(address, _)| *address);
        self.shield_addressed = of_shield == Some(address);
        match answers + usize::from(self.shield_addressed) {
            0 => drop(self.in_vain.insert(address)),
            1 => {}
            _ => drop(self.disputed.insert(address)),
        }
    }

    /// A byte begins in this cycle: the reply of the device that it is for. Where several are, each hears it, and a line is
    /// low where one of them pulls it down.
    pub(crate) fn transfer(&mut self, transfer: Transfer, cycle: u64) -> Option<Reply> {
        if let Transfer::Address(byte) = transfer {
            self.call(byte >> 1, cycle);
        }
        if self.shield_addressed {
            return self.serve_shield(transfer);
        }
        let mut reply = None;
        for member in self.members.iter_mut().filter(|member| member.addressed) {
            let device = &mut member.device;
            match transfer {
                Transfer::Address(_) => device.begin(),
                Transfer::Write(byte) => device.write(byte, cycle),
                Transfer::Read => {
                    let byte = device.read(cycle);
                    reply = Some(match reply {
                        Some(Reply::Byte(other)) => Reply::Byte(other & byte),
                        _ => Reply::Byte(byte),
                    });
                    continue;
                }
                Transfer::End => continue,
            }
            reply = Some(Reply::Acknowledge);
        }
        reply
    }

    /// The chip drives a pin so, of which `is` knows the board's number: it may be a sensor's XSHUT, or a line of a display.
    pub(crate) fn steer(&mut self, cycle: u64, drive: Drive, is: impl Fn(u8) -> bool) {
        for Member { wired, device, .. } in &mut self.members {
            if let Some(line) = wired.pins().position(&is) {
                device.steer(line, cycle, drive);
            }
        }
    }

    /// The inertial sensors, each with its entry of the robot file.
    pub(crate) fn imus(&mut self) -> impl Iterator<Item = (&BusDevice, &mut Mpu6050)> {
        self.members
            .iter_mut()
            .filter_map(|member| match &mut member.device {
                Device::Mpu6050(imu) => Some((&member.wired, imu)),
                _ => None,
            })
    }

    /// The sensors of distance, each with its entry of the robot file.
    pub(crate) fn rangers(&mut self) -> impl Iterator<Item = (&BusDevice, &mut Vl53l0x)> {
        self.members
            .iter_mut()
            .filter_map(|member| match &mut member.device {
                Device::Ranger(ranger) => Some((&member.wired, &mut **ranger)),
                _ => None,
            })
    }

    /// The compasses measure, in whole milliseconds; north is so far to the left of ahead \[rad\].
    pub(crate) fn orient(&mut self, north_rad: f64, now_us: u64, noise: &Noise) {
        for member in &mut self.members {
            member.device.orient(north_rad, now_us, noise);
        }
    }

    /// Where each compass points, clockwise from magnetic north \[rad\].
    pub(crate) fn azimuths(&self) -> impl Iterator<Item = (&BusDevice, f64)> {
        let members = self.members.iter();
        members.filter_map(|Member { wired, device, .. }| Some((wired, device.azimuth_rad()?)))
    }

    /// What the displays show that have changed since the last call: lines `name=content`.
    pub(crate) fn changed(&mut self) -> Vec<String> {
        let mut lines = Vec::new();
        for member in &mut self.members {
            let content = member.device.changed();
            if let Some(content) = content.filter(|content| *content != member.shown) {
                lines.push(format!("{}={content}\n", member.wired.name));
                member.shown = content;
            }
        }
        lines
    }

    /// What people wonder about: what the displays show in the end, addresses that nobody answers, what is not modelled.
    pub(crate) fn notes(&self, cycle: u64) -> Vec<String> {
        let members = self.members.iter();
        let mut notes: Vec<String> = members
            .flat_map(|member| member.device.notes(&member.wired.name))
            .collect();
        notes.extend(self.disputed.iter().map(|address| {
            format!(
                "several answer at once at 0x{address:02x} on the two-wire bus: hold all but one by their XSHUT, LOW, give that \
                 one another address, and let the next one go, pinMode(pin, INPUT)"
            )
        }));
        if (1..=SEARCHED).contains(&self.in_vain.len()) {
            let asked = self
                .in_vain
                .iter()
                .map(|address| format!("0x{address:02x}"));
            let members = self.members.iter();
            let devices = members.filter(|member| member.wired.address().is_some());
            let devices = devices.map(|Member { wired, device, .. }| {
                match device.address(wired.address(), cycle) {
                    Some(address) => format!("{} at 0x{address:02x}", wired.name),
                    None => format!("{}, which its XSHUT holds in reset", wired.name),
                }
            });
            let shield = self.shield.iter();
            let shield = shield.map(|(address, _)| format!("the motor shield at 0x{address:02x}"));
            let there = devices.chain(shield);
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
