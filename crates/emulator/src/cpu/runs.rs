//! Runs of instructions of one kind ([`Op::before`]), done at once: as many of them as go to SRAM, which may be none.

use super::Cpu;
use crate::decode::{Code, FLASH_WORDS, Op};

impl Cpu {
    /// The operations of `count` words from `program_counter` on.
    #[inline(always)]
    fn run_of(operations: &[Op; FLASH_WORDS], program_counter: u32, count: u32) -> &[Op] {
        let start = program_counter as usize % FLASH_WORDS;
        operations.get(start..start + count as usize).unwrap_or(&[])
    }

    /// PUSH, unless one would overflow the stack.
    #[inline(always)]
    pub(super) fn pushes(&mut self, pc: u32, count: u32) -> u32 {
        let top = self.stack_pointer();
        let lowest = top.wrapping_sub(count as u16 - 1);
        let start = usize::from(lowest.wrapping_sub(self.sram_start));
        let ops = Cpu::run_of(&self.operations, pc, count);
        let places = self.sram.get_mut(start..start + ops.len());
        let Some(places) = places.filter(|_| lowest >= self.stack_floor) else {
            return 0;
        };
        for (op, place) in ops.iter().zip(places.iter_mut().rev()) {
            *place = self.registers[usize::from(op.a & 31)];
        }
        self.set_stack_pointer(lowest.wrapping_sub(1));
        count
    }

    /// POP.
    #[inline(always)]
    pub(super) fn pops(&mut self, pc: u32, count: u32) -> u32 {
        let lowest = self.stack_pointer().wrapping_add(1);
        let start = usize::from(lowest.wrapping_sub(self.sram_start));
        let ops = Cpu::run_of(&self.operations, pc, count);
        let Some(places) = self.sram.get(start..start + ops.len()) else {
            return 0;
        };
        for (op, place) in ops.iter().zip(places) {
            self.registers[usize::from(op.a & 31)] = *place;
        }
        self.set_stack_pointer(lowest.wrapping_add(count as u16 - 1));
        count
    }

    /// LDS of two words each, or LDD by the pointer in these registers.
    #[inline(always)]
    pub(super) fn loads(&mut self, pc: u32, count: u32, pointer: Option<usize>) -> u32 {
        let words = if pointer.is_none() { 2 } else { 1 };
        let ops = Cpu::run_of(&self.operations, pc, words * count);
        let mut done = 0;
        for op in ops.iter().step_by(words as usize) {
            let base = pointer.map_or(0, |low| {
                u16::from_le_bytes([self.registers[low], self.registers[low + 1]])
            });
            let address = base.wrapping_add(op.b);
            match self
                .sram
                .get(usize::from(address.wrapping_sub(self.sram_start)))
            {
                Some(value) => self.registers[usize::from(op.a & 31)] = *value,
                None => return done,
            }
            done += 1;
        }
        done
    }

    /// STS of two words each, or STD by the pointer in these registers.
    #[inline(always)]
    pub(super) fn stores(&mut self, pc: u32, count: u32, pointer: Option<usize>) -> u32 {
        let words = if pointer.is_none() { 2 } else { 1 };
        let base = pointer.map_or(0, |low| self.pair(low));
        let ops = Cpu::run_of(&self.operations, pc, words * count);
        let mut done = 0;
        for op in ops.iter().step_by(words as usize) {
            let address = base.wrapping_add(op.b);
            let index = usize::from(address.wrapping_sub(self.sram_start));
            match self.sram.get_mut(index) {
                Some(place) => *place = self.registers[usize::from(op.a & 31)],
                None => return done,
            }
            done += 1;
        }
        done
    }

    /// LDI, MOV and MOVW in any order.
    #[inline(always)]
    pub(super) fn moves(&mut self, pc: u32, count: u32) {
        for op in Cpu::run_of(&self.operations, pc, count) {
            let (a, b) = (usize::from(op.a & 31), usize::from(op.b as u8));
            match op.code {
                Code::Ldi | Code::Ldis => self.registers[a] = op.b as u8,
                Code::Mov | Code::Movs => self.registers[a] = self.registers[b],
                _ => {
                    self.registers[a] = self.registers[b];
                    self.registers[(a + 1) & 31] = self.registers[(b + 1) & 31];
                }
            }
        }
    }

    /// ADC.
    #[inline(always)]
    pub(super) fn sum(&mut self, pc: u32, count: u32) {
        let mut status = self.status;
        for op in Cpu::run_of(&self.operations, pc, count) {
            let (a, b) = (usize::from(op.a & 31), usize::from(op.b as u8));
            self.registers[a] = status.add_on(self.registers[a], self.registers[b]);
        }
        self.status = status;
    }

    /// SBC and SBCI, and CPC, which does not store the result.
    #[inline(always)]
    pub(super) fn difference(&mut self, pc: u32, count: u32, constant: bool, stores: bool) {
        let mut status = self.status;
        for op in Cpu::run_of(&self.operations, pc, count) {
            let (a, b) = (usize::from(op.a & 31), op.b as u8);
            let other = if constant {
                b
            } else {
                self.registers[usize::from(b)]
            };
            let difference = status.subtract_on(self.registers[a], other);
            if stores {
                self.registers[a] = difference;
            }
        }
        self.status = status;
    }

    /// CPI, and CPC for the bytes above.
    #[inline(always)]
    pub(super) fn comparison(&mut self, pc: u32, count: u32) {
        let first = self.operations[pc as usize % FLASH_WORDS];
        let low = self.registers[usize::from(first.a & 31)];
        self.status.subtract(low, first.b as u8);
        self.difference(pc + 1, count - 1, false, false);
    }
}
