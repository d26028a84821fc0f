//! A PCA9685 (NXP, revision 4), as it drives the motors of a shield: 16 outputs, each with a PWM of 12 bits. What is written
//! comes to the outputs at the end of a transmission.

/// Cycles of the board's crystal in one of its own, of 25 MHz.
const OWN_CYCLE: f64 = 16.0 / 25.0;
/// Steps of a period.
const STEPS: u16 = 4_096;
const OUTPUTS: usize = 16;

const MODE1: u8 = 0x00;
const FIRST: u8 = 0x06;
const ALL: u8 = 0xFA;
const PRE_SCALE: u8 = 0xFE;
const SLEEP: u8 = 0x10;
const AUTO_INCREMENT: u8 = 0x20;
const RESTART: u8 = 0x80;
/// In the upper byte of a count: on, or off, all the time.
const FULL: u16 = 0x1000;

/// The chip.
#[derive(Clone, Debug)]
pub(crate) struct Pca9685 {
    registers: [u8; 256],
    pointer: u8,
    begins: bool,
}

impl Pca9685 {
    /// Asleep, with all outputs off, as after power-on.
    pub(super) fn new() -> Self {
        let mut registers = [0; 256];
        registers[usize::from(MODE1)] = SLEEP | 1;
        registers[1] = 4;
        registers[usize::from(PRE_SCALE)] = 0x1E;
        for output in 0..OUTPUTS {
            registers[usize::from(FIRST) + 4 * output + 3] = 0x10;
        }
        Self {
            registers,
            pointer: 0,
            begins: false,
        }
    }

    /// A transmission begins.
    pub(super) fn address(&mut self) {
        self.begins = true;
    }

    pub(super) fn write(&mut self, byte: u8) {
        if std::mem::take(&mut self.begins) {
            self.pointer = byte;
            return;
        }
        let address = self.pointer;
        match address {
            // Only while it sleeps.
            PRE_SCALE if self.registers[usize::from(MODE1)] & SLEEP == 0 => {}
            PRE_SCALE => self.registers[usize::from(address)] = byte.max(3),
            MODE1 => self.registers[usize::from(address)] = byte & !RESTART,
            ALL..PRE_SCALE => {
                for output in 0..OUTPUTS {
                    let at = usize::from(FIRST) + 4 * output + usize::from(address - ALL);
                    self.registers[at] = byte;
                }
            }
            _ => self.registers[usize::from(address)] = byte,
        }
        self.go_on();
    }

    pub(super) fn read(&mut self) -> u8 {
        self.begins = false;
        let byte = self.registers[usize::from(self.pointer)];
        self.go_on();
        byte
    }

    fn go_on(&mut self) {
        if self.registers[usize::from(MODE1)] & AUTO_INCREMENT != 0 {
            self.pointer = self.pointer.wrapping_add(1);
        }
    }

    /// The share of the time for which an output is high.
    pub(crate) fn share(&self, output: u8) -> f64 {
        if self.registers[usize::from(MODE1)] & SLEEP != 0 {
            return 0.0;
        }
        let at = usize::from(FIRST) + 4 * (usize::from(output) % OUTPUTS);
        let count = |at: usize| u16::from_le_bytes([self.registers[at], self.registers[at + 1]]);
        let (on, off) = (count(at), count(at + 2));
        if off & FULL != 0 {
            return 0.0;
        }
        if on & FULL != 0 {
            return 1.0;
        }
        f64::from(off.wrapping_sub(on) % STEPS) / f64::from(STEPS)
    }

    /// Its period, in cycles of the board's crystal.
    pub(crate) fn period_cycles(&self) -> u64 {
        let scale = 1 + u32::from(self.registers[usize::from(PRE_SCALE)]);
        (f64::from(u32::from(STEPS) * scale) * OWN_CYCLE) as u64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn set(chip: &mut Pca9685, bytes: &[u8]) {
        chip.address();
        bytes.iter().for_each(|byte| chip.write(*byte));
    }

    #[test]
    fn outputs_have_the_share_between_their_counts_once_it_is_awake() {
        let mut chip = Pca9685::new();
        set(&mut chip, &[MODE1, SLEEP | AUTO_INCREMENT]);
        set(&mut chip, &[PRE_SCALE, 3]);
        set(&mut chip, &[FIRST + 4 * 8, 0, 0, 0x00, 0x04]);
        assert_eq!(chip.share(8), 0.0, "asleep");
        set(&mut chip, &[MODE1, AUTO_INCREMENT]);
        set(&mut chip, &[PRE_SCALE, 30]);
        assert_eq!(chip.share(8), 0.25);
        assert_eq!(chip.share(9), 0.0);
        // 25 MHz over 4 and 4096: 1526 Hz.
        assert_eq!(chip.period_cycles(), 10_485);
        for (counts, share) in [
            ([0, 0x10, 0, 0], 1.0),
            ([0, 0, 0, 0x10], 0.0),
            ([0, 0, 0, 0], 0.0),
            ([0, 0x0C, 0, 0x04], 0.5),
        ] {
            set(&mut chip, &[&[ALL][..], &counts].concat());
            assert_eq!(chip.share(15), share, "{counts:?}");
        }
    }
}
