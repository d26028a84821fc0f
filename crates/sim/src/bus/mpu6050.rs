//! An MPU-6050 as its register map has it (InvenSense RM-MPU-6000A-00, 4.2), with the errors of its data sheet
//! (PS-MPU-6000A-00, 3.4), not identified from recordings.
//!
//! It measures the plant's true motion, a thousand times a second: gravity, the acceleration along the way and towards its
//! centre, the turn rate. Offset and scale are drawn by the seed, three standard deviations being what the data sheet tolerates;
//! noise has the data sheet's density, and passes the low-pass filter with the signal. What a program writes into the offset
//! registers, which only the MPU-6500's map tells (RM-MPU-6500A-00, 2.1), is added; those of the accelerometer have 4096 counts
//! in a g, as InvenSense's Motion Driver has it, and hold no factory trim. FIFO and motion processor (DMP) are not modelled.

use crate::source;
use rumbo_plant::noise::Noise;
use std::f64::consts::{PI, TAU};

/// Noise sources of a sensor.
const SOURCES: u32 = 7;
/// The step of the noise that draws offsets and scales; measurements have their time.
const OFFSET: u64 = u64::MAX;
const SCALE: u64 = u64::MAX - 1;

/// Standard gravity \[m/s2\].
const GRAVITY: f64 = 9.806_65;
/// One count at the finest range: 2 g and 250 deg/s over half of 16 bits, as 16384 and 131 counts.
const ACCELERATION: f64 = GRAVITY / 16_384.0;
const RATE: f64 = PI / 180.0 / 131.0;
/// What the data sheet tolerates: offsets of 50, 50 and 80 mg, of 20 deg/s, and 3 % of the scale.
const OFFSETS: [f64; 6] = [
    0.05 * GRAVITY,
    0.05 * GRAVITY,
    0.08 * GRAVITY,
    20.0 * PI / 180.0,
    20.0 * PI / 180.0,
    20.0 * PI / 180.0,
];
const SCALES: f64 = 0.03;
/// Density of the noise: 400 ug and 0.005 deg/s over the root of a hertz.
const DENSITY: [f64; 2] = [400e-6 * GRAVITY, 0.005 * PI / 180.0];
/// Measurements in a second, and half of that: the band of white noise.
const SAMPLES_HZ: f64 = 1_000.0;
/// Bandwidth of the filter \[Hz\] by DLPF_CFG: of the accelerometer, of the gyroscope.
const BANDWIDTH: [[f64; 2]; 8] = [
    [260.0, 256.0],
    [184.0, 188.0],
    [94.0, 98.0],
    [44.0, 42.0],
    [21.0, 20.0],
    [10.0, 10.0],
    [5.0, 5.0],
    [260.0, 256.0],
];
/// Of the chip in a room \[degC\].
const TEMPERATURE_C: f64 = 25.0;

const XA_OFFS_H: u8 = 0x06;
const XG_OFFS_USR_H: u8 = 0x13;
/// One count of the offset registers.
const TRIMS: [f64; 2] = [GRAVITY / 4_096.0, 4.0 * RATE];
const SMPLRT_DIV: u8 = 0x19;
const CONFIG: u8 = 0x1A;
const GYRO_CONFIG: u8 = 0x1B;
const ACCEL_CONFIG: u8 = 0x1C;
const INT_PIN_CFG: u8 = 0x37;
const INT_ENABLE: u8 = 0x38;
const INT_STATUS: u8 = 0x3A;
const ACCEL_XOUT_H: u8 = 0x3B;
const GYRO_ZOUT_L: u8 = 0x48;
const USER_CTRL: u8 = 0x6A;
const PWR_MGMT_1: u8 = 0x6B;
const PWR_MGMT_2: u8 = 0x6C;
const BANK_SEL: u8 = 0x6D;
const MEM_R_W: u8 = 0x6F;
const FIFO_R_W: u8 = 0x74;
const WHO_AM_I: u8 = 0x75;
const SLEEP: u8 = 0x40;
const RESET: u8 = 0x80;
const DATA_READY: u8 = 0x01;
/// Bits of USER_CTRL that ask for the motion processor and the FIFO.
const PROCESSOR: u8 = 0xC0;

/// How the robot moves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Motion {
    /// Along its x axis \[m/s\].
    pub(crate) forward_m_s: f64,
    /// Counter-clockwise \[rad/s\].
    pub(crate) yaw_rad_s: f64,
}

/// What the sensor does to its INT output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Interrupt {
    /// It goes to its active level, and back after 50 us.
    Pulse { active: bool },
    /// It has this level.
    Level(bool),
}

/// The sensor.
#[derive(Clone, Debug)]
pub(crate) struct Mpu6050 {
    source: u32,
    /// Where x, y and z point: 1 forward, 2 left, 3 up; negative the opposite.
    axes: [i8; 3],
    registers: [u8; 128],
    pointer: u8,
    /// The next byte written is the number of a register.
    begins: bool,
    before: Option<(u64, Motion)>,
    /// Acceleration and turn rate behind the filter, x, y and z of each \[m/s2, rad/s\].
    filtered: [f64; 6],
    next_us: u64,
    /// The level of INT, where it holds one.
    held: Option<bool>,
    processor: bool,
}

fn after_reset() -> [u8; 128] {
    let mut registers = [0; 128];
    registers[usize::from(PWR_MGMT_1)] = SLEEP;
    registers[usize::from(WHO_AM_I)] = 0x68;
    registers
}

impl Mpu6050 {
    /// The sensor of this number, asleep as after power-on.
    pub(super) fn new(number: u32, axes: [i8; 3]) -> Self {
        Self {
            axes,
            source: source::INERTIAL + SOURCES * number,
            registers: after_reset(),
            pointer: 0,
            begins: false,
            before: None,
            filtered: [0.0; 6],
            next_us: 0,
            held: None,
            processor: false,
        }
    }

    fn register(&self, address: u8) -> u8 {
        self.registers[usize::from(address & 0x7F)]
    }

    /// A transmission begins.
    pub(super) fn address(&mut self) {
        self.begins = true;
    }

    pub(super) fn write(&mut self, byte: u8) {
        if std::mem::take(&mut self.begins) {
            self.pointer = byte & 0x7F;
            return;
        }
        let address = self.pointer;
        self.processor |= (BANK_SEL..=MEM_R_W).contains(&address)
            || address == USER_CTRL && byte & PROCESSOR != 0;
        match address {
            PWR_MGMT_1 if byte & RESET != 0 => self.registers = after_reset(),
            // Read only.
            INT_STATUS..=GYRO_ZOUT_L | WHO_AM_I => {}
            _ => self.registers[usize::from(address)] = byte,
        }
        self.go_on();
    }

    pub(super) fn read(&mut self) -> u8 {
        self.begins = false;
        let address = self.pointer;
        let byte = self.register(address);
        // INT_RD_CLEAR: any reading clears the interrupt.
        if address == INT_STATUS || self.register(INT_PIN_CFG) & 0x10 != 0 {
            self.registers[usize::from(INT_STATUS)] = 0;
        }
        self.go_on();
        byte
    }

    fn go_on(&mut self) {
        if self.pointer != FIFO_R_W {
            self.pointer = (self.pointer + 1) & 0x7F;
        }
    }

    /// Whether it measures.
    fn wakes(&self) -> bool {
        self.register(PWR_MGMT_1) & SLEEP == 0
    }

    /// It measures: `now_us` is a whole millisecond, `at_m` where it is on the robot.
    pub(crate) fn measure(&mut self, motion: Motion, at_m: [f64; 2], now_us: u64, noise: &Noise) {
        let before = self.before.replace((now_us, motion));
        if before.is_some_and(|(before_us, _)| before_us > now_us) {
            // The clock has started over.
            self.next_us = 0;
        }
        let Some((before_us, before)) = before.filter(|_| self.wakes()) else {
            return;
        };
        let dt_s = now_us.saturating_sub(before_us) as f64 * 1e-6;
        if dt_s <= 0.0 {
            return;
        }
        let turn = motion.yaw_rad_s;
        let ahead = (motion.forward_m_s - before.forward_m_s) / dt_s;
        let turning = (turn - before.yaw_rad_s) / dt_s;
        let [x_m, y_m] = at_m;
        let felt = [
            ahead - turning * y_m - turn * turn * x_m,
            motion.forward_m_s * turn + turning * x_m - turn * turn * y_m,
            GRAVITY,
            0.0,
            0.0,
            turn,
        ];
        let axes = [0, 3].map(|from| {
            self.axes.map(|axis| {
                let part: f64 = felt[from + usize::from(axis.unsigned_abs() - 1) % 3];
                f64::from(axis.signum()) * part
            })
        });
        let truth = axes.concat();
        let filter = BANDWIDTH[usize::from(self.register(CONFIG) & 7)];
        for (axis, truth) in truth.into_iter().enumerate() {
            let source = self.source + axis as u32;
            let drawn = |step, tolerated: f64| {
                let normal = noise.normal(source, step) / 3.0;
                tolerated * normal.clamp(-1.0, 1.0)
            };
            let error = drawn(OFFSET, OFFSETS[axis]);
            let density = DENSITY[axis / 3] * libm::sqrt(0.5 * SAMPLES_HZ);
            let measured = truth * (1.0 + drawn(SCALE, SCALES))
                + error
                + self.trim(axis)
                + density * noise.normal(source, now_us);
            let share = 1.0 - libm::exp(-TAU * filter[axis / 3] * dt_s);
            self.filtered[axis] += share * (measured - self.filtered[axis]);
        }
        if now_us >= self.next_us {
            self.next_us = now_us.max(self.next_us + self.period_us());
            self.publish(now_us, noise);
        }
    }

    /// What the offset registers add to an axis; bit 0 of the accelerometer's is none of it.
    fn trim(&self, axis: usize) -> f64 {
        let first = [XA_OFFS_H, XG_OFFS_USR_H][axis / 3];
        let from = usize::from(first) + 2 * (axis % 3);
        let counts = i16::from_be_bytes([self.registers[from], self.registers[from + 1]]);
        let mask = [!1, !0][axis / 3];
        TRIMS[axis / 3] * f64::from(counts & mask)
    }

    /// From one value in the registers to the next.
    fn period_us(&self) -> u64 {
        let fast = matches!(self.register(CONFIG) & 7, 0 | 7);
        (1 + u64::from(self.register(SMPLRT_DIV))) * if fast { 125 } else { 1_000 }
    }

    /// Puts the values into the registers, and asks for an interrupt.
    fn publish(&mut self, now_us: u64, noise: &Noise) {
        let range = |register| self.register(register) >> 3 & 3;
        let ranges = [range(ACCEL_CONFIG), range(GYRO_CONFIG)];
        let scale = [ACCELERATION, RATE];
        let value = |axis: usize| {
            let count = scale[axis / 3] * f64::from(1_u32 << ranges[axis / 3]);
            let off = self.register(PWR_MGMT_2) << 2 & 0x80 >> axis != 0;
            if off {
                0.0
            } else {
                self.filtered[axis] / count
            }
        };
        let noisy = 0.02 * noise.normal(self.source + 6, now_us);
        let degrees = TEMPERATURE_C + noise.normal(self.source + 6, OFFSET) / 3.0 + noisy;
        let temperature = (degrees - 36.53) * 340.0;
        let values = [
            value(0),
            value(1),
            value(2),
            temperature,
            value(3),
            value(4),
            value(5),
        ];
        let from = usize::from(ACCEL_XOUT_H);
        for (index, value) in values.into_iter().enumerate() {
            // A cast saturates.
            let bytes = (value.round() as i16).to_be_bytes();
            self.registers[from + 2 * index..][..2].copy_from_slice(&bytes);
        }
        self.registers[usize::from(INT_STATUS)] |= DATA_READY;
    }

    /// What happens to its INT output after a measurement.
    pub(crate) fn interrupt(&mut self, fresh: bool) -> Option<Interrupt> {
        let pin = self.register(INT_PIN_CFG);
        let active = pin & 0x80 == 0;
        let ready = self.register(INT_STATUS) & DATA_READY != 0
            && self.register(INT_ENABLE) & DATA_READY != 0;
        if pin & 0x20 == 0 {
            let first = self.held.replace(!active) != Some(!active);
            return match ready && fresh {
                true => Some(Interrupt::Pulse { active }),
                false => first.then_some(Interrupt::Level(!active)),
            };
        }
        let level = ready == active;
        (self.held.replace(level) != Some(level)).then_some(Interrupt::Level(level))
    }

    /// When the next value is due \[us\].
    pub(crate) fn next_us(&self) -> u64 {
        self.next_us
    }

    /// What it measures, in the axes of the robot: forward, left and up \[m/s2\], the turn rate \[rad/s\]. Not a number while it
    /// sleeps.
    pub(crate) fn shown(&self) -> [f64; 4] {
        if !self.wakes() {
            return [f64::NAN; 4];
        }
        let mut shown = [0.0; 6];
        for (index, axis) in self.axes.iter().enumerate() {
            for from in [0, 3] {
                let part = f64::from(axis.signum()) * self.filtered[from + index];
                shown[from + usize::from(axis.unsigned_abs() - 1) % 3] = part;
            }
        }
        [0, 1, 2, 5].map(|part| shown[part])
    }

    /// What a program asked for that is not modelled.
    pub(super) fn oddity(&self) -> Option<&'static str> {
        self.processor.then_some(
            "the FIFO and the motion processor (DMP) of the MPU-6050 are not modelled; read its registers instead",
        )
    }
}

#[cfg(test)]
mod tests;
