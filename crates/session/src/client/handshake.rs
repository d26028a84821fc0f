//! Connecting, losing and reconnecting: the robot's identity, its clock, and whether it restarted in between.
//!
//! HELLO identifies the robot; it comes both as an answer and after a start. The status that follows carries the number
//! of the start and the time since then: another number, or a time that ran back, is another start, which knows
//! nothing of earlier requests. The robot is connected once both are known.

use rumbo_wire::{Hello, RobotTime};

/// The robot's clock by its latest status.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Clock {
    /// It advanced.
    On,
    /// The robot started again.
    Restarted,
    /// It ran back, though the robot counts no start in between.
    Back,
}

/// What is known of the robot so far.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Handshake {
    hello: Option<Hello>,
    /// Its HELLO arrived: since it was last lost, and since its last status.
    answered: bool,
    just_answered: bool,
    /// The newest time received; kept when it is lost, to detect a restart.
    newest: Option<RobotTime>,
    /// That time is from this connection.
    timed: bool,
    /// It started again since it was last connected.
    restarted: bool,
}

impl Handshake {
    /// Its HELLO arrived; returns the one before.
    pub(super) fn hello_received(&mut self, hello: Hello) -> Option<Hello> {
        (self.answered, self.just_answered) = (true, true);
        self.hello.replace(hello)
    }

    /// Its status arrived, with this time.
    pub(super) fn update(&mut self, at: RobotTime) -> Clock {
        let before = self.newest.replace(at);
        let clock = match before {
            Some(before) if before.start != at.start => Clock::Restarted,
            Some(before) if at.since(before).is_none() => Clock::Back,
            _ => Clock::On,
        };
        if clock != Clock::On {
            self.answered = self.just_answered;
            self.restarted = true;
        }
        self.just_answered = false;
        self.timed = true;
        clock
    }

    /// Telemetry arrived, with the lower half of the milliseconds.
    pub(super) fn update_low(&mut self, t_ms: u16) {
        if let Some(newest) = self.newest.as_mut().filter(|_| self.timed) {
            *newest = newest.at_low(t_ms);
        }
    }

    /// The robot is lost.
    pub(super) fn reset(&mut self) {
        (self.answered, self.just_answered, self.timed) = (false, false, false);
    }

    /// Its HELLO, and whether it restarted, as soon as both are known; returned once.
    pub(super) fn complete(&mut self) -> Option<(Hello, bool)> {
        let hello = self.hello.filter(|_| self.answered && self.timed)?;
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
        let mut handshake = Handshake::default();
        assert_eq!(handshake.update(at(3, 100)), Clock::On);
        assert_eq!(handshake.complete(), None);
        handshake.hello_received(HELLO);
        assert_eq!(handshake.complete(), Some((HELLO, false)));
        handshake.reset();
        handshake.hello_received(HELLO);
        assert_eq!(handshake.complete(), None);
        assert_eq!(handshake.update(at(3, 9_000)), Clock::On);
        assert_eq!(handshake.complete(), Some((HELLO, false)));
    }

    #[test]
    fn a_start_is_detected_with_its_hello_without_it_and_after_a_silence() {
        for (hello, silent) in [(true, false), (false, false), (true, true)] {
            let mut handshake = Handshake::default();
            handshake.hello_received(HELLO);
            handshake.update(at(255, 50_000));
            handshake.complete();
            if silent {
                handshake.reset();
            }
            if hello {
                handshake.hello_received(HELLO);
            }
            assert_eq!(handshake.update(at(0, 60_000)), Clock::Restarted);
            if !hello {
                assert_eq!(handshake.complete(), None);
                handshake.hello_received(HELLO);
            }
            assert_eq!(handshake.complete(), Some((HELLO, true)));
        }
    }

    #[test]
    fn the_time_goes_on_where_telemetry_wraps_and_a_time_that_runs_back_is_detected() {
        let mut handshake = Handshake::default();
        handshake.update(at(1, 65_500));
        handshake.update_low(4);
        assert_eq!(handshake.newest(), at(1, 65_540));
        assert_eq!(handshake.update(at(1, 65_540)), Clock::On);
        assert_eq!(handshake.update(at(1, 65_539)), Clock::Back);
        assert_eq!(handshake.update(at(1, u32::MAX)), Clock::Back);
        assert_eq!(
            handshake.update(at(1, 5)),
            Clock::On,
            "the wrap after 49.7 days"
        );
    }
}
