//! A QMC5883L by its data sheet (QST, 13-52-04, 9), a [compass](super::compass) of 16 bits. Its output DRDY is not modelled.

use super::compass::Compass;
use rumbo_plant::noise::Noise;

const STATUS: u8 = 0x06;
const CONTROL: u8 = 0x09;
const CONTROL_2: u8 = 0x0A;
const CHIP: u8 = 0x0D;
const REGISTERS: usize = 0x0E;
const READY: u8 = 0x01;
const OVERFLOW: u8 = 0x02;
const SKIPPED: u8 = 0x04;
const ROLLS: u8 = 0x40;
const RESET: u8 = 0x80;
/// Counts of a microtesla: 12000 of a gauss at 2 gauss, 3000 at 8.
const COUNTS: [f64; 2] = [120.0, 30.0];
const PERIODS_US: [u64; 4] = [100_000, 20_000, 10_000, 5_000];

/// The chip.
#[derive(Clone, Debug)]
pub(crate) struct Qmc5883l {
    compass: Compass,
    registers: [u8; REGISTERS],
    pointer: u8,
    /// The next byte written is the number of a register.
    begins: bool,
    next_us: u64,
}

fn after_reset() -> [u8; REGISTERS] {
    let mut registers = [0; REGISTERS];
    registers[usize::from(CHIP)] = 0xFF;
    registers
}

impl Qmc5883l {
    /// In standby, as after power-on.
    pub(super) fn new(compass: Compass) -> Self {
        Self {
            compass,
            registers: after_reset(),
            pointer: 0,
            begins: false,
            next_us: 0,
        }
    }

    fn register(&mut self, at: u8) -> &mut u8 {
        &mut self.registers[usize::from(at) % REGISTERS]
    }

    pub(super) fn begin(&mut self) {
        self.begins = true;
    }

    pub(super) fn write(&mut self, byte: u8) {
        if std::mem::take(&mut self.begins) {
            self.pointer = byte;
            return;
        }
        match self.pointer {
            CONTROL_2 if byte & RESET != 0 => self.registers = after_reset(),
            CONTROL..CHIP => *self.register(self.pointer) = byte,
            // Read only.
            _ => {}
        }
        self.go_on();
    }

    pub(super) fn read(&mut self) -> u8 {
        self.begins = false;
        let at = self.pointer;
        let byte = *self.register(at);
        if at < STATUS {
            *self.register(STATUS) &= OVERFLOW;
        }
        self.go_on();
        byte
    }

    /// From the status it may roll over to the data.
    fn go_on(&mut self) {
        let rolls = *self.register(CONTROL_2) & ROLLS != 0;
        self.pointer = match self.pointer {
            STATUS if rolls => 0,
            at => at.wrapping_add(1),
        };
    }

    /// It measures in whole milliseconds, if it is on; north is so far to the left of ahead \[rad\].
    pub(super) fn measure(&mut self, north_rad: f64, now_us: u64, noise: &Noise) {
        let control = *self.register(CONTROL);
        if control & 0x03 != 0x01 {
            return;
        }
        let period_us = PERIODS_US[usize::from(control >> 2 & 3)];
        // The clock may have started over.
        if now_us < self.next_us && self.next_us - now_us <= period_us {
            return;
        }
        self.next_us = now_us + period_us;
        // Each halving of the 512 samples makes it noisier.
        let noisy = libm::sqrt(f64::from(1_u32 << (control >> 6)));
        let counts = COUNTS[usize::from(control >> 4 & 1)];
        let field = self.compass.measure(north_rad, now_us, noise, noisy);
        let values = field.map(|part| (part * counts).round());
        let limit = f64::from(i16::MAX);
        let overflows = values.iter().any(|value| value.abs() > limit);
        // A cast saturates.
        let bytes = values.map(|value| (value as i16).to_le_bytes()).concat();
        self.registers[..6].copy_from_slice(&bytes);
        let before = *self.register(STATUS) & READY;
        *self.register(STATUS) =
            READY | if overflows { OVERFLOW } else { 0 } | if before != 0 { SKIPPED } else { 0 };
    }

    /// Where it points by what it measured last, clockwise from magnetic north \[rad\].
    pub(super) fn azimuth_rad(&self) -> f64 {
        self.compass.azimuth_rad()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    fn set(chip: &mut Qmc5883l, register: u8, value: u8) {
        chip.begin();
        chip.write(register);
        chip.write(value);
    }

    fn values(chip: &mut Qmc5883l, register: u8, count: usize) -> Vec<u8> {
        chip.begin();
        chip.write(register);
        chip.begin();
        (0..count).map(|_| chip.read()).collect()
    }

    fn field(chip: &mut Qmc5883l) -> [f64; 3] {
        let bytes = values(chip, 0, 6);
        [0, 2, 4].map(|at| f64::from(i16::from_le_bytes([bytes[at], bytes[at + 1]])))
    }

    fn chip(axes: [i8; 3]) -> Qmc5883l {
        Qmc5883l::new(Compass::new(0, axes, [0.0; 2]))
    }

    #[test]
    fn it_stands_by_until_it_is_set_and_then_measures_at_its_rate() {
        let noise = Noise::new(1, 0);
        let mut chip = chip([1, 2, 3]);
        chip.measure(0.0, 0, &noise);
        assert_eq!(field(&mut chip), [0.0; 3]);
        set(&mut chip, CONTROL, 0x05);
        let ready = (0..1_000).filter(|ms| {
            chip.measure(0.0, ms * 1_000, &noise);
            let ready = values(&mut chip, STATUS, 1)[0] & READY != 0;
            field(&mut chip);
            ready
        });
        assert_eq!(ready.count(), 50);
        chip.measure(0.0, 2_000_000, &noise);
        chip.measure(0.0, 2_100_000, &noise);
        assert_eq!(values(&mut chip, STATUS, 1), [READY | SKIPPED]);
        assert_eq!(values(&mut chip, CHIP, 1), [0xFF]);
        set(&mut chip, CONTROL_2, ROLLS);
        let (first, rolled) = (values(&mut chip, 0, 1)[0], values(&mut chip, STATUS, 2)[1]);
        assert_eq!(first, rolled);
        set(&mut chip, CONTROL_2, RESET);
        assert_eq!(field(&mut chip), [0.0; 3]);
    }

    #[test]
    fn north_is_where_the_robot_does_not_look_and_the_field_points_down() {
        let noise = Noise::new(3, 0);
        for (range, counts) in [(0x00, 120.0), (0x10, 30.0)] {
            // Upright: its x looks up, its z backward.
            for (axes, way) in [([1, 2, 3], [0, 1, 2]), ([3, 2, -1], [2, 1, 0])] {
                let mut chip = chip(axes);
                set(&mut chip, CONTROL, 0x0D | range);
                chip.measure(FRAC_PI_2, 0, &noise);
                let read = field(&mut chip).map(|value| value / counts);
                let part = |part: usize| f64::from(axes[way[part]].signum()) * read[way[part]];
                assert!(part(0).abs() < 2.0, "{read:?}");
                assert!((part(1) - 25.0).abs() < 3.0, "{read:?}");
                assert!((part(2) + 40.0).abs() < 4.0, "{read:?}");
                // Heading east.
                assert!((chip.azimuth_rad() - FRAC_PI_2).abs() < 0.1);
            }
        }
    }
}
