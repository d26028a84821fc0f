//! How the session handles a command: sent in frames or as the original's text, held as long as a key is, or refused
//! with the reason.

use super::{Ask, Now, Session};
use crate::client::NotTaken;
use crate::error::TargetError;
use crate::words;
use rumbo_control::Velocity;
use rumbo_control::mode::{ModeId, Movement, twist};
use rumbo_log::parameter;
use rumbo_wire::{Command, MovementLevel};

/// A movement that a key holds ends this long after the page last repeated it: a page that is gone releases it \[us\].
const HOLD_US: u64 = 600_000;

/// Refused velocities are reported this often \[us\].
const REFUSED_AGAIN_US: u64 = 2_000_000;

impl Session {
    pub(super) fn command(&mut self, command: Command, now: Now) {
        self.observer.order_given();
        if self.client.speaks_text() {
            return self.command_in_text(&command, now);
        }
        if let Command::SetParam { id, .. } = command
            && self.client.connected()
            && !(self.client.table_matches() && parameter(id).is_some())
        {
            return self.refuse(&command, "the robot has another parameter table", now);
        }
        if let Err(why) = self.client.submit(command, now.target_us) {
            return self.refuse(&command, &self.why_not(why), now);
        }
        self.observer.commanded(now.target_us, vec![command]);
        self.await_parameter(&command);
        // At once: STOP does not wait for the next slice.
        self.say(now);
    }

    /// A velocity for mode 10. They come many times a second: that they are refused is said every two seconds.
    pub(super) fn velocity(&mut self, velocity: Velocity, now: Now) {
        match self.submit_velocity(velocity) {
            Ok(()) => {
                self.observer.order_given();
                self.velocity_refused_us = None;
                // At once: it is short-lived.
                self.say(now);
            }
            Err(why) => {
                let said = |at_us: u64| now.wall_us < at_us + REFUSED_AGAIN_US;
                if !self.velocity_refused_us.is_some_and(said) {
                    self.velocity_refused_us = Some(now.wall_us);
                    let asked = words::velocity(velocity);
                    self.observer
                        .refuse(now.target_ms(), format!("{asked}: refused, {why}"));
                }
            }
        }
    }

    /// Why it is not sent, for people.
    fn submit_velocity(&mut self, velocity: Velocity) -> Result<(), String> {
        if self.client.speaks_text() {
            return Err("this robot speaks the original's text, which has no words for it".into());
        }
        if self.client.connected() && self.client.mode() != ModeId::Twist {
            return Err("the robot is in another mode; select mode 10, twist".into());
        }
        twist::check(velocity).map_err(words::bad_velocity)?;
        self.client
            .submit_velocity(velocity)
            .map_err(|why| self.why_not(why))
    }

    /// Commands that belong together: sent one after the other, all accepted or none.
    pub(super) fn commands(&mut self, commands: Vec<Command>, now: Now) {
        if self.submit(&commands, now) {
            self.observer.commanded(now.target_us, commands);
        }
    }

    /// Whether they were accepted.
    fn submit(&mut self, commands: &[Command], now: Now) -> bool {
        if self.client.speaks_text() {
            let each = commands.iter();
            each.for_each(|command| self.command(*command, now));
            return false;
        }
        self.observer.order_given();
        let Some(first) = commands.first() else {
            return false;
        };
        if let Err(why) = self.client.submit_in_turn(commands.iter().copied()) {
            self.refuse(first, &self.why_not(why), now);
            return false;
        }
        commands
            .iter()
            .for_each(|command| self.await_parameter(command));
        self.say(now);
        true
    }

    fn await_parameter(&mut self, command: &Command) {
        if let Command::SetParam { id, .. } = command {
            self.observer.parameter_pending(*id);
        }
    }

    fn why_not(&self, why: NotTaken) -> String {
        match (why, self.client.other_protocol()) {
            (NotTaken::NotConnected, _) if self.port_gone => {
                "the port is gone; give the order again when it is back".into()
            }
            (NotTaken::NotConnected, Some(protocol)) => words::other_protocol(protocol),
            _ => words::not_taken(why).into(),
        }
    }

    /// Sends a command as the original's text.
    fn command_in_text(&mut self, command: &Command, now: Now) {
        if self.port_gone {
            return self.refuse(command, &self.why_not(NotTaken::NotConnected), now);
        }
        if !self.client.submit_text(command) {
            let why = "this robot speaks the original's text, which has no words for it";
            return self.refuse(command, why, now);
        }
        self.observer.commanded(now.target_us, vec![*command]);
        let said = command.in_words(self.client.mode());
        let sent = format!("{said}: sent, text is not acknowledged");
        let text = match command
            .supplies_motors()
            .filter(|_| self.about.abilities.cut_off)
        {
            Some(false) => words::MOTORS_CUT.replace("{}", &said.to_string()),
            Some(true) if self.motors_cut => words::MOTORS_SUPPLIED.to_owned(),
            _ => sent,
        };
        self.note(rumbo_log::Level::Info, text, now);
        self.say(now);
    }

    /// What is to happen to the supply of the motors, where it can be cut.
    pub(super) fn supply(&mut self, command: Command) -> Option<Ask> {
        let on = command
            .supplies_motors()
            .filter(|_| self.about.abilities.cut_off)?;
        self.motors_cut = !on;
        self.state_noted_us = None;
        Some(Ask::Supply(on))
    }

    /// A line that a person typed: for a USART of an emulated chip, or for a robot that speaks text.
    pub(super) fn type_in(&mut self, usart: u8, line: String, now: Now) -> Option<Ask> {
        if self.about.abilities.typing {
            return Some(Ask::Type(usart, line));
        }
        let why = if self.port_gone {
            TargetError::PortGone
        } else if self.client.speaks_text() {
            self.client.type_in(&line);
            self.say(now);
            return None;
        } else {
            TargetError::NoTyping
        };
        self.typed(usart, &line, Err(why), now);
        None
    }

    /// A line was sent to a USART, or why not.
    pub fn typed(&mut self, usart: u8, line: &str, sent: Result<(), TargetError>, now: Now) {
        match sent {
            Ok(()) => self.observer.typed(now.target_us, usart, line),
            Err(why) => {
                let text = format!("{}: not sent, {why}", line.trim_end());
                self.note(rumbo_log::Level::Warning, text, now);
            }
        }
    }

    /// Starts a movement, or prolongs the same one.
    pub(super) fn hold(&mut self, command: Command, now: Now) {
        let same = self.held.is_some_and(|(held, _)| held == command);
        self.held = Some((command, now.wall_us + HOLD_US));
        if !same {
            self.command(command, now);
        }
    }

    /// Ends a movement that is no longer held.
    pub fn expire_hold(&mut self, now: Now) {
        let over = |(_, until_us): &mut (Command, u64)| now.wall_us >= *until_us;
        if self.held.take_if(over).is_some() {
            let stop = Command::Move {
                movement: Movement::Stop,
                level: MovementLevel::Duty(0.0),
            };
            self.command(stop, now);
        }
    }

    /// Sends the first commands to a robot that has just connected.
    pub(super) fn brief(&mut self, now: Now) {
        if self.briefed || !self.client.connected() {
            return;
        }
        self.briefed = true;
        let mut commands = self.about.first_commands.clone();
        commands.retain(|command| *command != Command::Arm);
        self.submit(&commands, now);
    }

    /// The ghost was moved to the robot, or why not.
    pub fn ghost_restarted(&mut self, done: Result<(), TargetError>, now: Now) {
        match done {
            Ok(()) => {
                let text = "the ghost starts again where the robot is";
                self.note(rumbo_log::Level::Info, text.into(), now);
            }
            Err(why) => {
                let text = format!("the ghost: refused, {why}");
                self.note(rumbo_log::Level::Warning, text, now);
            }
        }
    }

    fn refuse(&mut self, command: &Command, why: &str, now: Now) {
        let asked = command.in_words(self.client.mode());
        self.observer
            .refuse(now.target_ms(), format!("{asked}: refused, {why}"));
    }
}
