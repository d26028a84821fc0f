//! What the session does with a command: in frames or in the original's words, held as long as a key is, or refused with the reason.

use super::Session;
use crate::board;
use crate::words;
use rumbo_control::mode::Movement;
use rumbo_wire::{Command, Level};
use std::time::{Duration, Instant};

/// A movement that a key holds ends this long after the page last said that it is held: a page that is gone lets go.
const HOLD: Duration = Duration::from_millis(600);

impl Session {
    pub(super) fn command(&mut self, command: Command) -> Result<(), String> {
        if self.client.speaks_text() {
            return self.command_in_text(&command);
        }
        if self.client.is_mute() && self.call_in_text(&command) {
            return self.send();
        }
        if let Command::SetParam { id, .. } = command
            && !(self.client.table_matches() && self.observer.parameter_pending(id))
        {
            return self.refuse(&command, "the robot has another parameter table");
        }
        if self.client.submit(command, self.target.now_us()).is_err() {
            return self.refuse(&command, "too many commands wait for the robot");
        }
        // At once: STOP does not wait for the next wake.
        self.send()
    }

    /// Nothing was heard yet, and should it be the original program, only its own words wake it. One of ours that cannot be heard
    /// stops at OFF as well. True if that is all that is to be sent.
    fn call_in_text(&mut self, command: &Command) -> bool {
        let stop = matches!(command, Command::Stop | Command::Disarm);
        if !(stop || matches!(command, Command::Arm | Command::Goal { .. })) {
            return false;
        }
        self.client.submit_text(command);
        let said = words::command(command, self.client.mode());
        let text = format!(
            "{said}: sent as text, in case the robot runs the original program; nothing was heard from it yet"
        );
        self.note(board::Level::Info, text);
        !stop
    }

    /// Sends a command in the original's words.
    fn command_in_text(&mut self, command: &Command) -> Result<(), String> {
        if self.port_gone {
            return self.refuse(command, "the port is gone");
        }
        if !self.client.submit_text(command) {
            return self.refuse(
                command,
                "this robot speaks the original's text, which has no words for it",
            );
        }
        let said = words::command(command, self.client.mode());
        self.note(
            board::Level::Info,
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
            None if self.client.speaks_text() || self.client.is_mute() => {
                self.client.type_in(line);
                return self.send();
            }
            None => Err("this robot takes no lines of text from here".to_owned()),
        };
        if let Err(why) = typed {
            self.note(board::Level::Warning, format!("{line}: not sent, {why}"));
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
        commands
            .into_iter()
            .filter(|command| *command != Command::Arm)
            .try_for_each(|command| self.command(command))
    }

    /// Puts the ghost where the robot is.
    pub(super) fn restart_ghost(&mut self) {
        match self.target.restart_ghost(self.observer.standing()) {
            Ok(()) => self.note(
                board::Level::Info,
                "the ghost starts again where the robot is".into(),
            ),
            Err(why) => self.note(board::Level::Warning, format!("the ghost: refused, {why}")),
        }
    }

    fn refuse(&mut self, command: &Command, why: &str) -> Result<(), String> {
        let asked = words::command(command, self.client.mode());
        self.note(board::Level::Warning, format!("{asked}: refused, {why}"));
        Ok(())
    }
}
