//! An HMC5883L by its data sheet (Honeywell, 900405), a [compass](super::compass) of 12 bits. Its output DRDY is not modelled.

use super::compass::Compass;
use rumbo_plant::noise::Noise;

const CONFIG_A: u8 = 0x00;
const CONFIG_B: u8 = 0x01;
const MODE: u8 = 0x02;
const DATA: u8 = 0x03;
const STATUS: u8 = 0x09;
const REGISTERS: usize = 0x0D;
const CONTINUOUS: u8 = 0;
const SINGLE: u8 = 1;
const IDLE: u8 = 2;
const READY: u8 = 1;
/// Counts of a gauss by the gain, and what a channel gives that overflows.
const COUNTS: [f64; 8] = [1370.0, 1090.0, 820.0, 660.0, 440.0, 390.0, 330.0, 230.0];
const OVERFLOW: i16 = -4096;
/// From one value to the next by its rate; a single one takes [`SINGLE_US`].
const PERIODS_US: [u64; 8] = [
    1_333_333, 666_667, 333_333, 133_333, 66_667, 33_333, 13_333, 13_333,
];
const SINGLE_US: u64 = 6_000;
/// What the bias of a self-test adds, x, y and z \[uT\].
const BIAS_UT: [f64; 3] = [116.0, 116.0, 108.0];
const UT_IN_GAUSS: f64 = 100.0;

/// The chip.
#[derive(Clone, Debug)]
pub(crate) struct Hmc5883l {
    compass: Compass,
    registers: [u8; REGISTERS],
    pointer: u8,
    /// The next byte written is the number of a register.
    begins: bool,
    /// When the measurement ends that is under way.
    due_us: Option<u64>,
}

impl Hmc5883l {
    /// As after power-on: one measurement, and then it waits.
    pub(super) fn new(compass: Compass) -> Self {
        let mut registers = [0; REGISTERS];
        registers[..3].copy_from_slice(&[0x10, 0x20, SINGLE]);
        registers[usize::from(STATUS) + 1..].copy_from_slice(b"H43");
        Self {
            compass,
            registers,
            pointer: 0,
            begins: false,
            due_us: None,
        }
    }

    fn register(&self, at: u8) -> u8 {
        self.registers[usize::from(at)]
    }

    pub(super) fn begin(&mut self) {
        self.begins = true;
    }

    pub(super) fn write(&mut self, byte: u8) {
        if std::mem::take(&mut self.begins) {
            self.pointer = byte % REGISTERS as u8;
            return;
        }
        if self.pointer <= MODE {
            self.registers[usize::from(self.pointer)] = byte;
        }
        if self.pointer == MODE {
            self.due_us = None;
        }
        self.go_on();
    }

    pub(super) fn read(&mut self) -> u8 {
        self.begins = false;
        let byte = self.register(self.pointer);
        if (DATA..STATUS).contains(&self.pointer) {
            self.registers[usize::from(STATUS)] &= !READY;
        }
        self.go_on();
        byte
    }

    /// Behind the data the data begin again.
    fn go_on(&mut self) {
        self.pointer = match self.pointer + 1 {
            STATUS => DATA,
            next => next % REGISTERS as u8,
        };
    }

    /// It measures in whole milliseconds; north is so far to the left of ahead \[rad\].
    pub(super) fn measure(&mut self, north_rad: f64, now_us: u64, noise: &Noise) {
        let mode = self.register(MODE) & 3;
        let period_us = match mode {
            CONTINUOUS => PERIODS_US[usize::from(self.register(CONFIG_A) >> 2 & 7)],
            SINGLE => SINGLE_US,
            _ => return,
        };
        // The clock may have started over.
        let due_us = self.due_us.unwrap_or(u64::MAX).min(now_us + period_us);
        self.due_us = Some(due_us);
        if now_us < due_us {
            return;
        }
        self.due_us = Some(due_us + period_us);
        if mode == SINGLE {
            self.registers[usize::from(MODE)] = IDLE;
            self.due_us = None;
        }
        let samples = f64::from(1_u32 << (self.register(CONFIG_A) >> 5 & 3));
        let noisy = 1.0 / libm::sqrt(samples);
        let mut field = self.compass.measure(north_rad, now_us, noise, noisy);
        let bias = match self.register(CONFIG_A) & 3 {
            1 => 1.0,
            2 => -1.0,
            _ => 0.0,
        };
        for (part, added) in field.iter_mut().zip(BIAS_UT) {
            *part += bias * added;
        }
        let counts = COUNTS[usize::from(self.register(CONFIG_B) >> 5)] / UT_IN_GAUSS;
        let values = field.map(|part| match (part * counts).round() {
            value if (-2048.0..2048.0).contains(&value) => value as i16,
            _ => OVERFLOW,
        });
        // x, z, y.
        let bytes = [0, 2, 1].map(|axis| values[axis].to_be_bytes()).concat();
        self.registers[usize::from(DATA)..][..6].copy_from_slice(&bytes);
        self.registers[usize::from(STATUS)] |= READY;
    }

    /// Where it points by what it measured last, clockwise from magnetic north \[rad\].
    pub(super) fn azimuth_rad(&self) -> f64 {
        self.compass.azimuth_rad()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn set(chip: &mut Hmc5883l, register: u8, value: u8) {
        chip.begin();
        chip.write(register);
        chip.write(value);
    }

    fn values(chip: &mut Hmc5883l, register: u8, count: usize) -> Vec<u8> {
        chip.begin();
        chip.write(register);
        chip.begin();
        (0..count).map(|_| chip.read()).collect()
    }

    /// x, y, z.
    fn field(chip: &mut Hmc5883l) -> [i16; 3] {
        let bytes = values(chip, DATA, 6);
        [0, 4, 2].map(|at| i16::from_be_bytes([bytes[at], bytes[at + 1]]))
    }

    fn run(chip: &mut Hmc5883l, from_ms: u64, ms: u64) -> usize {
        let noise = Noise::new(2, 0);
        let ready = (from_ms..from_ms + ms).filter(|ms| {
            chip.measure(0.0, ms * 1_000, &noise);
            let ready = values(chip, STATUS, 1)[0] & READY != 0;
            field(chip);
            ready
        });
        ready.count()
    }

    #[test]
    fn it_measures_once_or_at_its_rate_and_says_who_it_is() {
        let mut chip = Hmc5883l::new(Compass::new(0, [1, 2, 3], [0.0; 2]));
        assert_eq!(values(&mut chip, 10, 3), b"H43");
        assert_eq!(run(&mut chip, 0, 100), 1);
        assert_eq!(values(&mut chip, MODE, 1), [IDLE]);
        set(&mut chip, MODE, CONTINUOUS);
        set(&mut chip, CONFIG_A, 0x18);
        assert!((74..=75).contains(&run(&mut chip, 100, 1_000)));
        set(&mut chip, MODE, SINGLE);
        assert_eq!(run(&mut chip, 1_100, 100), 1);
    }

    #[test]
    fn its_counts_are_those_of_the_gain_and_4096_below_zero_tells_of_an_overflow() {
        let mut chip = Hmc5883l::new(Compass::new(0, [1, 2, 3], [10.0, -10.0]));
        let noise = Noise::new(2, 0);
        let mut at_us = 0;
        let mut once = |chip: &mut Hmc5883l, gain: u8, bias: u8| {
            set(chip, CONFIG_A, 0x70 | bias);
            set(chip, CONFIG_B, gain << 5);
            set(chip, MODE, SINGLE);
            for _ in 0..=6 {
                chip.measure(0.0, at_us, &noise);
                at_us += 1_000;
            }
            field(chip)
        };
        for (gain, counts) in COUNTS.into_iter().enumerate() {
            let read = once(&mut chip, gain as u8, 0).map(|value| f64::from(value) / counts);
            for (read, expected) in read.into_iter().zip([0.35, -0.1, -0.4]) {
                assert!((read - expected).abs() < 0.04, "{gain} {read} {expected}");
            }
        }
        let rest = once(&mut chip, 5, 0);
        let tested = once(&mut chip, 5, 1);
        assert!((f64::from(tested[0] - rest[0]) / 390.0 - 1.16).abs() < 0.02);
        assert_eq!(once(&mut chip, 0, 1)[0], OVERFLOW);
    }
}
