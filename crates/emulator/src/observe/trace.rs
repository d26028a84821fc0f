//! A trace: every instruction of a window of cycles with what it changed.

use super::Moment;
use crate::cpu::{Cpu, Turn};
use crate::decode::Op;
use crate::disassemble;
use crate::image::Image;
use crate::status::Status;
use std::fmt::Write;
use std::ops::Range;

/// Most instructions that are recorded: a second of the chip's time is sixteen times as many.
pub const LONGEST: usize = 1_000_000;

/// A recorded instruction, or the entry of an interrupt.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Traced {
    /// The cycle in which it started.
    pub cycle: u64,
    /// Where it stands [words].
    pub program_counter: u32,
    /// What happened.
    pub what: What,
    /// Registers that changed, and to what.
    pub registers: Vec<(u8, u8)>,
    /// The status register, if it changed.
    pub status: Option<u8>,
    /// The stack pointer, if it changed.
    pub stack_pointer: Option<u16>,
}

/// What a line of the trace is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum What {
    /// An instruction.
    Instruction(Op),
    /// The entry of this interrupt's routine.
    Interrupt(u8),
    /// Sleep.
    Sleep,
}

impl Traced {
    /// The line for people: cycle, byte address, function, instruction, what changed.
    pub fn line(&self, image: &Image) -> String {
        let mut line = format!(
            "{:>10}  {:<28}",
            self.cycle,
            image.place(self.program_counter)
        );
        match self.what {
            What::Instruction(op) => line += &disassemble::text(self.program_counter, op),
            What::Interrupt(vector) => {
                let name = image.model().vector_name(vector);
                line += &format!("interrupt {name}");
            }
            What::Sleep => line += "asleep",
        }
        let mut changes = String::new();
        for (register, value) in &self.registers {
            let _ = write!(changes, " r{register}={value:02x}");
        }
        if let Some(status) = self.status {
            let _ = write!(changes, " {}", Status::letters(status));
        }
        if let Some(stack_pointer) = self.stack_pointer {
            let _ = write!(changes, " sp={stack_pointer:04x}");
        }
        if changes.is_empty() {
            line
        } else {
            format!("{line:<66};{changes}")
        }
    }
}

/// The recorder.
#[derive(Clone, Debug)]
pub(crate) struct Trace {
    cycles: Range<u64>,
    lines: Vec<Traced>,
    left: usize,
}

impl Trace {
    pub(crate) fn new(cycles: Range<u64>) -> Trace {
        Trace {
            cycles,
            lines: Vec::new(),
            left: LONGEST,
        }
    }

    pub(crate) fn take(&mut self) -> Vec<Traced> {
        std::mem::take(&mut self.lines)
    }

    /// Whether it records from `now` on, and until when that holds.
    pub(crate) fn span(&self, now: u64) -> (bool, u64) {
        if self.left == 0 || now >= self.cycles.end {
            (false, u64::MAX)
        } else if now < self.cycles.start {
            (false, self.cycles.start)
        } else {
            (true, self.cycles.end)
        }
    }

    pub(crate) fn note(&mut self, cpu: &Cpu, before: &Moment, turn: Turn) {
        if !self.cycles.contains(&before.cycle) || self.left == 0 {
            return;
        }
        self.left -= 1;
        let what = match turn {
            Turn::Entered(vector) => What::Interrupt(vector),
            Turn::Slept | Turn::Held => What::Sleep,
            Turn::Ran | Turn::Breakpoint | Turn::Noticed => What::Instruction(before.operation),
        };
        let pairs = before.registers.iter().zip(cpu.registers());
        let changed = |(number, (before, after)): (usize, (&u8, &u8))| {
            (before != after).then_some((number as u8, *after))
        };
        let status = cpu.status().bits();
        let stack_pointer = cpu.stack_pointer();
        self.lines.push(Traced {
            cycle: before.cycle,
            program_counter: before.program_counter,
            what,
            registers: pairs.enumerate().filter_map(changed).collect(),
            status: (status != before.status).then_some(status),
            stack_pointer: (stack_pointer != before.stack_pointer).then_some(stack_pointer),
        });
    }
}
