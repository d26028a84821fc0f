//! The CPU: registers, memories, and the loop that runs predecoded operations.
//!
//! # Theory of operation
//!
//! The loop runs until `limit`, the cycle of whichever comes first: the caller's end or an event of the peripherals; it
//! is 0 when an interrupt may be due. Only there does the loop leave the program: it lets the peripherals catch up,
//! enters an interrupt, or sleeps. An access to a peripheral may move the next event, so it recomputes the limit. Cost
//! thus grows with what happens, not with what exists.
//!
//! Instructions of one kind in a row are a run, done at once if its last one starts before the limit ([`runs`]); rounds of
//! a loop that waits are left out ([`wait`], [`recall`]). Under observation, and instruction by instruction, neither is
//! done: that is the plain interpreter, the reference of both.
//!
//! Instruction timing: 2549Q (ATmega640/1280/1281/2560/2561), section 34; interrupts take 5 cycles to enter, 5 more
//! out of sleep, and the instruction after SEI or RETI always runs first (sections 7.7 and 7.8). With a program counter
//! of 16 bits interrupts, calls and returns take a cycle less (DS40002061B, sections 7.7 and 37).

mod astray;
mod bus;
mod execute;
mod lanes;
mod recall;
mod runs;
pub mod touch;
mod uses;
mod wait;

use crate::decode::{Code, FLASH_WORDS, LONGEST_RUN, Op, decode};
use crate::io::{Demand, Io};
use crate::model::Model;
use crate::status::Status;
use crate::verdict::{Arrival, Verdict};
use crate::watchpoint::Watchpoint;
use std::sync::Arc;

/// Cycles from the recognition of an interrupt to the first instruction of its routine, a jump in the table, and as
/// many more out of sleep; one less where addresses on the stack are short.
const ENTRY_CYCLES: u64 = 5;

/// Why [`Cpu::run`] returned.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Stopped {
    /// The cycle was reached.
    Reached,
    /// A breakpoint is set at the program counter; the instruction has not been executed.
    Breakpoint,
    /// The chip does something else to a pin that is watched ([`crate::chip::Chip::watch`]).
    Output,
    /// An instruction accessed a watched address, and has completed.
    Watched {
        /// The first address of those that it touched.
        address: u16,
        /// What watched.
        watchpoint: Watchpoint,
    },
    /// The program cannot go on.
    Ended(Verdict),
}

/// How far a turn of the loop goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Pace {
    /// Over one instruction.
    One,
    /// To the next event, or to the caller's end.
    ToEvent,
}

/// What a turn of the loop was.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Turn {
    /// Sleep, or waking up.
    Slept,
    /// The routine of this interrupt was entered.
    Entered(u8),
    /// Instructions.
    Ran,
    /// It stood still, or was reset.
    Held,
    /// Nothing: a breakpoint stands here.
    Breakpoint,
    /// Nothing: the peripherals did something for which the run is to pause.
    Noticed,
}

/// How a program stands still.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Standstill {
    /// It sleeps.
    Asleep,
    /// An instruction jumps to itself.
    Loop,
    /// The same behind CLI, as avr-libc's `_exit` does, where a program goes whose `main` has returned.
    End,
}

/// The processor with its memories.
#[derive(Clone, Debug)]
pub struct Cpu {
    model: &'static Model,
    /// Of the model, what instructions look at: whether its program counter is wide, the last word of flash, and where
    /// SRAM starts.
    is_far: bool,
    last_word: u32,
    sram_start: u16,
    /// The first 32; as many as a byte can name, so that no index needs a check.
    registers: [u8; 256],
    status: Status,
    /// The stack pointer, as wide as the machine likes to load it: behind a narrower store a wider load would wait.
    stack: u32,
    program_counter: u32,
    cycle: u64,
    rampz: u8,
    eind: u8,
    sram: Box<[u8]>,
    /// Shared between snapshots, as are the operations, until one of them is changed.
    flash: Arc<[u8]>,
    /// As many as any model has; a smaller flash is repeated, as its short program counter sees it.
    operations: Arc<[Op; FLASH_WORDS]>,
    breakpoints: Vec<u32>,
    /// Pushing below this address runs the stack into data.
    stack_floor: u16,
    /// The stack is the one that ends there.
    stack_known: bool,
    stack_move: Option<bus::StackMove>,
    sleeping: bool,
    /// SPMCSR was written: LPM may read something else than the program.
    programming: bool,
    /// The next instruction runs before any interrupt.
    shadow: bool,
    verdict: Option<Verdict>,
    /// Where the last jump led behind which nothing can run, and what kind of jump it was.
    astray: Option<(u32, Arrival)>,
    /// How often a jump led to address 0, and from where the last one.
    restarts: Option<(u32, u32)>,
    /// Where a boot loader begins, if the program has one [words].
    boot: Option<u32>,
    /// Up to here all flash is erased, below a boot loader [words]; 0: it is not.
    blank_to: u32,
    search: wait::Search,
}

impl Cpu {
    /// A processor after power-on with this program in its flash; what `flash` does not fill is erased.
    ///
    /// Anything beyond the end of the flash is ignored: loaders refuse it before.
    pub fn new(model: &'static Model, program: &[u8]) -> Cpu {
        let mut flash = vec![0xFF; model.flash_bytes()];
        let fits = program.len().min(flash.len());
        flash[..fits].copy_from_slice(&program[..fits]);
        let nothing = Op {
            code: Code::Erased,
            a: 0,
            b: 0xFFFF,
        };
        let operations: Box<[Op; FLASH_WORDS]> = match vec![nothing; FLASH_WORDS].try_into() {
            Ok(operations) => operations,
            Err(_) => unreachable!("as long as it was made"),
        };
        let mut cpu = Cpu {
            model,
            is_far: model.is_far(),
            last_word: model.flash_words - 1,
            sram_start: model.sram_start,
            registers: [0; 256],
            status: Status::default(),
            stack: u32::from(model.ram_end),
            program_counter: 0,
            cycle: 0,
            rampz: 0,
            eind: 0,
            sram: vec![0; model.sram_bytes()].into(),
            flash: flash.into(),
            operations: operations.into(),
            breakpoints: Vec::new(),
            stack_floor: model.sram_start,
            stack_known: true,
            stack_move: None,
            sleeping: false,
            programming: false,
            shadow: false,
            verdict: None,
            astray: None,
            restarts: None,
            boot: None,
            blank_to: 0,
            search: wait::Search::default(),
        };
        cpu.status = Status::from_bits(0);
        // Backwards: runs are known by what follows.
        for word in (0..fits.div_ceil(2) as u32).rev() {
            cpu.predecode(word);
        }
        cpu
    }

    /// Starts over at address `program_counter` [words], as after a reset: memories keep what they hold.
    pub fn reset(&mut self, program_counter: u32) {
        self.status = Status::from_bits(0);
        self.set_stack_pointer(self.model.ram_end);
        self.stack_known = true;
        self.program_counter = program_counter & self.last_word;
        self.rampz = 0;
        self.eind = 0;
        self.sleeping = false;
        self.shadow = false;
        self.verdict = None;
    }

    /// Which chip's it is.
    pub fn model(&self) -> &'static Model {
        self.model
    }

    /// Cycles since power-on.
    pub fn cycle(&self) -> u64 {
        self.cycle
    }

    /// Address of the next instruction [words].
    pub fn program_counter(&self) -> u32 {
        self.program_counter
    }

    /// Continues at another instruction [words].
    pub fn set_program_counter(&mut self, words: u32) {
        self.program_counter = words & self.last_word;
    }

    /// The registers r0 to r31.
    pub fn registers(&self) -> &[u8; 32] {
        match self.registers.first_chunk() {
            Some(registers) => registers,
            None => unreachable!("there are more"),
        }
    }

    /// The same, to change them.
    pub fn registers_mut(&mut self) -> &mut [u8; 32] {
        match self.registers.first_chunk_mut() {
            Some(registers) => registers,
            None => unreachable!("there are more"),
        }
    }

    /// The status register.
    pub fn status(&self) -> Status {
        self.status
    }

    /// Sets the status register.
    pub fn set_status(&mut self, status: Status) {
        self.status = status;
    }

    /// The stack pointer.
    #[inline(always)]
    pub fn stack_pointer(&self) -> u16 {
        self.stack as u16
    }

    /// Sets the stack pointer.
    #[inline(always)]
    pub fn set_stack_pointer(&mut self, address: u16) {
        self.stack = u32::from(address);
    }

    /// The SRAM, from its first address on.
    pub fn sram(&self) -> &[u8] {
        &self.sram
    }

    /// The same, to change it.
    pub fn sram_mut(&mut self) -> &mut [u8] {
        &mut self.sram
    }

    /// The flash.
    pub fn flash(&self) -> &[u8] {
        &self.flash
    }

    /// The CPU sleeps until an interrupt.
    pub fn is_sleeping(&self) -> bool {
        self.sleeping
    }

    /// How the program stands still for good, if it does: with interrupts off, only a reset leads on.
    pub fn standstill(&self) -> Option<Standstill> {
        const CLI: [u8; 2] = 0x94F8_u16.to_le_bytes();
        const JUMP_TO_ITSELF: [u8; 2] = 0xCFFF_u16.to_le_bytes();
        let at = 2 * self.program_counter() as usize;
        let (before, here) = (at.wrapping_sub(2), self.flash.get(at..at + 2));
        if self.status.interrupts {
            None
        } else if self.sleeping {
            Some(Standstill::Asleep)
        } else if here != Some(&JUMP_TO_ITSELF) {
            None
        } else if self.flash.get(before..at) == Some(&CLI) {
            Some(Standstill::End)
        } else {
            Some(Standstill::Loop)
        }
    }

    /// A boot loader begins there \[words\]: while no application is below it, erased flash is run through, as on the chip,
    /// where each erased word takes a cycle and does nothing.
    pub fn set_boot_loader(&mut self, word: u32) {
        self.boot = Some(word & self.last_word);
    }

    /// Pushing below this address is a stack that has run into data.
    pub fn set_stack_floor(&mut self, address: u16) {
        self.stack_floor = address.max(self.sram_start);
    }

    /// Stops before the instruction at `word`; takes no time until it is reached.
    pub fn set_breakpoint(&mut self, word: u32) {
        let word = word & self.last_word;
        if !self.breakpoints.contains(&word) {
            self.breakpoints.push(word);
        }
        self.predecode_around(word);
    }

    /// Removes a breakpoint.
    pub fn clear_breakpoint(&mut self, word: u32) {
        let word = word & self.last_word;
        self.breakpoints.retain(|other| *other != word);
        self.predecode_around(word);
    }

    /// Writes a word of flash, as SPM does.
    pub fn write_flash(&mut self, word: u32, value: u16) {
        let word = word & self.last_word;
        let at = 2 * word as usize;
        let [low, high] = value.to_le_bytes();
        let flash = Arc::make_mut(&mut self.flash);
        flash[at] = low;
        flash[at + 1] = high;
        self.predecode_around(word);
    }

    /// A word has changed. The word before may be a skip that must know how long this one is, or the first half of it; those before
    /// may be in a run with it.
    fn predecode_around(&mut self, word: u32) {
        self.search.unmark();
        for back in 0..2 * LONGEST_RUN {
            self.predecode(word.wrapping_sub(back) & self.last_word);
        }
    }

    fn flash_word(&self, word: u32) -> u16 {
        let at = 2 * (word & self.last_word) as usize;
        u16::from_le_bytes([self.flash[at], self.flash[at + 1]])
    }

    /// The operation at an address [words], whether a breakpoint stands there or not.
    pub fn operation(&self, word: u32) -> Op {
        self.original(word & self.last_word)
    }

    fn original(&self, word: u32) -> Op {
        let first = self.flash_word(word);
        let op = decode(word, first, self.flash_word(word + 1));
        self.model.admit(op, first)
    }

    fn predecode(&mut self, word: u32) {
        let mut op = self.original(word);
        if self.breakpoints.contains(&word) {
            op.code = Code::Breakpoint;
        }
        let next = (word + op.words()) & self.last_word;
        let apart = self.search.begins_at(word) || self.search.begins_at(next);
        if !apart {
            op = op.before(self.operations[next as usize]);
        }
        self.put(word, op);
    }

    /// Puts an operation in its place, in each repetition of the flash.
    fn put(&mut self, word: u32, op: Op) {
        let words = self.model.flash_words as usize;
        for place in Arc::make_mut(&mut self.operations)
            .iter_mut()
            .skip(word as usize)
            .step_by(words)
        {
            *place = op;
        }
    }

    /// Runs until `until` cycles have passed since power-on, to the end of the instruction that passes them.
    pub fn run<I: Io>(&mut self, io: &mut I, until: u64) -> Stopped {
        self.run_by(io, until, |cpu, io| {
            match cpu.turn(io, until, Pace::ToEvent) {
                Turn::Breakpoint => Some(Stopped::Breakpoint),
                Turn::Noticed => Some(Stopped::Output),
                Turn::Slept | Turn::Held | Turn::Entered(_) | Turn::Ran => None,
            }
        })
    }

    /// The same by turns that the caller goes through, until one of them gives a reason to stop.
    pub(crate) fn run_by<I: Io>(
        &mut self,
        io: &mut I,
        until: u64,
        mut turn: impl FnMut(&mut Cpu, &mut I) -> Option<Stopped>,
    ) -> Stopped {
        loop {
            if let Some(verdict) = &self.verdict {
                return Stopped::Ended(verdict.clone());
            }
            if io.take_notice() {
                return Stopped::Output;
            }
            if self.cycle >= until {
                return Stopped::Reached;
            }
            if let Some(stopped) = turn(self, io) {
                return stopped;
            }
        }
    }

    /// Runs one instruction, also where a breakpoint stands; or sleeps on, or enters an interrupt that is due before it.
    pub fn step<I: Io>(&mut self, io: &mut I) -> Stopped {
        self.past_breakpoint(|cpu| cpu.run(io, cpu.cycle + 1))
    }

    /// Does something as if no breakpoint stood at the program counter.
    pub(crate) fn past_breakpoint(&mut self, run: impl FnOnce(&mut Cpu) -> Stopped) -> Stopped {
        let here = self.program_counter;
        let held = self.breakpoints.contains(&here);
        if held {
            self.put(here, self.original(here));
        }
        let stopped = run(self);
        if held {
            self.predecode(here);
        }
        stopped
    }

    /// How the program ended, if it has.
    pub fn verdict(&self) -> Option<&Verdict> {
        self.verdict.as_ref()
    }

    /// The operation that comes next, whether a breakpoint stands there or not.
    pub(crate) fn next_operation(&self) -> Op {
        self.original(self.program_counter)
    }

    /// One turn of the loop, which a caller that observes the program goes through itself; not after a verdict.
    pub(crate) fn turn<I: Io>(&mut self, io: &mut I, until: u64, pace: Pace) -> Turn {
        io.advance(self.cycle);
        if io.take_notice() {
            return Turn::Noticed;
        }
        if let Some(demand) = io.take_demand() {
            self.obey(demand);
            return Turn::Held;
        }
        if !self.shadow {
            if self.sleeping {
                self.sleep_on(io, until);
                return Turn::Slept;
            }
            if let Some(vector) = self.enter_interrupt(io) {
                return Turn::Entered(vector);
            }
        }
        // One instruction only while an interrupt waits for it, else up to the next event.
        let (limit, until) = match pace {
            Pace::One => (self.cycle, self.cycle + 1),
            Pace::ToEvent if self.shadow => (self.cycle, until),
            Pace::ToEvent => {
                let limit = io.deadline(self.status.interrupts).min(until);
                if limit > self.cycle + wait::SPAN && self.look_for_rounds(io, until) {
                    return Turn::Ran;
                }
                (limit, until)
            }
        };
        self.shadow = false;
        if self.step_until(io, limit, until) {
            Turn::Breakpoint
        } else {
            Turn::Ran
        }
    }

    fn obey(&mut self, demand: Demand) {
        match demand {
            Demand::Stall(cycles) => self.cycle += cycles,
            Demand::Reset {
                program_counter,
                cycle,
            } => {
                self.reset(program_counter);
                self.cycle = self.cycle.max(cycle);
            }
        }
    }

    /// Sleeps to the next event, or wakes up: only an interrupt that is enabled in every way does that.
    fn sleep_on<I: Io>(&mut self, io: &mut I, until: u64) {
        if self.status.interrupts && io.pending().is_some() {
            self.sleeping = false;
            self.cycle += io.wake(self.cycle) + self.entry_cycles();
        } else {
            let next = io.deadline(self.status.interrupts).max(self.cycle + 1);
            self.cycle = next.min(until);
        }
    }

    fn entry_cycles(&self) -> u64 {
        ENTRY_CYCLES - u64::from(!self.is_far)
    }

    fn enter_interrupt<I: Io>(&mut self, io: &mut I) -> Option<u8> {
        if !self.status.interrupts {
            return None;
        }
        let vector = io.pending()?;
        io.acknowledge(vector, self.cycle);
        self.push_address(io, self.program_counter, self.cycle);
        self.status.interrupts = false;
        self.program_counter = (u32::from(vector) * 2 + io.vector_base()) & self.last_word;
        if self.is_astray(self.program_counter) {
            self.astray = Some((self.program_counter, Arrival::Interrupt { vector }));
        }
        self.cycle += self.entry_cycles();
        Some(vector)
    }
}
