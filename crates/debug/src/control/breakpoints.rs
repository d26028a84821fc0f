//! Breakpoints: when they stop the program, and what they write.

use super::Debugger;
use crate::expression;
use rumbo_emulator::gdb::DebuggedWorld;
use rumbo_emulator::observe::Watchpoint;

/// What a breakpoint is set at, and when it stops the program.
#[derive(Clone, Debug, Default)]
pub struct Breakpoint {
    /// Its number.
    pub id: u64,
    /// What it was set with: those of a file, those of functions.
    pub group: String,
    /// Addresses [bytes].
    pub addresses: Vec<u32>,
    /// It stops only where this is not 0.
    pub condition: Option<String>,
    /// It stops from this time on that it is reached; 0: each time.
    pub hits: u64,
    /// Instead of stopping it writes this; `{expression}` is its value.
    pub log: Option<String>,
    /// So often it was reached.
    pub reached: u64,
}

/// A variable whose accesses stop the program.
#[derive(Clone, Debug)]
pub struct DataBreakpoint {
    /// Its number.
    pub id: u64,
    /// The first address, in the data space.
    pub address: u16,
    /// How many bytes from there on.
    pub bytes: u16,
    /// Reading stops it.
    pub reads: bool,
    /// Writing stops it.
    pub writes: bool,
}

impl DataBreakpoint {
    pub(super) fn watchpoint(&self) -> Watchpoint {
        let addresses = self.address..self.address.saturating_add(self.bytes);
        Watchpoint {
            addresses,
            reads: self.reads,
            writes: self.writes,
        }
    }
}

impl<W: DebuggedWorld> Debugger<W> {
    /// Replaces the breakpoints of a group by others.
    pub fn set_breakpoints(&mut self, group: &str, breakpoints: Vec<Breakpoint>) {
        self.breakpoints
            .retain(|breakpoint| breakpoint.group != group);
        self.breakpoints.extend(breakpoints);
        self.arm_again();
    }

    /// Replaces the data breakpoints.
    pub fn set_data_breakpoints(&mut self, data: Vec<DataBreakpoint>) {
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
            let holds = breakpoint
                .condition
                .as_ref()
                .map(|condition| self.holds(condition));
            if holds == Some(Ok(false)) {
                continue;
            }
            if let Some(Err(error)) = holds {
                self.logged.push(format!(
                    "breakpoint {}: {error}",
                    self.breakpoints[index].id
                ));
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

    fn holds(&self, condition: &str) -> Result<bool, String> {
        let item = self.evaluate(condition, 0)?;
        expression::is_true(&item, self.memory())
    }

    /// A text with the values of the expressions between its braces.
    fn filled_in(&self, text: &str) -> String {
        let mut parts = text.split('{');
        let mut filled = parts.next().unwrap_or_default().to_owned();
        for part in parts {
            match part.split_once('}') {
                Some((expression, rest)) => {
                    let value = self
                        .evaluate(expression, 0)
                        .map(|item| item.shown(self.memory()).0);
                    filled += &value.unwrap_or_else(|error| format!("<{error}>"));
                    filled += rest;
                }
                None => filled += part,
            }
        }
        filled
    }
}
