//! Connecting, losing and reconnecting: the robot's identity, its clock, and whether it restarted in between.
//!
//! HELLO identifies the robot; it comes both as an answer and after a start. The status that follows carries the number
//! of the start and the time since then: another number, or a time that ran back, is another start, which knows
//! nothing of earlier requests. The robot is connected once both are known.

use rumbo_wire::{Hello, RobotTime};

/// The robot's clock by its latest status.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Clock {
    /// It went on.
    On,
    /// The robot started again.
    Restarted,
    /// It ran back, though the robot counts no start in between.
    Back,
}

/// What is known of the robot so far.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Meeting {
    hello: Option<Hello>,
    /// Its HELLO arrived since it was last lost, and since its last status.
    greeted: bool,
    just_greeted: bool,
    /// The newest time received; kept when it is lost, to detect a restart.
    newest: Option<RobotTime>,
    /// That time is from this connection.
    timed: bool,
    /// It started again since it was last connected.
    restarted: bool,
}

impl Meeting {
    /// Takes its HELLO; returns the one before.
    pub(super) fn greet(&mut self, hello: Hello) -> Option<Hello> {
        (self.greeted, self.just_greeted) = (true, true);
        self.hello.replace(hello)
    }

    /// Takes the time in its status.
    pub(super) fn update(&mut self, at: RobotTime) -> Clock {
        let before = self.newest.replace(at);
        let clock = match before {
            Some(before) if before.start != at.start => Clock::Restarted,
            Some(before) if at.since(before).is_none() => Clock::Back,
            _ => Clock::On,
        };
        if clock != Clock::On {
            self.greeted = self.just_greeted;
            self.restarted = true;
        }
        self.just_greeted = false;
        self.timed = true;
        clock
    }

    /// Takes the lower half of the milliseconds, from telemetry.
    pub(super) fn update_low(&mut self, t_ms: u16) {
        if let Some(newest) = self.newest.as_mut().filter(|_| self.timed) {
            *newest = newest.at_low(t_ms);
        }
    }

    /// It is gone.
    pub(super) fn lose(&mut self) {
        (self.greeted, self.just_greeted, self.timed) = (false, false, false);
    }

    /// Its HELLO, and whether it restarted, as soon as both are known; returned once.
    pub(super) fn complete(&mut self) -> Option<(Hello, bool)> {
        let hello = self.hello.filter(|_| self.greeted && self.timed)?;
        Some((hello, std::mem::take(&mut self.restarted)))
    }

    /// Its HELLO.
    pub(super) fn hello(&self) -> Option<Hello> {
        self.hello
    }

    /// The newest time received.
    pub(super) fn newest(&self) -> RobotTime {
        self.newest.unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rumbo_wire::{PROTOCOL_VERSION, ResetCause};

    const HELLO: Hello = Hello {
        protocol: PROTOCOL_VERSION,
        schema: 0,
        image: 0,
        reset: ResetCause::PowerOn,
    };

    fn at(start: u8, ms: u32) -> RobotTime {
        RobotTime { start, ms }
    }

    #[test]
    fn a_robot_is_connected_once_its_hello_and_its_time_are_known() {
        let mut meeting = Meeting::default();
        assert_eq!(meeting.update(at(3, 100)), Clock::On);
        assert_eq!(meeting.complete(), None);
        meeting.greet(HELLO);
        assert_eq!(meeting.complete(), Some((HELLO, false)));
        meeting.lose();
        meeting.greet(HELLO);
        assert_eq!(meeting.complete(), None);
        assert_eq!(meeting.update(at(3, 9_000)), Clock::On);
        assert_eq!(meeting.complete(), Some((HELLO, false)));
    }

    #[test]
    fn a_start_is_detected_with_its_hello_without_it_and_after_a_silence() {
        for (hello, silent) in [(true, false), (false, false), (true, true)] {
            let mut meeting = Meeting::default();
            meeting.greet(HELLO);
            meeting.update(at(255, 50_000));
            meeting.complete();
            if silent {
                meeting.lose();
            }
            if hello {
                meeting.greet(HELLO);
            }
            assert_eq!(meeting.update(at(0, 60_000)), Clock::Restarted);
            if !hello {
                assert_eq!(meeting.complete(), None);
                meeting.greet(HELLO);
            }
            assert_eq!(meeting.complete(), Some((HELLO, true)));
        }
    }

    #[test]
    fn the_time_goes_on_where_telemetry_wraps_and_a_time_that_runs_back_is_detected() {
        let mut meeting = Meeting::default();
        meeting.update(at(1, 65_500));
        meeting.update_low(4);
        assert_eq!(meeting.newest(), at(1, 65_540));
        assert_eq!(meeting.update(at(1, 65_540)), Clock::On);
        assert_eq!(meeting.update(at(1, 65_539)), Clock::Back);
        assert_eq!(meeting.update(at(1, u32::MAX)), Clock::Back);
        assert_eq!(
            meeting.update(at(1, 5)),
            Clock::On,
            "the wrap after 49.7 days"
        );
    }
}
