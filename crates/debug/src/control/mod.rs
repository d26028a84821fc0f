//! Breakpoints and steps.
//!
//! A step runs the program at full speed to where it may end: the beginnings of the lines of the function, and the return
//! to its caller. That the frame is still the same one shows in its CFA; interrupts and recursion pass by. Back, the same
//! places are looked for in the past.

mod back;
mod breakpoints;
mod values;

pub(crate) use breakpoints::{Breakpoint, DataBreakpoint};

use crate::history::History;
use crate::stack::{CallFrame, stack};
use crate::symbols::{Scope, ScopeKind, Symbols};
use crate::value::Memory;
use rumbo_emulator::chip::Chip;
use rumbo_emulator::cpu::Stopped;
use rumbo_emulator::decode::Code;
use rumbo_emulator::gdb::DebuggedWorld;
use rumbo_emulator::observe::Watchpoint;
use std::collections::BTreeSet;

/// How far a step goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum StepKind {
    /// To the next line, over calls.
    Over,
    /// To the next line, into calls of functions with lines.
    In,
    /// To the caller.
    Out,
    /// Over one instruction.
    Instruction,
}

/// Why the program stands.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Reason {
    /// At breakpoints, by their numbers.
    Breakpoint(Vec<u64>),
    /// It has accessed what a data breakpoint watches.
    Data(u64),
    /// A step is done.
    Step,
    /// The user wants it.
    Pause,
    /// It cannot go on.
    Ended(String),
    /// The scenario's time is over.
    Over,
    /// Back at the beginning.
    Start,
}

/// Where the program may end that runs: a step; with nothing in it, at breakpoints only.
#[derive(Clone, Debug, Default)]
struct Plan {
    /// Words, in the frame with this CFA.
    stops: BTreeSet<u32>,
    cfa: Option<u16>,
    /// Where its caller goes on, with the stack at least there.
    returns: Option<u32>,
    /// Words of calls that are to be followed.
    calls: BTreeSet<u32>,
    /// It began in the files of the program, not of the core or a library, and ends in them.
    own: bool,
    /// The stops hold in outer frames too.
    outwards: bool,
}

/// A program under a debugger.
pub struct Debugger<W> {
    pub(crate) symbols: Symbols,
    pub(crate) history: History<W>,
    /// It runs, and how far.
    motion: Option<Plan>,
    pub(crate) breakpoints: Vec<Breakpoint>,
    pub(crate) data: Vec<DataBreakpoint>,
    /// What breakpoints have written.
    logged: Vec<String>,
    /// The files of a sketch, in which its steps end.
    own: BTreeSet<usize>,
}

impl<W: DebuggedWorld> Debugger<W> {
    /// The program stands where the world does.
    pub fn new(symbols: Symbols, world: W) -> Self {
        let history = History::new(world);
        let own = symbols.files_of_program();
        Debugger {
            own,
            symbols,
            history,
            motion: None,
            breakpoints: Vec::new(),
            data: Vec::new(),
            logged: Vec::new(),
        }
    }

    /// The chip, to look at.
    pub(crate) fn chip(&self) -> &Chip {
        self.history.chip()
    }

    /// The world.
    pub fn world(&self) -> &W {
        self.history.now()
    }

    /// Memory and symbols.
    pub(crate) fn memory(&self) -> Memory<'_> {
        Memory {
            chip: self.chip(),
            symbols: &self.symbols,
        }
    }

    /// The frames, innermost first.
    pub(crate) fn stack(&self) -> Vec<CallFrame<'_>> {
        stack(self.memory())
    }

    /// It runs.
    pub(crate) fn is_running(&self) -> bool {
        self.motion.is_some()
    }

    /// Drains what breakpoints have written.
    pub(crate) fn take_log(&mut self) -> Vec<String> {
        std::mem::take(&mut self.logged)
    }

    /// Drains what the program has sent, each byte once, with the numbers of its streams.
    pub(crate) fn take_output(&mut self) -> Vec<(u8, Vec<u8>)> {
        self.history.take_output()
    }

    /// Changes the world: a new past begins.
    pub fn change<T>(&mut self, change: impl FnOnce(&mut W) -> T) -> T {
        self.history.change(change)
    }

    /// Lets the program run.
    pub(crate) fn go(&mut self) {
        self.follow(Plan::default());
    }

    /// Whether steps that begin in the program's own files end in them, as they do at first.
    pub(crate) fn set_just_own_code(&mut self, just_own_code: bool) {
        self.own = match just_own_code {
            true => self.symbols.files_of_program(),
            false => BTreeSet::new(),
        };
    }

    /// Lets it run to the first line of `setup`, or else of `main`.
    pub(crate) fn go_to_entry(&mut self) {
        let entry = self.symbols.entry();
        let stops = entry.map(|function| self.symbols.body(function) / 2);
        self.follow(Plan {
            stops: stops.into_iter().collect(),
            ..Plan::default()
        });
    }

    /// Back to the beginning.
    pub(crate) fn restart(&mut self) {
        self.motion = None;
        for breakpoint in &mut self.breakpoints {
            breakpoint.reached = 0;
        }
        self.history.restart();
    }

    pub(super) fn arm_again(&mut self) {
        if let Some(plan) = self.motion.take() {
            self.follow(plan);
        }
    }

    /// Stops it.
    pub(crate) fn pause(&mut self) {
        self.motion = None;
        self.history.set_stops(BTreeSet::new(), Vec::new());
    }

    /// Begins a step; `Some`: it is done.
    ///
    /// # Errors
    /// There is nothing that it could go to.
    pub(crate) fn step(&mut self, step: StepKind) -> Result<Option<Reason>, String> {
        if step == StepKind::Instruction
            || self.symbols.function(self.address()).is_none() && step != StepKind::Out
        {
            let stopped = self.history.step();
            return Ok(Some(self.ended(&stopped).unwrap_or(Reason::Step)));
        }
        let plan = self.plan(step)?;
        // A stop where it stands does not count.
        if plan.calls.contains(&(self.address() / 2)) {
            return Ok(self.enter(plan));
        }
        self.follow(plan);
        Ok(None)
    }

    fn follow(&mut self, plan: Plan) {
        let breakpoints = self.breakpoints.iter();
        let addresses = breakpoints.flat_map(|breakpoint| &breakpoint.addresses);
        let mut words: BTreeSet<u32> = addresses.map(|address| address / 2).collect();
        words.extend(plan.stops.iter().chain(&plan.calls));
        words.extend(plan.returns);
        self.motion = Some(plan);
        self.history.set_stops(words, self.watches());
    }

    fn watches(&self) -> Vec<Watchpoint> {
        self.data.iter().map(DataBreakpoint::watchpoint).collect()
    }

    fn address(&self) -> u32 {
        2 * self.chip().cpu().program_counter()
    }

    fn plan(&self, step: StepKind) -> Result<Plan, String> {
        let frames = self.symbols.frames(self.chip());
        let Some(frame) = frames.first() else {
            return Err("the program stands nowhere".into());
        };
        let at = self.address();
        let mut plan = Plan {
            cfa: frame.cfa,
            own: self.is_own(at),
            returns: frames.get(1).map(|caller| caller.program_counter / 2),
            ..Plan::default()
        };
        let Some(function) = self.symbols.function(at) else {
            return Ok(plan);
        };
        let own = calls(function, at);
        let line = self.symbols.lines.row(at);
        let is_own = |row: &crate::symbols::LineRow| {
            line.is_some_and(|line| (line.line, line.file) == (row.line, row.file))
        };
        for row in self.symbols.begins(function) {
            let there = calls(function, row.address);
            let both = own.iter().zip(&there);
            let common = both.take_while(|(own, there)| std::ptr::eq(**own, **there));
            let depth = common.count();
            let goes = match step {
                // In this or an outer of the inlined functions.
                StepKind::Over => depth == there.len() && !is_own(&row),
                StepKind::In => !is_own(&row) || there.len() > own.len(),
                StepKind::Out | StepKind::Instruction => {
                    depth == there.len() && there.len() < own.len()
                }
            };
            if goes {
                plan.stops.insert(row.address / 2);
            }
        }
        if step == StepKind::In {
            plan.calls = self.calls_in(function);
        }
        if step == StepKind::Out && plan.stops.is_empty() && plan.returns.is_none() {
            return Err("nothing has called this function: there is no step out of it".into());
        }
        Ok(plan)
    }

    /// Whether an instruction is of the program's own files.
    fn is_own(&self, address: u32) -> bool {
        let row = self.symbols.lines.row(address);
        row.is_some_and(|row| self.own.contains(&row.file))
    }

    /// The beginnings of all lines of the program's own files.
    fn own_lines(&self) -> BTreeSet<u32> {
        let functions = self.symbols.functions.iter();
        let rows = functions.flat_map(|function| self.symbols.begins(function));
        let own = rows.filter(|row| self.own.contains(&row.file));
        own.map(|row| row.address / 2).collect()
    }

    /// The words of a function at which it calls another, or jumps to it.
    fn calls_in(&self, function: &Scope) -> BTreeSet<u32> {
        let cpu = self.chip().cpu();
        let ranges = function.ranges.iter();
        let words = ranges.flat_map(|range| range.start / 2..range.end / 2);
        let leads_out = |word: &u32| {
            let op = cpu.operation(*word);
            match op.code {
                Code::Call | Code::Rcall | Code::Icall | Code::Eicall => true,
                Code::Jmp | Code::Rjmp => !function.contains(2 * op.address()),
                _ => false,
            }
        };
        words.filter(leads_out).collect()
    }

    /// Runs for an interval; says why the program stands, if it does.
    pub(crate) fn turn(&mut self) -> Option<Reason> {
        self.motion.as_ref()?;
        let stopped = self.history.go();
        let reason = match stopped {
            Stopped::Reached | Stopped::Output => {
                self.history.now().is_over().then_some(Reason::Over)
            }
            Stopped::Watched { ref watchpoint, .. } => {
                let mut data = self.data.iter();
                let hit = data.find(|data| data.watchpoint() == *watchpoint);
                hit.map(|data| Reason::Data(data.id))
            }
            Stopped::Breakpoint => self.at_stop(),
            Stopped::Ended(_) => self.ended(&stopped),
        };
        if reason.is_some() {
            self.pause();
        }
        reason
    }

    fn ended(&self, stopped: &Stopped) -> Option<Reason> {
        match stopped {
            Stopped::Ended(verdict) => Some(Reason::Ended(verdict.to_string())),
            _ if self.history.now().is_over() => Some(Reason::Over),
            _ => None,
        }
    }

    fn at_stop(&mut self) -> Option<Reason> {
        let word = self.chip().cpu().program_counter();
        // Breakpoints count also where a step ends.
        let hit = self.hit(2 * word);
        if let Some(plan) = self.motion.clone() {
            if self.ends(&plan) {
                if plan.own && hit.is_empty() && !self.is_own(2 * word) {
                    // The core called it, and calls the next one.
                    self.follow(Plan {
                        stops: self.own_lines(),
                        cfa: plan.cfa,
                        own: true,
                        outwards: true,
                        ..Plan::default()
                    });
                    return None;
                }
                return Some(match hit.is_empty() {
                    true => Reason::Step,
                    false => Reason::Breakpoint(hit),
                });
            }
            if hit.is_empty() && plan.calls.contains(&word) && self.is_in(&plan) {
                return self.enter(plan);
            }
        }
        (!hit.is_empty()).then_some(Reason::Breakpoint(hit))
    }

    /// Whether it stands in the frame of a step.
    fn is_in(&self, plan: &Plan) -> bool {
        let here = self.symbols.cfa(self.chip());
        plan.cfa.is_none() || here == plan.cfa || plan.outwards && here > plan.cfa
    }

    fn ends(&self, plan: &Plan) -> bool {
        let cpu = self.chip().cpu();
        let word = cpu.program_counter();
        let returned =
            plan.returns == Some(word) && plan.cfa.is_none_or(|cfa| cpu.stack_pointer() >= cfa);
        returned || plan.stops.contains(&word) && self.is_in(plan)
    }

    /// Follows a call into a function with lines, where it may stand already; over any other.
    fn enter(&mut self, plan: Plan) -> Option<Reason> {
        let before = self.chip().cpu().program_counter();
        let stopped = self.history.step();
        let entry = self.address();
        let function = self.symbols.function(entry);
        let function = function.filter(|function| function.entry == entry && entry / 2 != before);
        let body = function.map(|function| self.symbols.body(function));
        let next = match body.filter(|body| !plan.own || self.is_own(*body)) {
            Some(body) if body == entry => {
                self.pause();
                return Some(self.ended(&stopped).unwrap_or(Reason::Step));
            }
            Some(body) => Plan {
                stops: [body / 2].into(),
                ..Plan::default()
            },
            None => plan,
        };
        self.follow(next);
        None
    }
}

/// The function and the functions inlined at an instruction, the outermost first.
fn calls(function: &Scope, address: u32) -> Vec<&Scope> {
    let mut chain = function.chain(address);
    chain.retain(|scope| scope.kind != ScopeKind::Block);
    chain
}
