//! Commands to the robot, one at a time: sent, repeated until acknowledged, applied exactly once, and never late.
//!
//! Stop-and-wait: a command leaves only when the one before it was acknowledged, so the robot recognises a repetition
//! by its session and number alone. STOP and OFF do not queue: they replace the pending command and empty the queue,
//! since an operator who stops the robot wants no earlier order executed afterwards. Every other order
//! is given up [`EXPIRY_US`] after it was given, whether it waits or is under way, and when the link is lost: a link
//! that comes back does not bring an old start with it. What buffers of the link hold back, the robot refuses by the
//! time in it ([`Command::is_timed`]).
//!
//! The time-out follows the measured round trip as TCP's does (RFC 6298), without samples from repeated commands
//! (Karn).

use crate::round_trip::{self, RoundTrip};
use rumbo_control::Velocity;
use rumbo_wire::{Ack, COMMAND_LIFE_MS, Command, Refusal, RobotTime, ToRobot};
use std::collections::VecDeque;

/// Most orders that wait their turn.
const MAX_WAITING: usize = 64;
/// An order is given up when it has not been acknowledged for this long \[us\], as the robot does by its own clock.
pub const EXPIRY_US: u64 = COMMAND_LIFE_MS as u64 * 1_000;

/// Velocities leave this far apart at least \[us\]: 14 bytes each time, a third of a link of 9600 baud.
const VELOCITY_PERIOD_US: u64 = 40_000;
/// A read without an answer is sent this often before another session is tried.
const SENDS_PER_SESSION: u32 = 6;

/// What became of a command.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CommandOutcome {
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
    /// Given up by the station because STOP or OFF came after it; it may or may not have been applied before.
    Superseded,
    /// Given up by the station because no answer came in time; it may or may not have been applied.
    Expired,
    /// Given up by the station because the robot started again.
    RobotRestarted,
    /// Given up by the station because the port or the robot is gone; it may or may not have been applied before.
    LinkLost,
}

/// The queue is full.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct QueueFull;

/// When a command was given.
#[derive(Clone, Copy, Debug)]
enum Given {
    /// By the operator: at this time \[us\], when this robot time was the newest known.
    At(u64, RobotTime),
    /// As a part of something longer, a route for instance: its time begins with its turn.
    InTurn,
    /// By the station itself, to show the robot's values: it can wait, gives way to all others, and is repeated
    /// without end.
    Background,
}

/// A command that waits.
#[derive(Clone, Copy, Debug)]
struct Waiting {
    command: Command,
    given: Given,
}

impl Waiting {
    fn is_over(&self, now_us: u64) -> bool {
        let stops = matches!(self.command, Command::Stop | Command::Disarm);
        matches!(self.given, Given::At(since_us, _) if !stops && now_us >= since_us + EXPIRY_US)
    }
}

/// The one command under way.
#[derive(Clone, Copy, Debug)]
struct InFlight {
    number: u16,
    order: Waiting,
    seen: RobotTime,
    launched_us: u64,
    sends: u32,
    next_send_us: u64,
}

impl InFlight {
    fn is_background(&self) -> bool {
        matches!(self.order.given, Given::Background)
    }
}

/// Sends commands so that each is applied once.
#[derive(Debug)]
pub struct CommandManager {
    session: u8,
    next_number: u16,
    waiting: VecDeque<Waiting>,
    background: VecDeque<Command>,
    in_flight: Option<InFlight>,
    /// The newest velocity, until it is sent, with the newest robot time known when it was given.
    velocity: Option<(Velocity, RobotTime)>,
    velocity_sent_us: Option<u64>,
    round_trip: RoundTrip,
    outcomes: Vec<CommandOutcome>,
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
            velocity: None,
            velocity_sent_us: None,
            round_trip: RoundTrip::default(),
            outcomes: Vec::new(),
        }
    }

    /// Takes a command from the operator; `seen` is the newest robot time known.
    ///
    /// # Errors
    /// [`QueueFull`]; never for STOP and OFF.
    pub fn submit(
        &mut self,
        command: Command,
        seen: RobotTime,
        now_us: u64,
    ) -> Result<(), QueueFull> {
        let given = Given::At(now_us, seen);
        if matches!(command, Command::Stop | Command::Disarm) {
            self.go_first(Waiting { command, given }, now_us);
            return Ok(());
        }
        if self.waiting.len() >= MAX_WAITING {
            return Err(QueueFull);
        }
        self.waiting.push_back(Waiting { command, given });
        Ok(())
    }

    /// Takes commands that belong together; each expires by the time since its turn.
    pub fn submit_in_turn(&mut self, commands: impl IntoIterator<Item = Command>) {
        let given = Given::InTurn;
        let waiting = commands
            .into_iter()
            .map(|command| Waiting { command, given });
        self.waiting.extend(waiting);
    }

    /// Takes a velocity; one that has not been sent yet is dropped. `seen` is the newest robot time known.
    pub fn submit_velocity(&mut self, velocity: Velocity, seen: RobotTime) {
        self.velocity = Some((velocity, seen));
    }

    /// The velocity to be sent now, if any. To be called after every step of time.
    pub fn poll_velocity(&mut self, now_us: u64) -> Option<ToRobot> {
        if self
            .velocity_sent_us
            .is_some_and(|sent_us| now_us < sent_us + VELOCITY_PERIOD_US)
        {
            return None;
        }
        let (velocity, seen) = self.velocity.take()?;
        self.velocity_sent_us = Some(now_us);
        Some(ToRobot::Velocity { velocity, seen })
    }

    /// Takes a command that gives way to the operator's: reading the parameters.
    pub fn submit_background(&mut self, command: Command) {
        self.background.push_back(command);
    }

    /// What is left to be read is read in the order of these ranks.
    pub fn read_first(&mut self, rank: impl Fn(&Command) -> u8) {
        self.background.make_contiguous().sort_by_key(rank);
    }

    /// STOP or OFF.
    fn go_first(&mut self, order: Waiting, now_us: u64) {
        self.give_up_waiting(Fate::Superseded);
        match &mut self.in_flight {
            // Pressed again, or OFF after STOP, which does more: the same once more, at once.
            Some(flying) if [Command::Stop, order.command].contains(&flying.order.command) => {
                flying.next_send_us = now_us;
            }
            _ => {
                self.give_up_flying(Fate::Superseded);
                self.launch(order, RobotTime::default(), now_us);
            }
        }
    }

    /// The robot is gone or restarted: no pending request is sent later, except STOP.
    pub fn give_up(&mut self, fate: Fate) {
        self.give_up_waiting(fate);
        if !self.stops() {
            self.give_up_flying(fate);
        }
        self.background.clear();
    }

    /// The robot speaks another protocol: discards all pending commands.
    pub(crate) fn forget(&mut self) {
        self.waiting.clear();
        self.background.clear();
        self.in_flight = None;
        self.velocity = None;
    }

    fn give_up_waiting(&mut self, fate: Fate) {
        self.velocity = None;
        let given_up = self.waiting.drain(..).map(|waiting| CommandOutcome {
            command: waiting.command,
            fate,
        });
        self.outcomes.extend(given_up);
    }

    /// A read is queued again, anything else ends.
    fn give_up_flying(&mut self, fate: Fate) {
        let Some(old) = self.in_flight.take() else {
            return;
        };
        let command = old.order.command;
        if old.is_background() {
            self.background.push_front(command);
        } else {
            self.outcomes.push(CommandOutcome { command, fate });
        }
    }

    fn launch(&mut self, order: Waiting, newest: RobotTime, now_us: u64) {
        let number = self.next_number;
        self.next_number = number.wrapping_add(1);
        let (seen, given) = match order.given {
            Given::At(_, seen) => (seen, order.given),
            Given::InTurn => (newest, Given::At(now_us, newest)),
            Given::Background => (newest, order.given),
        };
        self.in_flight = Some(InFlight {
            number,
            order: Waiting { given, ..order },
            seen,
            launched_us: now_us,
            sends: 0,
            next_send_us: now_us,
        });
    }

    /// What is to be sent now, if anything; `newest` is the newest robot time known. To be called after every step of
    /// time.
    pub fn poll(&mut self, newest: RobotTime, now_us: u64) -> Option<ToRobot> {
        self.expire(now_us);
        // A read that is not answered does not keep an order waiting.
        if let Some(flying) = &self.in_flight
            && flying.is_background()
            && flying.sends > 0
            && now_us >= flying.next_send_us
            && !self.waiting.is_empty()
        {
            self.give_up_flying(Fate::Superseded);
        }
        if self.in_flight.is_none() {
            let read = |command| Waiting {
                command,
                given: Given::Background,
            };
            let next = self.waiting.pop_front();
            let next = next.or_else(|| self.background.pop_front().map(read));
            self.launch(next?, newest, now_us);
        }
        let timeout_us = self.round_trip.timeout_us();
        let flying = self.in_flight.as_mut()?;
        if now_us < flying.next_send_us {
            return None;
        }
        // A read can be repeated safely, so it may detect that an earlier station had the same session: the robot takes
        // our numbers for old ones and is silent.
        if flying.is_background()
            && flying.sends > 0
            && flying.sends.is_multiple_of(SENDS_PER_SESSION)
        {
            self.session = self.session.wrapping_add(1);
        }
        // Doubling eases a full link; STOP insists.
        let doublings = if flying.order.command == Command::Stop {
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
            command: flying.order.command,
            // As of when it was given, however often it is repeated.
            seen: flying.seen,
        })
    }

    fn expire(&mut self, now_us: u64) {
        let fate = Fate::Expired;
        if self
            .in_flight
            .is_some_and(|flying| flying.order.is_over(now_us))
        {
            self.give_up_flying(fate);
        }
        let outcomes = &mut self.outcomes;
        self.waiting.retain(|waiting| {
            let over = waiting.is_over(now_us);
            if over {
                let command = waiting.command;
                outcomes.push(CommandOutcome { command, fate });
            }
            !over
        });
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
                .measured(now_us.saturating_sub(done.launched_us));
        }
        let fate = match ack.result {
            Ok(value) => Fate::Applied(value),
            Err(refusal) => Fate::Refused(refusal),
        };
        self.outcomes.push(CommandOutcome {
            command: done.order.command,
            fate,
        });
    }

    /// What ended since the last call.
    pub fn take_outcomes(&mut self) -> Vec<CommandOutcome> {
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
        self.waiting.len()
            + usize::from(self.in_flight.is_some_and(|flying| !flying.is_background()))
    }

    fn stops(&self) -> bool {
        self.stop_since_us().is_some()
    }

    /// Since when STOP waits for its acknowledgement \[us\].
    pub fn stop_since_us(&self) -> Option<u64> {
        let flying = self.in_flight.as_ref()?;
        (flying.order.command == Command::Stop).then_some(flying.launched_us)
    }
}

#[cfg(test)]
mod tests;
