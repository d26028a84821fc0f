//! Milliseconds and overruns out of a microsecond clock that wraps after 71.6 minutes.
//!
//! The milliseconds wrap after 49.7 days; telemetry carries the lower half of them.

use rumbo_control::{Micros, TICK_US};

/// Counts milliseconds across wraps of the microseconds.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Clock {
    now: Micros,
    started: bool,
    ms: u32,
    rest_us: u32,
    overruns: u8,
}

impl Clock {
    /// Updates with the time of a tick; returns the time since the previous one [us], 0 at the first.
    pub(crate) fn advance(&mut self, now: Micros) -> u32 {
        let elapsed_us = if self.started { now.since(self.now) } else { 0 };
        self.started = true;
        self.now = now;
        // The usual case needs no division, which takes the AVR 40 us.
        let (whole_ms, rest_us) = if elapsed_us == TICK_US {
            (TICK_US / 1_000, self.rest_us + TICK_US % 1_000)
        } else {
            let total_us = self.rest_us.saturating_add(elapsed_us);
            (total_us / 1_000, total_us % 1_000)
        };
        self.ms = self.ms.wrapping_add(whole_ms);
        self.rest_us = rest_us;
        // A tick started late by half a period or more: the one before overran.
        if elapsed_us >= TICK_US + TICK_US / 2 {
            self.overruns = self.overruns.wrapping_add(1);
        }
        elapsed_us
    }

    /// The time of the last tick.
    pub(crate) fn now(&self) -> Micros {
        self.now
    }

    /// Milliseconds since the first tick, wrapping.
    pub(crate) fn ms(&self) -> u32 {
        self.ms
    }

    /// The same as sent in telemetry.
    pub(crate) fn t_ms(&self) -> u16 {
        (self.ms & 0xFFFF) as u16
    }

    /// Ticks that started late, wrapping.
    pub(crate) fn overruns(&self) -> u8 {
        self.overruns
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn milliseconds_go_on_where_microseconds_wrap() {
        let mut clock = Clock::default();
        let start = Micros(u32::MAX - 25_300);
        for n in 0..1_000u32 {
            clock.advance(start.after(n * TICK_US));
            assert_eq!(clock.ms(), n * 10);
        }
        assert_eq!(clock.overruns(), 0);
    }

    #[test]
    fn parts_of_milliseconds_are_not_lost() {
        let mut clock = Clock::default();
        (0..=1_000u32).for_each(|n| {
            clock.advance(Micros(n * 1_700));
        });
        assert_eq!(clock.ms(), 1_700);
    }

    #[test]
    fn milliseconds_go_on_for_an_hour_and_a_half() {
        let mut clock = Clock::default();
        // Ticks as late as they may be; the microseconds wrap once.
        (0..=60_000u32).for_each(|n| {
            clock.advance(Micros(n.wrapping_mul(90_000)));
        });
        assert_eq!((clock.ms(), clock.t_ms()), (5_400_000, 26_048));
    }

    #[test]
    fn a_late_tick_is_counted() {
        let mut clock = Clock::default();
        for us in [0, 10_000, 26_000, 30_000] {
            clock.advance(Micros(us));
        }
        assert_eq!(clock.overruns(), 1);
    }
}
