//! Each command is applied exactly once, however often the link repeats it.
//!
//! The station sends one command at a time and repeats it until it is acknowledged; numbers grow within a session.
//! So a single acknowledgement is all the state: a command with its number is a repetition, a lower number is stale, a
//! higher one is new. STOP is applied whenever it arrives, from any session; it makes everything before it stale, and
//! it does not reset another session's numbers, so that no old start is repeated after the stop.

use rumbo_wire::{Ack, Command};

/// What to do with a command that arrived.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Verdict {
    /// Apply it, then [`Ledger::record`] its acknowledgement.
    New,
    /// It was applied: send this answer again.
    Repeated(Ack),
    /// Stale: no answer, no effect.
    Late,
}

/// Keeps the last command's acknowledgement.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Ledger {
    last: Option<Ack>,
}

impl Ledger {
    /// Judges a command by its number.
    pub(crate) fn judge(&self, session: u8, number: u16, command: &Command) -> Verdict {
        if *command == Command::Stop {
            return Verdict::New;
        }
        match self.last {
            Some(last) if last.session == session => match number.wrapping_sub(last.number) {
                0 => Verdict::Repeated(last),
                1..=0x7FFF => Verdict::New,
                0x8000.. => Verdict::Late,
            },
            _ => Verdict::New,
        }
    }

    /// Records the answer to a command that [`Ledger::judge`] found new.
    pub(crate) fn record(&mut self, ack: Ack, command: &Command) {
        let of_this_session = self.last.is_none_or(|last| last.session == ack.session);
        let not_older = self
            .last
            .is_none_or(|last| ack.number.wrapping_sub(last.number) < 0x8000);
        let is_stop = *command == Command::Stop;
        if !is_stop || (of_this_session && not_older) {
            self.last = Some(ack);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ack(session: u8, number: u16) -> Ack {
        Ack {
            session,
            number,
            result: Ok(0.0),
        }
    }

    fn after(session: u8, number: u16, command: Command) -> Ledger {
        let mut ledger = Ledger::default();
        ledger.record(ack(session, number), &command);
        ledger
    }

    #[test]
    fn a_repetition_gets_the_same_answer() {
        let ledger = after(1, 7, Command::Arm);
        assert_eq!(
            ledger.judge(1, 7, &Command::Arm),
            Verdict::Repeated(ack(1, 7))
        );
        assert_eq!(ledger.judge(1, 8, &Command::Arm), Verdict::New);
    }

    #[test]
    fn numbers_wrap() {
        let ledger = after(1, 0xFFFF, Command::Arm);
        assert_eq!(ledger.judge(1, 0, &Command::Arm), Verdict::New);
        assert_eq!(ledger.judge(1, 0xFFFE, &Command::Arm), Verdict::Late);
    }

    #[test]
    fn another_session_starts_afresh() {
        assert_eq!(
            after(1, 7, Command::Arm).judge(2, 7, &Command::Arm),
            Verdict::New
        );
    }

    #[test]
    fn a_stop_is_always_new_and_ends_the_turn_of_what_was_before_it() {
        let mut ledger = after(1, 7, Command::Arm);
        assert_eq!(ledger.judge(1, 7, &Command::Stop), Verdict::New);
        ledger.record(ack(1, 9), &Command::Stop);
        assert_eq!(ledger.judge(1, 8, &Command::Arm), Verdict::Late);
    }

    #[test]
    fn a_stop_of_another_session_does_not_bring_an_old_start_back() {
        let mut ledger = after(1, 7, Command::Arm);
        ledger.record(ack(2, 0), &Command::Stop);
        assert_eq!(
            ledger.judge(1, 7, &Command::Arm),
            Verdict::Repeated(ack(1, 7))
        );
    }

    #[test]
    fn a_late_stop_does_not_bring_later_commands_back() {
        let mut ledger = after(1, 7, Command::Arm);
        ledger.record(ack(1, 5), &Command::Stop);
        assert_eq!(
            ledger.judge(1, 7, &Command::Arm),
            Verdict::Repeated(ack(1, 7))
        );
        assert_eq!(ledger.judge(1, 6, &Command::Arm), Verdict::Late);
    }
}
