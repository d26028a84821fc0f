//! What the session does with a command: in frames or in the original's words, held as long as a key is, or refused with the reason.

use super::{Session, to_ms};
use crate::client::NotTaken;
use crate::words;
use rumbo_control::mode::Movement;
use rumbo_log::parameter;
use rumbo_wire::{Command, Level};
use std::time::{Duration, Instant};

/// A movement that a key holds ends this long after the page last said that it is held: a page that is gone lets go.
const HOLD: Duration = Duration::from_millis(600);

impl Session {
    pub(super) fn command(&mut self, command: Command) -> Result<(), String> {
        self.observer.order_given();
        if self.client.speaks_text() {
            return self.command_in_text(&command);
        }
        if let Command::SetParam { id, .. } = command
            && self.client.connected()
            && !(self.client.table_matches() && parameter(id).is_some())
        {
            return self.refuse(&command, "the robot has another parameter table");
        }
        if let Err(why) = self.client.submit(command, self.target.now_us()) {
            return self.refuse(&command, &self.why_not(why));
        }
        self.await_parameter(&command);
        // At once: STOP does not wait for the next wake.
        self.send()
    }

    /// Commands that belong together: one after the other, all or none of them taken.
    pub(super) fn commands(&mut self, commands: Vec<Command>) -> Result<(), String> {
        if self.client.speaks_text() {
            return commands
                .into_iter()
                .try_for_each(|command| self.command(command));
        }
        self.observer.order_given();
        let Some(first) = commands.first().copied() else {
            return Ok(());
        };
        if let Err(why) = self.client.submit_in_turn(commands.iter().copied()) {
            return self.refuse(&first, &self.why_not(why));
        }
        commands
            .iter()
            .for_each(|command| self.await_parameter(command));
        self.send()
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

    /// Sends a command in the original's words.
    fn command_in_text(&mut self, command: &Command) -> Result<(), String> {
        if self.port_gone {
            return self.refuse(command, &self.why_not(NotTaken::NotConnected));
        }
        if !self.client.submit_text(command) {
            return self.refuse(
                command,
                "this robot speaks the original's text, which has no words for it",
            );
        }
        let said = words::command(command, self.client.mode());
        self.note(
            rumbo_log::Level::Info,
            format!("{said}: sent, text is not acknowledged"),
        );
        self.send()
    }

    /// Sends a line that a person typed: to a USART of an emulated chip, or to a robot that speaks text.
    pub(super) fn type_in(&mut self, usart: u8, line: &str) -> Result<(), String> {
        let typed = match self.target.simulation() {
            Some(chip) => chip.type_in(usart, line).map(|()| {
                let now_us = self.target.now_us();
                self.observer.typed(now_us, usart, line);
            }),
            None if self.port_gone => Err("the port is gone".into()),
            None if self.client.speaks_text() => {
                self.client.type_in(line);
                return self.send();
            }
            None => Err("this robot takes no lines of text from here".to_owned()),
        };
        if let Err(why) = typed {
            self.note(
                rumbo_log::Level::Warning,
                format!("{line}: not sent, {why}"),
            );
        }
        Ok(())
    }

    /// Begins a movement, or goes on with the same one.
    pub(super) fn hold(&mut self, command: Command) -> Result<(), String> {
        let same = self.held.is_some_and(|(held, _)| held == command);
        self.held = Some((command, Instant::now() + HOLD));
        if same { Ok(()) } else { self.command(command) }
    }

    /// Ends a movement that nobody holds any more.
    pub(super) fn let_go(&mut self) -> Result<(), String> {
        let over = |(_, until): &mut (Command, Instant)| Instant::now() >= *until;
        match self.held.take_if(over) {
            Some(_) => self.command(Command::Move {
                movement: Movement::Stop,
                level: Level::Duty(0.0),
            }),
            None => Ok(()),
        }
    }

    /// Tells a simulated robot that has just been found what to begin with.
    pub(super) fn brief(&mut self) -> Result<(), String> {
        if self.briefed || !self.client.connected() {
            return Ok(());
        }
        self.briefed = true;
        let simulation = self.target.simulation();
        let commands = simulation.map_or_else(Vec::new, |simulation| simulation.first_commands());
        let commands = commands.into_iter();
        self.commands(
            commands
                .filter(|command| *command != Command::Arm)
                .collect(),
        )
    }

    /// Puts the ghost where the robot is.
    pub(super) fn restart_ghost(&mut self) {
        match self.target.restart_ghost(self.observer.standing()) {
            Ok(()) => self.note(
                rumbo_log::Level::Info,
                "the ghost starts again where the robot is".into(),
            ),
            Err(why) => self.note(
                rumbo_log::Level::Warning,
                format!("the ghost: refused, {why}"),
            ),
        }
    }

    fn refuse(&mut self, command: &Command, why: &str) -> Result<(), String> {
        let asked = words::command(command, self.client.mode());
        let now_ms = to_ms(self.target.now_us());
        self.observer
            .refuse(now_ms, format!("{asked}: refused, {why}"));
        Ok(())
    }
}
