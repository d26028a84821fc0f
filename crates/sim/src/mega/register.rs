//! The 74HC595 of a motor shield: what is shifted in bit by bit comes to its outputs with the latch.

/// The register; its lines are latch, clock, data and enable, as [`Wires::register`](super::pins::Wires::register).
#[derive(Clone, Copy, Debug)]
pub(super) struct Register {
    levels: [bool; 4],
    shifted: u8,
    latched: u8,
}

const LATCH: usize = 0;
const CLOCK: usize = 1;
const DATA: usize = 2;
const ENABLE: usize = 3;

impl Default for Register {
    /// A resistor of the shield holds enable high, so that its outputs are off.
    fn default() -> Self {
        Self {
            levels: [false, false, false, true],
            shifted: 0,
            latched: 0,
        }
    }
}

impl Register {
    /// A line has this level from now on.
    pub(super) fn set(&mut self, line: usize, high: bool) {
        let rises = high && !self.levels[line];
        self.levels[line] = high;
        match line {
            LATCH if rises => self.latched = self.shifted,
            CLOCK if rises => self.shifted = self.shifted << 1 | u8::from(self.levels[DATA]),
            _ => {}
        }
    }

    /// The levels of its outputs, QA lowest; low while they are off.
    pub(super) fn outputs(&self) -> u8 {
        if self.levels[ENABLE] { 0 } else { self.latched }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_bit_comes_to_the_last_output_with_the_latch_while_enable_is_low() {
        let mut register = Register::default();
        for bit in (0..8).rev() {
            register.set(DATA, 0x25 >> bit & 1 != 0);
            register.set(CLOCK, true);
            register.set(CLOCK, false);
        }
        register.set(ENABLE, false);
        assert_eq!(register.outputs(), 0);
        register.set(LATCH, true);
        assert_eq!(register.outputs(), 0x25);
        register.set(CLOCK, true);
        assert_eq!(register.outputs(), 0x25);
        register.set(ENABLE, true);
        assert_eq!(register.outputs(), 0);
    }
}
