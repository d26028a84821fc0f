//! How a program came to where it cannot go on: found out afterwards where that is possible, and noted by the jumps whose target only
//! the running program knows.

use super::Cpu;
use crate::decode::{Code, FLASH_WORDS, is_long};
use crate::verdict::{Arrival, Verdict};

impl Cpu {
    /// Nothing can run there.
    #[inline(always)]
    pub(super) fn is_astray(&self, target: u32) -> bool {
        let code = self.operations[target as usize % FLASH_WORDS].code;
        matches!(code, Code::Erased | Code::Illegal)
    }

    /// A return, or a jump or call through Z, of this kind and at `at`, leads where nothing can run: that is kept.
    #[cold]
    #[inline(never)]
    pub(super) fn note_astray(&mut self, target: u32, code: Code, at: u32) {
        let arrival = match code {
            Code::Ret | Code::Reti => Arrival::Return {
                at,
                stack_pointer: self.stack_pointer(),
            },
            _ => Arrival::Pointer {
                at,
                mnemonic: code.mnemonic(),
            },
        };
        self.astray = Some((target, arrival));
    }

    /// A jump, call or return from `at` leads to the program's beginning.
    #[cold]
    #[inline(never)]
    pub(super) fn note_restart(&mut self, at: u32) {
        let times = self.restarts.map_or(0, |(times, _)| times);
        self.restarts = Some((times + 1, at & self.last_word));
    }

    /// How often the program has restarted without a reset, and from where the last time \[words\].
    pub fn restarts(&self) -> Option<(u32, u32)> {
        self.restarts
    }

    /// Whether what stands here is the blank flash below a boot loader; found out where an application would begin.
    #[cold]
    pub(super) fn runs_through(&mut self, program_counter: u32) -> bool {
        if program_counter == 0 {
            let blank = |boot: &u32| {
                let below = &self.flash[..2 * *boot as usize];
                below.iter().all(|byte| *byte == 0xFF)
            };
            self.blank_to = self.boot.filter(blank).unwrap_or(0);
        }
        program_counter < self.blank_to
    }

    /// How the program counter got to `program_counter`.
    pub(super) fn arrival(&self, program_counter: u32) -> Arrival {
        if program_counter == 0 {
            return Arrival::Start;
        }
        if let Some((target, arrival)) = self.astray
            && target == program_counter
        {
            return arrival;
        }
        let before = self.instruction_before(program_counter);
        if goes_on(self.original(before).code) {
            return Arrival::Sequence { at: before };
        }
        let leads_there = |word: &u32| {
            let op = self.original(*word);
            is_direct(op.code) && op.address() & self.last_word == program_counter
        };
        (0..self.model.flash_words)
            .find(leads_there)
            .map_or(Arrival::Unknown, |at| Arrival::Jump { at })
    }

    /// The instruction that ends where `word` begins.
    fn instruction_before(&self, word: u32) -> u32 {
        let two = word.wrapping_sub(2) & self.last_word;
        if is_long(self.flash_word(two)) {
            two
        } else {
            word.wrapping_sub(1) & self.last_word
        }
    }

    #[cold]
    pub(super) fn stack_overflow(&mut self, program_counter: u32, cycle: u64) {
        if !self.stack_known && self.stack_pointer() >= self.sram_start {
            return;
        }
        self.end(Verdict::StackOverflow {
            program_counter: program_counter & self.last_word,
            stack_pointer: self.stack_pointer(),
            depth: self.model.ram_end.wrapping_sub(self.stack_pointer()),
            returns: self.returns(),
            floor: self.stack_floor,
            cycle,
        });
    }

    /// Values on the stack that are addresses behind a call.
    fn returns(&self) -> Vec<u32> {
        let start = usize::from((self.stack_pointer() + 1).saturating_sub(self.sram_start));
        let mut stack = self.sram.get(start..).unwrap_or_default();
        let mut returns = Vec::new();
        let bytes = usize::from(self.model.address_bytes());
        while let Some((address, rest)) = stack.split_at_checked(bytes) {
            let word = address
                .iter()
                .fold(0, |word, byte| word << 8 | u32::from(*byte));
            if self.is_behind_a_call(word) {
                returns.push(word);
                stack = rest;
            } else {
                stack = &stack[1..];
            }
        }
        returns
    }

    fn is_behind_a_call(&self, word: u32) -> bool {
        (1..self.model.flash_words).contains(&word)
            && matches!(
                self.original(self.instruction_before(word)).code,
                Code::Call | Code::Rcall | Code::Icall | Code::Eicall
            )
    }
}

/// What follows the instruction may come next.
const fn goes_on(code: Code) -> bool {
    !matches!(
        code,
        Code::Erased
            | Code::Illegal
            | Code::Jmp
            | Code::Rjmp
            | Code::Ijmp
            | Code::Eijmp
            | Code::Ret
            | Code::Reti
    )
}

/// Jumps, calls and branches with their target in the instruction.
const fn is_direct(code: Code) -> bool {
    matches!(
        code,
        Code::Jmp
            | Code::Rjmp
            | Code::Call
            | Code::Rcall
            | Code::Breq
            | Code::Brne
            | Code::Brcs
            | Code::Brcc
    )
}
