//! The way back: where the program stood before.

use super::breakpoints::holds;
use super::{Debugger, Reason, StepKind, calls};
use crate::value::Memory;
use rumbo_emulator::chip::Chip;
use rumbo_emulator::gdb::DebuggedWorld;
use std::collections::BTreeSet;

impl<W: DebuggedWorld> Debugger<W> {
    /// Goes back: over an instruction, a line, or out to the call.
    pub(crate) fn step_back(&mut self, step: StepKind) -> Reason {
        let found = match step {
            StepKind::Instruction => self.history.last_instruction(),
            _ => {
                let (stops, cfa, inside) = self.lines_back();
                let symbols = &self.symbols;
                let here = symbols.function(self.address());
                let accept = &mut |chip: &Chip| {
                    let (there, word) = (symbols.cfa(chip), chip.cpu().program_counter());
                    match cfa {
                        None => true,
                        Some(cfa) if there == Some(cfa) => {
                            let is_beside = here.is_some_and(|here| !here.contains(2 * word));
                            is_beside || inside.contains(&word)
                        }
                        Some(cfa) => there.is_some_and(|there| there > cfa),
                    }
                };
                self.history.last_stop(&stops, &[], accept)
            }
        };
        self.arrive(found, Reason::Step)
    }

    /// Beginnings of lines of the functions on the stack, the CFA of the innermost, and those of it.
    fn lines_back(&self) -> (BTreeSet<u32>, Option<u16>, BTreeSet<u32>) {
        let frames = self.symbols.frames(self.chip());
        let (mut stops, mut inside) = (BTreeSet::new(), BTreeSet::new());
        let address = self.address();
        let here = self.symbols.function(address);
        let own = here.map(|function| calls(function, address));
        let is_own = self.is_own(address);
        let mut called = frames.iter().skip(1);
        if is_own && !called.any(|frame| self.is_own(frame.address_in_code())) {
            // The core called it, and the one before.
            stops = self.own_lines();
        }
        for (index, frame) in frames.iter().enumerate() {
            let Some(function) = self.symbols.function(frame.address_in_code()) else {
                continue;
            };
            for row in self.symbols.begins(function) {
                if is_own && !self.own.contains(&row.file) {
                    continue;
                }
                let depth = calls(function, row.address).len();
                stops.insert(row.address / 2);
                if index == 0 && own.as_ref().is_some_and(|own| depth <= own.len()) {
                    inside.insert(row.address / 2);
                }
            }
        }
        (stops, frames.first().and_then(|frame| frame.cfa), inside)
    }

    /// Goes back to the last breakpoint, or to the beginning.
    pub(crate) fn go_back(&mut self) -> Reason {
        let breakpoints = self.breakpoints.iter();
        let stopping = breakpoints.filter(|breakpoint| breakpoint.log.is_none());
        let addresses = stopping.flat_map(|breakpoint| &breakpoint.addresses);
        let stops: BTreeSet<u32> = addresses.map(|at| at / 2).collect();
        let watches = self.watches();
        let (symbols, breakpoints) = (&self.symbols, &self.breakpoints);
        let accept = &mut |chip: &Chip| {
            let at = 2 * chip.cpu().program_counter();
            let here = breakpoints
                .iter()
                .filter(|breakpoint| breakpoint.addresses.contains(&at));
            let mut here = here.peekable();
            let memory = Memory { chip, symbols };
            let mut conditions = here.clone().map(|breakpoint| &breakpoint.condition);
            let accepts = |condition: &String| holds(condition, memory) == Ok(true);
            here.peek().is_none()
                || conditions.any(|condition| condition.as_ref().is_none_or(accepts))
        };
        let found = match stops.is_empty() && watches.is_empty() {
            true => None,
            false => self.history.last_stop(&stops, &watches, accept),
        };
        self.arrive(found, Reason::Breakpoint(Vec::new()))
    }

    fn arrive(&mut self, found: Option<u64>, reason: Reason) -> Reason {
        self.history.set_stops(BTreeSet::new(), Vec::new());
        self.history.travel(found.unwrap_or(self.history.first()));
        found.map_or(Reason::Start, |_| reason)
    }
}
