//! How much time of the target is due, by the wall clock and the speed factor.

use std::time::Instant;

/// Step of the target's time \[us\]; instants at which the truth is noted are multiples of it.
pub(crate) const SLICE_US: u64 = 5_000;
/// Target time that a late session still catches up with, in seconds of the wall clock; more is let go.
const CATCH_UP_S: f64 = 0.1;

/// How fast the target's time goes.
#[derive(Debug)]
pub(crate) struct Pace {
    pub(crate) speed: f64,
    due_us: f64,
    last: Option<Instant>,
    measured_from: Option<Instant>,
    lived_us: u64,
    achieved: f64,
}

impl Pace {
    /// At `speed`, with nothing due yet.
    pub(crate) fn new(speed: f64) -> Self {
        Self {
            speed,
            due_us: 0.0,
            last: None,
            measured_from: None,
            lived_us: 0,
            achieved: 0.0,
        }
    }

    /// The wall clock says `now`.
    pub(crate) fn wall_passed(&mut self, now: Instant) {
        let passed_s = self.last.map_or(0.0, |last| (now - last).as_secs_f64());
        self.last = Some(now);
        self.due_us =
            (self.due_us + passed_s * self.speed * 1e6).min(CATCH_UP_S * self.speed * 1e6);
        let from = *self.measured_from.get_or_insert(now);
        let measured_s = (now - from).as_secs_f64();
        if measured_s >= 1.0 {
            self.achieved = self.lived_us as f64 / 1e6 / measured_s;
            self.measured_from = Some(now);
            self.lived_us = 0;
        }
    }

    /// The target is to live for one more slice.
    pub(crate) fn slice_due(&self) -> bool {
        self.due_us >= SLICE_US as f64
    }

    /// The target lived for a slice.
    pub(crate) fn slice_lived(&mut self) {
        self.due_us -= SLICE_US as f64;
        self.lived_us += SLICE_US;
    }

    /// Seconds of the target per second of the wall clock, over the last second.
    pub(crate) fn achieved(&self) -> f64 {
        self.achieved
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    fn slices_after(speed: f64, passed: Duration) -> u32 {
        let start = Instant::now();
        let mut pace = Pace::new(speed);
        pace.wall_passed(start);
        pace.wall_passed(start + passed);
        let mut slices = 0;
        while pace.slice_due() {
            pace.slice_lived();
            slices += 1;
        }
        slices
    }

    #[test]
    fn the_target_lives_as_fast_as_asked_for() {
        assert_eq!(slices_after(1.0, Duration::from_millis(51)), 10);
        assert_eq!(slices_after(4.0, Duration::from_millis(51)), 40);
        assert_eq!(slices_after(0.0, Duration::from_secs(5)), 0);
    }

    #[test]
    fn a_session_that_slept_does_not_rush_through_what_it_missed() {
        assert_eq!(slices_after(1.0, Duration::from_secs(60)), 20);
    }
}
