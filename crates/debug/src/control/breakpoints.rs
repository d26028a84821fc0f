//! Breakpoints: when they stop the program, and what they write.

use super::Debugger;
use crate::expression;
use crate::stack::stack;
use crate::value::Memory;
use rumbo_emulator::gdb::DebuggedWorld;
use rumbo_emulator::observe::Watchpoint;

/// What a breakpoint is set at, and when it stops the program.
#[derive(Clone, Debug, Default)]
pub(crate) struct Breakpoint {
    /// Its number.
    pub(crate) id: u64,
    /// What it was set with: those of a file, those of functions.
    pub(crate) group: String,
    /// Addresses [bytes].
    pub(crate) addresses: Vec<u32>,
    /// It stops only where this is not 0.
    pub(crate) condition: Option<String>,
    /// It stops from this time on that it is reached; 0: each time.
    pub(crate) hits: u64,
    /// Instead of stopping it writes this; `{expression}` is its value.
    pub(crate) log: Option<String>,
    /// So often it was reached.
    pub(crate) reached: u64,
}

/// A variable whose accesses stop the program.
#[derive(Clone, Debug)]
pub(crate) struct DataBreakpoint {
    /// Its number.
    pub(crate) id: u64,
    /// The first address, in the data space.
    pub(crate) address: u16,
    /// How many bytes from there on.
    pub(crate) bytes: u16,
    /// Reading stops it.
    pub(crate) reads: bool,
    /// Writing stops it.
    pub(crate) writes: bool,
}

impl DataBreakpoint {
    pub(super) fn watchpoint(&self) -> Watchpoint {
        Watchpoint {
            addresses: self.address..self.address.saturating_add(self.bytes),
            reads: self.reads,
            writes: self.writes,
        }
    }
}

impl<W: DebuggedWorld> Debugger<W> {
    /// Replaces the breakpoints of a group by others.
    pub(crate) fn set_breakpoints(&mut self, group: &str, breakpoints: Vec<Breakpoint>) {
        self.breakpoints
            .retain(|breakpoint| breakpoint.group != group);
        self.breakpoints.extend(breakpoints);
        self.arm_again();
    }

    /// Replaces the data breakpoints.
    pub(crate) fn set_data_breakpoints(&mut self, data: Vec<DataBreakpoint>) {
        self.data = data;
        self.arm_again();
    }

    /// The breakpoints at an address that stop the program; those that write do.
    pub(super) fn hit(&mut self, address: u32) -> Vec<u64> {
        let mut stopping = Vec::new();
        for index in 0..self.breakpoints.len() {
            let breakpoint = &self.breakpoints[index];
            if !breakpoint.addresses.contains(&address) {
                continue;
            }
            let condition = breakpoint.condition.as_ref();
            match condition.map(|condition| holds(condition, self.memory())) {
                Some(Ok(false)) => continue,
                Some(Err(error)) => {
                    let said = format!("breakpoint {}: {error}", breakpoint.id);
                    self.logged.push(said);
                }
                Some(Ok(true)) | None => {}
            }
            self.breakpoints[index].reached += 1;
            let breakpoint = &self.breakpoints[index];
            if breakpoint.reached < breakpoint.hits {
                continue;
            }
            match breakpoint.log.clone() {
                Some(text) => self.logged.push(self.filled_in(&text)),
                None => stopping.push(breakpoint.id),
            }
        }
        stopping
    }

    /// A text with the values of the expressions between its braces.
    fn filled_in(&self, text: &str) -> String {
        let mut parts = text.split('{');
        let mut filled = parts.next().unwrap_or_default().to_owned();
        for part in parts {
            match part.split_once('}') {
                Some((expression, rest)) => {
                    filled += &match self.evaluate(expression, 0) {
                        Ok(item) => item.shown(self.memory()).0,
                        Err(error) => format!("<{error}>"),
                    };
                    filled += rest;
                }
                None => filled += part,
            }
        }
        filled
    }
}

/// Whether a condition holds in the innermost frame.
pub(super) fn holds(condition: &str, memory: Memory<'_>) -> Result<bool, String> {
    let stack = stack(memory);
    let frame = stack.first().ok_or("the program stands nowhere")?;
    expression::is_true(&expression::evaluate(condition, frame)?, memory)
}
