//! The robot's clock in the station's time: `t_ms` wraps after 65.5 s, may start anywhere, and has its own resonator.
//!
//! Every frame gives the difference of the two clocks plus its delay on the link. The frame with the least delay is
//! the most accurate, so the smallest difference of the last seconds counts, less half the shortest round trip, which
//! is about the delay of that frame. The resonator of an Arduino may be off by 0.5 %: the difference drifts by up to 5
//! ms per second, and is tracked.

/// The smallest difference is of the last one to two windows of this length \[ms\].
const WINDOW_MS: i64 = 2_000;
/// Largest change of the offset per frame, so that frames 40 ms apart keep their order \[ms\].
const STEP_MS: i64 = 10;
/// Drift is reported after this long \[ms\].
const DRIFT_AFTER_MS: i64 = 10_000;

/// The difference of the clocks.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Difference {
    /// Session time at the robot's time 0, as used now \[ms\].
    offset_ms: i64,
    /// The smallest difference of the window before and of this one, delay included \[ms\].
    before_ms: i64,
    now_ms: i64,
    window_began_ms: i64,
    /// When the first whole window was over, and the smallest difference then \[ms\].
    first: Option<(i64, i64)>,
}

/// Turns the robot's wrapping milliseconds into the session's time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RobotClock {
    /// The robot's clock started with the session: there is nothing to estimate.
    known: bool,
    difference: Option<Difference>,
}

impl RobotClock {
    /// The clock of a simulated robot: started with the session.
    pub(crate) const STARTED_WITH_SESSION: Self = Self {
        known: true,
        difference: None,
    };
    /// The clock of a robot that has been running for an unknown time.
    pub(crate) const UNKNOWN: Self = Self {
        known: false,
        difference: None,
    };

    /// Session time \[ms\] of a robot time that arrived at `now_ms` after about `way_ms` on the link.
    ///
    /// Right while the frame is less than half a wrap (32 s) old.
    pub(crate) fn session_ms(&mut self, t_ms: u16, now_ms: i64, way_ms: i64) -> i64 {
        if self.known {
            return unwrapped(t_ms, now_ms);
        }
        let first_ms = now_ms - i64::from(t_ms);
        let difference = self.difference.get_or_insert(Difference {
            offset_ms: first_ms - way_ms,
            before_ms: i64::MAX,
            now_ms: i64::MAX,
            window_began_ms: now_ms,
            first: None,
        });
        let robot_ms = unwrapped(t_ms, now_ms - difference.offset_ms);
        difference.measured(now_ms - robot_ms, now_ms, way_ms);
        difference.offset_ms + robot_ms
    }

    /// Session time at the robot's time 0 \[ms\]; `None` before the first frame, and where the clocks are one.
    pub(crate) fn offset_ms(&self) -> Option<i64> {
        self.difference.map(|difference| difference.offset_ms)
    }

    /// By how much the robot's clock is fast, in millionths; `None` before that is known.
    pub(crate) fn fast_ppm(&self, now_ms: i64) -> Option<i64> {
        let difference = self.difference?;
        let (since_ms, smallest_ms) = difference.first?;
        let passed_ms = now_ms - since_ms;
        (passed_ms >= DRIFT_AFTER_MS)
            .then(|| (smallest_ms - difference.smallest_ms()) * 1_000_000 / passed_ms)
    }
}

impl Difference {
    fn smallest_ms(&self) -> i64 {
        self.before_ms.min(self.now_ms)
    }

    /// Updates with the difference that a frame gives.
    fn measured(&mut self, difference_ms: i64, now_ms: i64, way_ms: i64) {
        if now_ms >= self.window_began_ms + WINDOW_MS {
            if self.now_ms != i64::MAX {
                self.first.get_or_insert((now_ms, self.now_ms));
            }
            (self.before_ms, self.now_ms) = (self.now_ms, i64::MAX);
            self.window_began_ms = now_ms;
        }
        self.now_ms = self.now_ms.min(difference_ms);
        let wanted_ms = self.smallest_ms() - way_ms;
        self.offset_ms += (wanted_ms - self.offset_ms).clamp(-STEP_MS, STEP_MS);
    }
}

/// The time nearest to the expected one whose lowest 16 bits these are.
fn unwrapped(t_ms: u16, expected_ms: i64) -> i64 {
    // The distance from the expected time, wrapped to -32768..=32767 by the type.
    expected_ms + i64::from(t_ms.wrapping_sub(low_word(expected_ms)).cast_signed())
}

/// The lowest 16 bits, as the robot counts.
fn low_word(ms: i64) -> u16 {
    (ms & 0xFFFF) as u16
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_goes_on_across_the_wrap() {
        let mut clock = RobotClock::STARTED_WITH_SESSION;
        for sent_ms in (0..200_000i64).step_by(40) {
            assert_eq!(
                clock.session_ms(low_word(sent_ms), sent_ms + 45, 0),
                sent_ms
            );
        }
        assert_eq!(clock.offset_ms(), None);
    }

    #[test]
    fn a_robot_that_runs_already_is_synchronised_at_its_first_frame() {
        let mut clock = RobotClock::UNKNOWN;
        assert_eq!(clock.session_ms(65_530, 1_000, 0), 1_000);
        assert_eq!(clock.session_ms(34, 1_040, 0), 1_040);
        // An event that is older than the telemetry before it.
        assert_eq!(clock.session_ms(10, 1_051, 0), 1_016);
    }

    /// Frames of a robot whose clock is fast by some millionths and started 3,210 ms before the session, each delayed
    /// by 30 to 120 ms. Returns the worst error of the times after the first seconds \[ms\], the final offset and
    /// drift.
    fn followed(fast_ppm: i64, minutes: i64) -> (i64, i64, i64) {
        let mut clock = RobotClock::UNKNOWN;
        let mut worst_ms = 0;
        let mut last_ms = i64::MIN;
        let end_ms = minutes * 60_000;
        for sent_ms in (0..end_ms).step_by(40) {
            let robot_ms = 3_210 + sent_ms + sent_ms * fast_ppm / 1_000_000;
            let late_ms = (sent_ms / 40 * 7_919) % 91;
            let session_ms = clock.session_ms(low_word(robot_ms), sent_ms + 30 + late_ms, 30);
            assert!(session_ms > last_ms, "{session_ms} after {last_ms}");
            last_ms = session_ms;
            if sent_ms > 5_000 {
                worst_ms = worst_ms.max((session_ms - sent_ms).abs());
            }
        }
        let offset_ms = clock.offset_ms().unwrap();
        (worst_ms, offset_ms, clock.fast_ppm(end_ms).unwrap())
    }

    #[test]
    fn a_clock_that_is_wrong_by_half_a_percent_is_followed_within_25_ms() {
        for fast_ppm in [-5_000, -200, 0, 5_000] {
            let (worst_ms, _, measured_ppm) = followed(fast_ppm, 4);
            assert!(worst_ms <= 25, "{fast_ppm}: {worst_ms} ms");
            assert!(
                (measured_ppm - fast_ppm).abs() <= 100,
                "{fast_ppm}: {measured_ppm}"
            );
        }
        let (_, offset_ms, _) = followed(0, 1);
        assert!(
            (offset_ms.rem_euclid(65_536) - (65_536 - 3_210)).abs() <= 5,
            "{offset_ms}"
        );
    }
}
