//! The clock of a USART: the baud rate generator and what it is divided by (2549Q, section 22.3).
//!
//! The generator runs freely from the cycle in which UBRR was last written. The transmitter begins bits where 16 (8, 2) of
//! its ticks have passed, the receiver samples at each of them.

/// When the ticks of the generator and the bits of the transmitter are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Rate {
    /// A cycle with a tick that begins a bit.
    pub(super) origin: u64,
    /// Cycles from tick to tick.
    pub(super) tick: u64,
    /// Ticks of a bit; two in a synchronous mode.
    pub(super) per_bit: u64,
}

impl Rate {
    /// Cycles of a bit.
    pub(super) fn bit(self) -> u64 {
        self.tick * self.per_bit
    }

    /// The first tick at or after `cycle`.
    pub(super) fn next_tick(self, cycle: u64) -> u64 {
        self.next(cycle, self.tick)
    }

    /// The first beginning of a bit at or after `cycle`.
    pub(super) fn next_bit(self, cycle: u64) -> u64 {
        self.next(cycle, self.bit())
    }

    /// A bit begins with the tick in this cycle.
    pub(super) fn begins_bit(self, cycle: u64) -> bool {
        cycle.saturating_sub(self.origin).is_multiple_of(self.bit())
    }

    fn next(self, cycle: u64, step: u64) -> u64 {
        self.origin + cycle.saturating_sub(self.origin).div_ceil(step) * step
    }

    /// Ticks from the first low sample of a start bit to the three that decide about it: samples 8, 9 and 10, or 4, 5 and 6 at
    /// double speed (section 22.7.2).
    pub(super) const fn votes(self) -> &'static [u64] {
        match self.per_bit {
            16 => &[7, 8, 9],
            _ => &[3, 4, 5],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_and_bits_count_from_the_origin() {
        let rate = Rate {
            origin: 100,
            tick: 208,
            per_bit: 8,
        };
        assert_eq!(rate.bit(), 1664);
        assert_eq!([rate.next_tick(100), rate.next_tick(101)], [100, 308]);
        assert_eq!([rate.next_bit(99), rate.next_bit(101)], [100, 1764]);
    }
}
