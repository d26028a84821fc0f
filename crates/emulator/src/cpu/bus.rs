//! The data space as instructions see it: registers, the CPU's own I/O registers, peripherals, SRAM; and the stack.

use super::Cpu;
use crate::io::{Access, Io, Stored};
use crate::registers::{EIND, RAMPZ, SPH, SPL, SPMCSR, SREG};
use crate::status::Status;
use crate::verdict::Verdict;

/// Bytes by which a function moves the stack pointer at most.
const LARGEST_FRAME: u16 = 1024;
/// Within these cycles a program writes both halves of the stack pointer: the compiler puts a write of SREG in between.
const HALVES_CYCLES: u64 = 4;

/// Where the program began to set the stack pointer.
#[derive(Clone, Copy, Debug)]
pub(super) struct StackMove {
    cycle: u64,
    from: u16,
    known: bool,
}

impl Cpu {
    #[inline(always)]
    pub(super) fn pair(&self, low: usize) -> u16 {
        u16::from_le_bytes([self.registers[low & 31], self.registers[(low + 1) & 31]])
    }

    #[inline(always)]
    pub(super) fn set_pair(&mut self, low: usize, value: u16) {
        let [l, h] = value.to_le_bytes();
        self.registers[low & 31] = l;
        self.registers[(low + 1) & 31] = h;
    }

    #[inline(never)]
    pub(super) fn load_elsewhere<I: Io>(&self, io: &mut I, address: u16, at: Access) -> u8 {
        match address {
            0..32 => self.registers[usize::from(address) & 31],
            RAMPZ if self.is_far => self.rampz,
            EIND if self.is_far => self.eind,
            SPL => self.stack_pointer().to_le_bytes()[0],
            SPH => self.stack_pointer().to_le_bytes()[1],
            SREG => self.status.bits(),
            _ => io.read(address, at),
        }
    }

    /// What an instruction would read now, without side effects on the peripherals.
    pub(crate) fn peek<I: Io + Clone>(&self, io: &I, address: u16) -> u8 {
        let index = usize::from(address.wrapping_sub(self.sram_start));
        match self.sram.get(index) {
            Some(byte) => *byte,
            None => self.load_elsewhere(&mut io.clone(), address, self.now()),
        }
    }

    /// Writes as an instruction would now.
    pub(crate) fn poke<I: Io>(&mut self, io: &mut I, address: u16, value: u8) {
        self.store(io, address, value, self.now());
    }

    fn now(&self) -> Access {
        Access {
            cycle: self.cycle,
            program_counter: self.program_counter,
        }
    }

    /// Stores a byte; returns whether the limit must be recomputed.
    #[inline(always)]
    pub(super) fn store<I: Io>(&mut self, io: &mut I, address: u16, value: u8, at: Access) -> bool {
        let index = usize::from(address.wrapping_sub(self.sram_start));
        match self.sram.get_mut(index) {
            Some(place) => {
                *place = value;
                false
            }
            None => {
                self.store_elsewhere(io, address, value, at);
                true
            }
        }
    }

    #[inline(never)]
    pub(super) fn store_elsewhere<I: Io>(
        &mut self,
        io: &mut I,
        address: u16,
        value: u8,
        at: Access,
    ) {
        let [low, high] = self.stack_pointer().to_le_bytes();
        match address {
            0..32 => self.registers[usize::from(address) & 31] = value,
            RAMPZ if self.is_far => self.rampz = value & 3,
            EIND if self.is_far => self.eind = value & 1,
            SPL => self.move_stack(u16::from_le_bytes([value, high]), at.cycle),
            SPH => self.move_stack(u16::from_le_bytes([low, value]), at.cycle),
            SREG => {
                let enabled_before = self.status.interrupts;
                self.status = Status::from_bits(value);
                self.shadow |= self.status.interrupts && !enabled_before;
            }
            _ => {
                self.programming |= address == SPMCSR;
                io.write(address, value, at);
            }
        }
    }

    /// The program sets the stack pointer. A frame is at most [`LARGEST_FRAME`]: a larger move is a switch to another
    /// stack, such as a scheduler's task stacks among the data, whose end is unknown. Writing both halves of the
    /// pointer is one move: the value in between does not count.
    fn move_stack(&mut self, to: u16, cycle: u64) {
        let start = match self.stack_move {
            Some(start) if cycle <= start.cycle + HALVES_CYCLES => start,
            _ => StackMove {
                cycle,
                from: self.stack_pointer(),
                known: self.stack_known,
            },
        };
        self.stack_move = Some(start);
        self.set_stack_pointer(to);
        let other = start.from.wrapping_sub(to) > LARGEST_FRAME;
        self.stack_known = to >= self.stack_floor || start.known && !other;
    }

    #[inline(always)]
    pub(super) fn push<I: Io>(&mut self, io: &mut I, value: u8, cycle: u64) {
        let at = Access {
            cycle,
            program_counter: self.program_counter,
        };
        self.store(io, self.stack_pointer(), value, at);
        self.set_stack_pointer(self.stack_pointer().wrapping_sub(1));
        if self.stack_pointer().wrapping_add(1) < self.stack_floor {
            self.stack_overflow(self.program_counter, cycle);
        }
    }

    #[cold]
    pub(super) fn end(&mut self, verdict: Verdict) {
        self.verdict.get_or_insert(verdict);
    }

    #[inline(always)]
    pub(super) fn push_address<I: Io>(&mut self, io: &mut I, words: u32, cycle: u64) {
        let [low, middle, high, _] = words.to_le_bytes();
        self.push(io, low, cycle);
        self.push(io, middle, cycle);
        if self.is_far {
            self.push(io, high, cycle);
        }
    }

    /// What LPM reads: fuses and signature too, if SPMCSR selects them.
    #[inline(always)]
    pub(super) fn load_program<I: Io>(&mut self, io: &mut I, address: u32, at: Access) -> u8 {
        if self.programming
            && let Some(value) = io.load_program(address, at)
        {
            return value;
        }
        self.program_byte(address)
    }

    /// SPM has changed the flash.
    #[cold]
    pub(super) fn program(&mut self, stored: Stored) {
        self.blank_to = 0;
        match stored {
            Stored::Nothing => {}
            Stored::Erased(page) => {
                let end = page + self.model.page_words as u32;
                (page..end).for_each(|word| self.write_flash(word, 0xFFFF));
            }
            Stored::Written(page, words) => {
                for (word, value) in (page..).zip(words) {
                    let value = value & self.flash_word(word);
                    self.write_flash(word, value);
                }
            }
        }
    }

    #[inline(always)]
    fn program_byte(&self, address: u32) -> u8 {
        self.flash[address as usize & (self.flash.len() - 1)]
    }
}
