//! How much time of the target is due, by the wall clock and the speed factor.

/// Step of the target's time \[us\]; instants at which the truth is noted are multiples of it.
pub const SLICE_US: u64 = 5_000;
/// The most that a late session catches up, in seconds of the wall clock; the rest is dropped.
const CATCH_UP_S: f64 = 0.1;

/// How fast the target's time goes.
#[derive(Clone, Copy, Debug)]
pub struct Pace {
    /// Requested seconds of the target per second of the wall clock.
    pub speed: f64,
    due_us: f64,
    last_us: Option<u64>,
    measured_from_us: Option<u64>,
    lived_us: u64,
    achieved: f64,
}

impl Pace {
    /// At `speed`, with nothing due yet.
    #[must_use]
    pub fn new(speed: f64) -> Self {
        Self {
            speed,
            due_us: 0.0,
            last_us: None,
            measured_from_us: None,
            lived_us: 0,
            achieved: 0.0,
        }
    }

    /// The wall clock says `now_us`.
    pub fn wall_passed(&mut self, now_us: u64) {
        let since = |before_us: u64| now_us.saturating_sub(before_us) as f64 / 1e6;
        let passed_s = self.last_us.map_or(0.0, since);
        self.last_us = Some(now_us);
        self.due_us =
            (self.due_us + passed_s * self.speed * 1e6).min(CATCH_UP_S * self.speed * 1e6);
        let measured_s = since(*self.measured_from_us.get_or_insert(now_us));
        if measured_s >= 1.0 {
            self.achieved = self.lived_us as f64 / 1e6 / measured_s;
            self.measured_from_us = Some(now_us);
            self.lived_us = 0;
        }
    }

    /// Whether the target is to advance by one more slice.
    #[must_use]
    pub fn slice_due(&self) -> bool {
        self.due_us >= SLICE_US as f64
    }

    /// The target advanced by a slice.
    pub fn slice_lived(&mut self) {
        self.due_us -= SLICE_US as f64;
        self.lived_us += SLICE_US;
    }

    /// Seconds of the target per second of the wall clock, over the last second.
    #[must_use]
    pub fn achieved(&self) -> f64 {
        self.achieved
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    fn slices_after(speed: f64, passed_ms: u64) -> u32 {
        let mut pace = Pace::new(speed);
        pace.wall_passed(7);
        pace.wall_passed(7 + 1_000 * passed_ms);
        let mut slices = 0;
        while pace.slice_due() {
            pace.slice_lived();
            slices += 1;
        }
        slices
    }

    #[test]
    fn the_target_lives_as_fast_as_asked_for() {
        assert_eq!(slices_after(1.0, 51), 10);
        assert_eq!(slices_after(4.0, 51), 40);
        assert_eq!(slices_after(0.0, 5_000), 0);
    }

    #[test]
    fn a_session_that_slept_does_not_rush_through_what_it_missed() {
        assert_eq!(slices_after(1.0, 60_000), 20);
    }
}
