//! The dividers in front of the timers.

/// A prescaler: timers 0, 1, 3, 4 and 5 share one, timer 2 has its own.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Prescaler {
    /// The cycle in which it last was 0.
    pub(crate) reset: u64,
    pub(crate) held: bool,
}

impl Prescaler {
    /// Its clock stood for some cycles.
    pub(crate) fn delay(&mut self, cycles: u64) {
        self.reset += cycles;
    }

    /// Its ticks in front of `divisor` from the reset to `cycle`.
    pub(crate) fn ticks(self, divisor: u64, cycle: u64) -> u64 {
        cycle.saturating_sub(self.reset) / divisor
    }
}
