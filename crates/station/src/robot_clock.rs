//! The robot's clock in the station's time: `t_ms` wraps after 65.5 s and may start anywhere.

/// Turns the robot's wrapping milliseconds into the session's time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RobotClock {
    /// Session time at the robot's time 0 \[ms\]; `None` until the first frame of a robot whose start is not known.
    offset_ms: Option<i64>,
}

impl RobotClock {
    /// The clock of a simulated robot: started with the session.
    pub(crate) const STARTED_WITH_SESSION: Self = Self { offset_ms: Some(0) };
    /// The clock of a robot that has been running for an unknown time.
    pub(crate) const UNKNOWN: Self = Self { offset_ms: None };

    /// Session time \[ms\] of a robot time that arrived at `now_ms`.
    ///
    /// Right while the frame is less than half a wrap (32 s) old. The first frame of a robot with an unknown start counts as
    /// fresh, so all its times are late by that frame's way over the link.
    pub(crate) fn session_ms(&mut self, t_ms: u16, now_ms: i64) -> i64 {
        let offset_ms = *self.offset_ms.get_or_insert(now_ms - i64::from(t_ms));
        let expected_ms = now_ms - offset_ms;
        // The distance from the expected time, wrapped to -32768..=32767 by the type.
        let difference_ms = t_ms.wrapping_sub(low_word(expected_ms)).cast_signed();
        offset_ms + expected_ms + i64::from(difference_ms)
    }
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
            assert_eq!(clock.session_ms(low_word(sent_ms), sent_ms + 45), sent_ms);
        }
    }

    #[test]
    fn a_robot_that_runs_already_is_placed_at_its_first_frame() {
        let mut clock = RobotClock::UNKNOWN;
        assert_eq!(clock.session_ms(65_530, 1_000), 1_000);
        assert_eq!(clock.session_ms(34, 1_050), 1_040);
        assert_eq!(clock.session_ms(10, 1_051), 1_016);
    }
}
