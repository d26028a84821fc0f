//! Commands to the robot, one at a time: sent, repeated until acknowledged, applied exactly once.
//!
//! Stop-and-wait: a command leaves only when the one before it was acknowledged, so the robot recognises a repetition by its
//! session and number alone. STOP waits for nobody: it takes the place of whatever is under way and empties the queue,
//! since an operator who stops the robot wants nothing older to happen afterwards. Commands that make the wheels turn are given up
//! after [`MOTION_EXPIRY_US`], so that a link that comes back does not bring an old start with it.
//!
//! The time-out follows the measured round trip as TCP's does (RFC 6298), without samples from repeated commands (Karn).

use rumbo_wire::{Ack, Command, Refusal, ToRobot};
use std::collections::VecDeque;

/// Most commands that wait their turn.
const MAX_WAITING: usize = 64;
/// A command that makes the wheels turn is given up when it has not been acknowledged for this long [us].
pub const MOTION_EXPIRY_US: u64 = 2_000_000;
/// Time-out before a round trip was measured [us]: two telemetry frames and the command at 9600 baud, doubled.
const FIRST_TIMEOUT_US: u64 = 200_000;
/// Limits of the time-out [us]: one telemetry frame at 9600 baud lasts 31 ms and may be under way both before and in the answer.
const TIMEOUT_US: std::ops::RangeInclusive<u64> = 80_000..=1_000_000;

/// What became of a command.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// The command.
    pub command: Command,
    /// Its fate.
    pub fate: Fate,
}

/// How a command ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fate {
    /// Applied; the robot holds this value now (0 where there is none).
    Applied(f32),
    /// Refused by the robot.
    Refused(Refusal),
    /// Given up by the station because STOP came after it; it may or may not have been applied before.
    Superseded,
    /// Given up by the station because no answer came in time; it may or may not have been applied.
    Expired,
    /// Given up by the station because the robot started again.
    RobotRestarted,
}

/// No more than [`MAX_WAITING`] commands may wait.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct QueueFull;

/// The one command under way.
#[derive(Clone, Copy, Debug)]
struct InFlight {
    number: u16,
    command: Command,
    background: bool,
    since_us: u64,
    sends: u32,
    next_send_us: u64,
}

/// Sends commands so that each is applied once.
#[derive(Debug)]
pub struct CommandManager {
    session: u8,
    next_number: u16,
    waiting: VecDeque<Command>,
    background: VecDeque<Command>,
    in_flight: Option<InFlight>,
    round_trip: RoundTrip,
    outcomes: Vec<Outcome>,
}

impl CommandManager {
    /// A manager whose commands carry `session`, which is to be random.
    pub fn new(session: u8) -> Self {
        Self {
            session,
            next_number: 0,
            waiting: VecDeque::new(),
            background: VecDeque::new(),
            in_flight: None,
            round_trip: RoundTrip::default(),
            outcomes: Vec::new(),
        }
    }

    /// Takes a command from the operator.
    ///
    /// # Errors
    /// [`QueueFull`]; never for STOP.
    pub fn submit(&mut self, command: Command, now_us: u64) -> Result<(), QueueFull> {
        if command == Command::Stop {
            self.stop(now_us);
            return Ok(());
        }
        if self.waiting.len() >= MAX_WAITING {
            return Err(QueueFull);
        }
        self.waiting.push_back(command);
        Ok(())
    }

    /// Takes a command that gives way to the operator's: reading the parameters.
    pub fn submit_background(&mut self, command: Command) {
        self.background.push_back(command);
    }

    fn stop(&mut self, now_us: u64) {
        self.give_up_waiting(Fate::Superseded);
        match &mut self.in_flight {
            // Pressed again: the same STOP, at once once more.
            Some(flying) if flying.command == Command::Stop => flying.next_send_us = now_us,
            flying => {
                if let Some(old) = flying.take() {
                    if old.background {
                        self.background.push_front(old.command);
                    } else {
                        self.outcomes.push(Outcome {
                            command: old.command,
                            fate: Fate::Superseded,
                        });
                    }
                }
                self.launch(Command::Stop, false, now_us);
            }
        }
    }

    /// The robot started again: nothing asked of the old one is asked of the new one, except STOP.
    pub fn robot_restarted(&mut self) {
        self.background.clear();
        self.give_up_waiting(Fate::RobotRestarted);
        if let Some(old) = self
            .in_flight
            .take_if(|flying| flying.command != Command::Stop)
            && !old.background
        {
            self.outcomes.push(Outcome {
                command: old.command,
                fate: Fate::RobotRestarted,
            });
        }
    }

    fn give_up_waiting(&mut self, fate: Fate) {
        self.outcomes.extend(
            self.waiting
                .drain(..)
                .map(|command| Outcome { command, fate }),
        );
    }

    fn launch(&mut self, command: Command, background: bool, now_us: u64) {
        let number = self.next_number;
        self.next_number = number.wrapping_add(1);
        self.in_flight = Some(InFlight {
            number,
            command,
            background,
            since_us: now_us,
            sends: 0,
            next_send_us: now_us,
        });
    }

    /// What is to be sent now, if anything. To be called after every step of time.
    pub fn poll(&mut self, now_us: u64) -> Option<ToRobot> {
        if let Some(old) = self.in_flight.take_if(|flying| {
            makes_wheels_turn(&flying.command) && now_us >= flying.since_us + MOTION_EXPIRY_US
        }) {
            self.outcomes.push(Outcome {
                command: old.command,
                fate: Fate::Expired,
            });
        }
        if self.in_flight.is_none() {
            if let Some(command) = self.waiting.pop_front() {
                self.launch(command, false, now_us);
            } else if let Some(command) = self.background.pop_front() {
                self.launch(command, true, now_us);
            }
        }
        let timeout_us = self.round_trip.timeout_us();
        let flying = self.in_flight.as_mut()?;
        if now_us < flying.next_send_us {
            return None;
        }
        // Doubling eases a full link; STOP insists.
        let doublings = if flying.command == Command::Stop {
            0
        } else {
            flying.sends.min(4)
        };
        flying.sends += 1;
        flying.next_send_us = now_us + (timeout_us << doublings).min(*TIMEOUT_US.end());
        Some(ToRobot::Command {
            session: self.session,
            number: flying.number,
            command: flying.command,
        })
    }

    /// Takes an acknowledgement; one of an earlier command or of another session is ignored.
    pub fn acknowledge(&mut self, ack: &Ack, now_us: u64) {
        if ack.session != self.session {
            return;
        }
        let Some(done) = self
            .in_flight
            .take_if(|flying| flying.number == ack.number && flying.sends > 0)
        else {
            return;
        };
        if done.sends == 1 {
            self.round_trip
                .measured(now_us.saturating_sub(done.since_us));
        }
        let fate = match ack.result {
            Ok(value) => Fate::Applied(value),
            Err(refusal) => Fate::Refused(refusal),
        };
        self.outcomes.push(Outcome {
            command: done.command,
            fate,
        });
    }

    /// What ended since the last call.
    pub fn take_outcomes(&mut self) -> Vec<Outcome> {
        std::mem::take(&mut self.outcomes)
    }

    /// Smoothed round trip of a command [us], `None` before the first.
    pub fn round_trip_us(&self) -> Option<u64> {
        self.round_trip.smoothed_us
    }

    /// The operator's commands that are not acknowledged yet.
    pub fn unacknowledged(&self) -> usize {
        self.waiting.len() + usize::from(self.in_flight.is_some_and(|flying| !flying.background))
    }
}

/// A start that arrives late is worse than one that is lost.
fn makes_wheels_turn(command: &Command) -> bool {
    matches!(command, Command::Arm | Command::Move { .. })
}

/// Round trip and its time-out, after RFC 6298.
#[derive(Debug, Default)]
struct RoundTrip {
    smoothed_us: Option<u64>,
    deviation_us: u64,
}

impl RoundTrip {
    fn measured(&mut self, sample_us: u64) {
        match self.smoothed_us {
            None => {
                self.smoothed_us = Some(sample_us);
                self.deviation_us = sample_us / 2;
            }
            Some(smoothed_us) => {
                self.deviation_us = (3 * self.deviation_us + smoothed_us.abs_diff(sample_us)) / 4;
                self.smoothed_us = Some((7 * smoothed_us + sample_us) / 8);
            }
        }
    }

    fn timeout_us(&self) -> u64 {
        let estimate_us = self.smoothed_us.map_or(FIRST_TIMEOUT_US, |smoothed| {
            smoothed + 4 * self.deviation_us
        });
        estimate_us.clamp(*TIMEOUT_US.start(), *TIMEOUT_US.end())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use rumbo_control::mode::ModeId;

    const SESSION: u8 = 7;

    fn number_of(sent: ToRobot) -> u16 {
        match sent {
            ToRobot::Command { number, .. } => number,
            other => panic!("not a command: {other:?}"),
        }
    }

    fn command_of(sent: ToRobot) -> Command {
        match sent {
            ToRobot::Command { command, .. } => command,
            other => panic!("not a command: {other:?}"),
        }
    }

    fn ack(number: u16) -> Ack {
        Ack {
            session: SESSION,
            number,
            result: Ok(0.0),
        }
    }

    #[test]
    fn a_command_is_repeated_with_its_number_until_it_is_acknowledged() {
        let mut manager = CommandManager::new(SESSION);
        manager.submit(Command::Arm, 0).unwrap();
        let first = manager.poll(0).unwrap();
        assert_eq!(manager.poll(FIRST_TIMEOUT_US - 1), None);
        let again = manager.poll(FIRST_TIMEOUT_US).unwrap();
        assert_eq!(first, again);
        manager.acknowledge(&ack(number_of(first)), FIRST_TIMEOUT_US + 50_000);
        assert_eq!(
            manager.take_outcomes(),
            [Outcome {
                command: Command::Arm,
                fate: Fate::Applied(0.0)
            }]
        );
        assert_eq!(manager.poll(10_000_000), None);
    }

    #[test]
    fn the_next_command_waits_for_the_acknowledgement() {
        let mut manager = CommandManager::new(SESSION);
        manager
            .submit(Command::Mode(ModeId::FrontDistance), 0)
            .unwrap();
        manager.submit(Command::Reference(0.5), 0).unwrap();
        let first = manager.poll(0).unwrap();
        assert_eq!(manager.poll(1_000), None);
        manager.acknowledge(&ack(number_of(first)), 60_000);
        let second = manager.poll(60_000).unwrap();
        assert_eq!(command_of(second), Command::Reference(0.5));
        assert_ne!(number_of(first), number_of(second));
    }

    #[test]
    fn stop_goes_first_and_nothing_older_follows_it() {
        let mut manager = CommandManager::new(SESSION);
        manager.submit(Command::Arm, 0).unwrap();
        manager.submit(Command::Reference(0.5), 0).unwrap();
        let arm = manager.poll(0).unwrap();
        manager.submit(Command::Stop, 10_000).unwrap();
        let stop = manager.poll(10_000).unwrap();
        assert_eq!(command_of(stop), Command::Stop);
        // The answer to the command that STOP overtook ends nothing.
        manager.acknowledge(&ack(number_of(arm)), 20_000);
        manager.take_outcomes();
        manager.acknowledge(&ack(number_of(stop)), 60_000);
        assert_eq!(
            manager.take_outcomes(),
            [Outcome {
                command: Command::Stop,
                fate: Fate::Applied(0.0)
            }]
        );
        assert_eq!(manager.poll(10_000_000), None);
    }

    #[test]
    fn stop_is_taken_when_the_queue_is_full() {
        let mut manager = CommandManager::new(SESSION);
        for _ in 0..MAX_WAITING {
            manager.submit(Command::Arm, 0).unwrap();
        }
        assert_eq!(manager.submit(Command::Arm, 0), Err(QueueFull));
        manager.submit(Command::Stop, 0).unwrap();
        assert_eq!(command_of(manager.poll(0).unwrap()), Command::Stop);
    }

    #[test]
    fn an_old_start_is_given_up_and_a_setting_is_not() {
        let mut manager = CommandManager::new(SESSION);
        manager.submit(Command::Arm, 0).unwrap();
        manager.submit(Command::Reference(0.5), 0).unwrap();
        assert_eq!(command_of(manager.poll(0).unwrap()), Command::Arm);
        let next = manager.poll(MOTION_EXPIRY_US).unwrap();
        assert_eq!(command_of(next), Command::Reference(0.5));
        assert_eq!(
            manager.take_outcomes(),
            [Outcome {
                command: Command::Arm,
                fate: Fate::Expired
            }]
        );
        assert_eq!(manager.poll(100 * MOTION_EXPIRY_US), Some(next));
    }

    #[test]
    fn reading_parameters_gives_way_to_the_operator() {
        let mut manager = CommandManager::new(SESSION);
        manager.submit_background(Command::GetParam { id: 0 });
        manager.submit_background(Command::GetParam { id: 1 });
        let read = manager.poll(0).unwrap();
        manager.submit(Command::ClearFault, 1_000).unwrap();
        manager.acknowledge(&ack(number_of(read)), 50_000);
        assert_eq!(
            command_of(manager.poll(50_000).unwrap()),
            Command::ClearFault
        );
    }

    #[test]
    fn a_restarted_robot_is_not_asked_to_arm() {
        let mut manager = CommandManager::new(SESSION);
        manager.submit(Command::Arm, 0).unwrap();
        manager.poll(0);
        manager.robot_restarted();
        assert_eq!(manager.poll(1_000_000), None);
        assert_eq!(
            manager.take_outcomes(),
            [Outcome {
                command: Command::Arm,
                fate: Fate::RobotRestarted
            }]
        );
    }

    /// The other end of a link that loses frames: applies a number once, acknowledges every arrival.
    #[derive(Default)]
    struct Robot {
        last: Option<u16>,
        applied: Vec<Command>,
    }

    impl Robot {
        fn take(&mut self, sent: ToRobot) -> Ack {
            let (number, command) = (number_of(sent), command_of(sent));
            if self.last != Some(number) {
                self.last = Some(number);
                self.applied.push(command);
            }
            ack(number)
        }
    }

    proptest! {
        #[test]
        fn over_a_link_that_loses_frames_each_command_is_applied_once_and_in_order(
            lost in proptest::collection::vec(any::<(bool, bool)>(), 200),
        ) {
            let mut manager = CommandManager::new(SESSION);
            let mut robot = Robot::default();
            let asked: Vec<Command> = (0..10u8).map(|id| Command::SetParam { id, value: 1.0 }).collect();
            for command in &asked {
                manager.submit(*command, 0).unwrap();
            }
            let mut lost = lost.into_iter();
            let mut now_us = 0;
            while manager.unacknowledged() > 0 {
                if let Some(sent) = manager.poll(now_us) {
                    let (lost_there, lost_back) = lost.next().unwrap_or_default();
                    if !lost_there {
                        let answer = robot.take(sent);
                        if !lost_back {
                            manager.acknowledge(&answer, now_us + 40_000);
                        }
                    }
                }
                now_us += 50_000;
            }
            prop_assert_eq!(robot.applied, asked);
        }
    }
}
