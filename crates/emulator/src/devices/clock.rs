//! The system clock: the crystal's over a divisor that CLKPR sets (2549Q, section 10.12).
//!
//! CPU and peripherals count cycles of the system clock. Everything with a separate clock, and everything outside,
//! counts cycles of the crystal, here called time. Without a divisor, the default on a Mega, both are the same.

/// Conversion between cycles and time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Clock {
    /// A cycle, and the time when it began.
    cycle: u64,
    time: u64,
    divisor: u64,
}

impl Default for Clock {
    fn default() -> Clock {
        Clock {
            cycle: 0,
            time: 0,
            divisor: 1,
        }
    }
}

impl Clock {
    /// The time of a cycle; of one before the last change, as if nothing had changed.
    pub(crate) fn time(self, cycle: u64) -> u64 {
        match cycle.checked_sub(self.cycle) {
            Some(since) => self.time.saturating_add(since.saturating_mul(self.divisor)),
            None => self.time.saturating_sub(self.cycle - cycle),
        }
    }

    /// The first cycle that begins at a time or after it.
    pub(crate) fn cycle(self, time: u64) -> u64 {
        match time.checked_sub(self.time) {
            Some(since) => self.cycle.saturating_add(since.div_ceil(self.divisor)),
            None => self.cycle.saturating_sub(self.time - time),
        }
    }

    /// Cycles in a span of time.
    pub(crate) fn cycles(self, span: u64) -> u64 {
        span.div_ceil(self.divisor)
    }

    /// The crystal's cycles in one.
    pub(crate) fn divisor(self) -> u64 {
        self.divisor
    }

    /// The divisor is another one from `cycle` on.
    pub(crate) fn set_divisor(&mut self, divisor: u64, cycle: u64) {
        *self = Clock {
            cycle,
            time: self.time(cycle),
            divisor,
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_and_cycles_are_the_same_until_they_are_divided() {
        let mut clock = Clock::default();
        assert_eq!([clock.time(1_000), clock.cycle(1_000)], [1_000; 2]);
        clock.set_divisor(8, 1_000);
        assert_eq!([clock.time(1_001), clock.cycle(1_008)], [1_008, 1_001]);
        assert_eq!([clock.cycle(1_009), clock.cycle(1_016)], [1_002; 2]);
        assert_eq!(clock.time(990), 990);
        clock.set_divisor(1, 1_100);
        assert_eq!([clock.time(1_101), clock.cycle(1_801)], [1_801, 1_101]);
    }
}
