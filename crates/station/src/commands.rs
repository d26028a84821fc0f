//! Commands to the robot, one at a time: sent, repeated until acknowledged, applied exactly once.
//!
//! Stop-and-wait: a command leaves only when the one before it was acknowledged, so the robot recognises a repetition by its
//! session and number alone. STOP waits for nobody: it takes the place of whatever is under way and empties the queue,
//! since an operator who stops the robot wants nothing older to happen afterwards. Commands that make the wheels turn are given up
//! after [`MOTION_EXPIRY_US`], so that a link that comes back does not bring an old start with it.
//!
//! The time-out follows the measured round trip as TCP's does (RFC 6298), without samples from repeated commands (Karn).

use crate::round_trip::{self, RoundTrip};
use rumbo_wire::{Ack, Command, Refusal, ToRobot};
use std::collections::VecDeque;

/// Most commands that wait their turn.
const MAX_WAITING: usize = 64;
/// A command that makes the wheels turn is given up when it has not been acknowledged for this long \[us\].
pub const MOTION_EXPIRY_US: u64 = 2_000_000;

/// A read without an answer is sent this often before another session is tried.
const SENDS_PER_SESSION: u32 = 6;

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

/// As many commands wait as may.
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

    /// What is left to be read is read in the order of these ranks.
    pub fn read_first(&mut self, rank: impl Fn(&Command) -> u8) {
        self.background.make_contiguous().sort_by_key(rank);
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

    /// The robot speaks another language: nothing is asked of it in this one any more.
    pub(crate) fn forget(&mut self) {
        self.waiting.clear();
        self.background.clear();
        self.in_flight = None;
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
        // To read twice does no harm, so a read may find out that an earlier station had the same session: the robot takes
        // our numbers for old ones and is silent.
        if flying.background && flying.sends > 0 && flying.sends.is_multiple_of(SENDS_PER_SESSION) {
            self.session = self.session.wrapping_add(1);
        }
        // Doubling eases a full link; STOP insists.
        let doublings = if flying.command == Command::Stop {
            0
        } else {
            flying.sends.min(4)
        };
        flying.sends += 1;
        flying.next_send_us =
            now_us + (timeout_us << doublings).min(round_trip::LONGEST_TIMEOUT_US);
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

    /// Smoothed round trip of a command \[us\], `None` before the first.
    pub fn round_trip_us(&self) -> Option<u64> {
        self.round_trip.smoothed_us
    }

    /// About the time that a frame needs at least in one direction \[us\].
    pub(crate) fn way_us(&self) -> u64 {
        self.round_trip.way_us()
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

#[cfg(test)]
mod tests;
