//! The loop over instructions: what each does and how many cycles it takes.

use super::{Cpu, SRAM_START};
use crate::decode::{Code, FLASH_WORDS};
use crate::io::{Access, Io};
use crate::status::Status;
use crate::verdict::Verdict;

const X: usize = 26;
const Y: usize = 28;
const Z: usize = 30;

impl Cpu {
    /// Runs instructions while the cycle is below `limit`, at least one; says whether a breakpoint stopped it.
    pub(super) fn step_until<I: Io>(&mut self, io: &mut I, mut limit: u64, until: u64) -> bool {
        let mut pc = self.program_counter;
        let mut cycle = self.cycle;
        loop {
            let op = self.operations[pc as usize % FLASH_WORDS];
            let here = pc;
            pc += 1;
            let (a, b) = (usize::from(op.a) & 31, usize::from(op.b) & 31);
            let mut cycles = 1;

            /// Where and when an access of this instruction takes place: in its last cycle.
            macro_rules! at {
                ($cycles:expr) => {
                    Access {
                        cycle: cycle + $cycles - 1,
                        program_counter: here,
                    }
                };
            }
            /// After an access that may have changed what comes next.
            macro_rules! look_up {
                () => {
                    limit = if self.shadow {
                        0
                    } else {
                        io.deadline(self.status.interrupts).min(until)
                    }
                };
            }
            macro_rules! load {
                ($address:expr) => {{
                    cycles = 2;
                    let address = $address;
                    let value = self.load(io, address, at!(2));
                    if address < SRAM_START {
                        look_up!();
                    }
                    value
                }};
            }
            macro_rules! store {
                ($address:expr, $value:expr) => {{
                    cycles = 2;
                    let value = $value;
                    if self.store(io, $address, value, at!(2)) {
                        look_up!();
                    }
                }};
            }
            macro_rules! skip_if {
                ($condition:expr) => {
                    if $condition {
                        let words = (op.b >> 8) as u32 - 1;
                        pc += words;
                        cycles += u64::from(words);
                    }
                };
            }
            macro_rules! branch_if {
                ($condition:expr, $target:expr) => {
                    if $condition {
                        pc = $target;
                        cycles = 2;
                    }
                };
            }

            match op.code {
                Code::Nop => {}
                Code::Movw => {
                    self.registers[a] = self.registers[b];
                    self.registers[(a + 1) & 31] = self.registers[(b + 1) & 31];
                }
                Code::Muls | Code::Fmuls => {
                    let product = i16::from(self.registers[a].cast_signed())
                        * i16::from(self.registers[b].cast_signed());
                    self.multiply(product.cast_unsigned(), op.code == Code::Fmuls);
                    cycles = 2;
                }
                Code::Mulsu | Code::Fmulsu => {
                    let product = i16::from(self.registers[a].cast_signed())
                        .wrapping_mul(i16::from(self.registers[b]));
                    self.multiply(product.cast_unsigned(), op.code == Code::Fmulsu);
                    cycles = 2;
                }
                Code::Mul | Code::Fmul => {
                    let product = u16::from(self.registers[a]) * u16::from(self.registers[b]);
                    self.multiply(product, op.code == Code::Fmul);
                    cycles = 2;
                }
                Code::Add => {
                    self.registers[a] =
                        self.status.add(self.registers[a], self.registers[b], false);
                }
                Code::Adc => {
                    let carry = self.status.carry();
                    self.registers[a] =
                        self.status.add(self.registers[a], self.registers[b], carry);
                }
                Code::Sub => {
                    self.registers[a] = self.status.subtract(self.registers[a], self.registers[b]);
                }
                Code::Sbc => {
                    self.registers[a] = self
                        .status
                        .subtract_on(self.registers[a], self.registers[b]);
                }
                Code::Cp => {
                    self.status.subtract(self.registers[a], self.registers[b]);
                }
                Code::Cpc => {
                    self.status
                        .subtract_on(self.registers[a], self.registers[b]);
                }
                Code::Cpse => skip_if!(self.registers[a] == self.registers[b]),
                Code::And => {
                    self.registers[a] = self.status.logic(self.registers[a] & self.registers[b]);
                }
                Code::Or => {
                    self.registers[a] = self.status.logic(self.registers[a] | self.registers[b]);
                }
                Code::Eor => {
                    self.registers[a] = self.status.logic(self.registers[a] ^ self.registers[b]);
                }
                Code::Mov => self.registers[a] = self.registers[b],
                Code::Cpi => {
                    self.status.subtract(self.registers[a], op.b as u8);
                }
                Code::Subi => {
                    self.registers[a] = self.status.subtract(self.registers[a], op.b as u8);
                }
                Code::Sbci => {
                    self.registers[a] = self.status.subtract_on(self.registers[a], op.b as u8);
                }
                Code::Ori => {
                    self.registers[a] = self.status.logic(self.registers[a] | op.b as u8);
                }
                Code::Andi => {
                    self.registers[a] = self.status.logic(self.registers[a] & op.b as u8);
                }
                Code::Ldi => self.registers[a] = op.b as u8,

                Code::LddY => self.registers[a] = load!(self.pair(Y).wrapping_add(op.b)),
                Code::LddZ => self.registers[a] = load!(self.pair(Z).wrapping_add(op.b)),
                Code::StdY => store!(self.pair(Y).wrapping_add(op.b), self.registers[a]),
                Code::StdZ => store!(self.pair(Z).wrapping_add(op.b), self.registers[a]),
                Code::LdX => self.registers[a] = load!(self.pair(X)),
                Code::LdXInc | Code::LdYInc | Code::LdZInc => {
                    let pointer = pointer_of(op.code);
                    let address = self.pair(pointer);
                    let value = load!(address);
                    self.set_pair(pointer, address.wrapping_add(1));
                    self.registers[a] = value;
                }
                Code::LdXDec | Code::LdYDec | Code::LdZDec => {
                    let pointer = pointer_of(op.code);
                    let address = self.pair(pointer).wrapping_sub(1);
                    self.set_pair(pointer, address);
                    self.registers[a] = load!(address);
                }
                Code::StX => store!(self.pair(X), self.registers[a]),
                Code::StXInc | Code::StYInc | Code::StZInc => {
                    let pointer = pointer_of(op.code);
                    let address = self.pair(pointer);
                    store!(address, self.registers[a]);
                    self.set_pair(pointer, address.wrapping_add(1));
                }
                Code::StXDec | Code::StYDec | Code::StZDec => {
                    let pointer = pointer_of(op.code);
                    let address = self.pair(pointer).wrapping_sub(1);
                    let value = self.registers[a];
                    self.set_pair(pointer, address);
                    store!(address, value);
                }
                Code::Lds => {
                    pc += 1;
                    self.registers[a] = load!(op.b);
                }
                Code::Sts => {
                    pc += 1;
                    store!(op.b, self.registers[a]);
                }
                Code::Lpm | Code::Elpm => {
                    let address = self.program_pointer(op.code == Code::Elpm);
                    self.registers[a] = self.load_program(io, address, at!(3));
                    cycles = 3;
                }
                Code::LpmInc | Code::ElpmInc => {
                    let extended = op.code == Code::ElpmInc;
                    let address = self.program_pointer(extended);
                    let next = address.wrapping_add(1);
                    self.set_pair(Z, next as u16);
                    if extended {
                        self.rampz = (next >> 16) as u8 & 3;
                    }
                    self.registers[a] = self.load_program(io, address, at!(3));
                    cycles = 3;
                }
                Code::Spm => {
                    let address = self.program_pointer(true);
                    let value = self.pair(0);
                    let stored = io.store_program(address, value, at!(1));
                    self.program(stored);
                    look_up!();
                }
                Code::Push => {
                    self.program_counter = here;
                    let value = self.registers[a];
                    self.push(io, value, cycle + 1);
                    cycles = 2;
                    if self.verdict.is_some() {
                        limit = 0;
                    }
                }
                Code::Pop => {
                    self.program_counter = here;
                    self.registers[a] = self.pop(io, cycle + 1);
                    cycles = 2;
                }

                Code::Com => self.registers[a] = self.status.complement(self.registers[a]),
                Code::Neg => self.registers[a] = self.status.subtract(0, self.registers[a]),
                Code::Swap => self.registers[a] = self.registers[a].rotate_left(4),
                Code::Inc => self.registers[a] = self.status.increment(self.registers[a]),
                Code::Dec => self.registers[a] = self.status.decrement(self.registers[a]),
                Code::Asr => {
                    let before = self.registers[a];
                    self.registers[a] = self.status.shifted(before, before >> 1 | before & 0x80);
                }
                Code::Lsr => {
                    let before = self.registers[a];
                    self.registers[a] = self.status.shifted(before, before >> 1);
                }
                Code::Ror => {
                    let before = self.registers[a];
                    let carry = u8::from(self.status.carry()) << 7;
                    self.registers[a] = self.status.shifted(before, before >> 1 | carry);
                }
                Code::Bset | Code::Bclr => {
                    let mask = 1 << op.a;
                    let bits = self.status.bits();
                    let set = op.code == Code::Bset;
                    self.status = Status::from_bits(if set { bits | mask } else { bits & !mask });
                    if op.a == 7 {
                        self.shadow = set && bits & 0x80 == 0;
                        look_up!();
                    }
                }
                Code::Bld => {
                    let mask = op.b as u8;
                    let register = self.registers[a];
                    self.registers[a] = if self.status.copy() {
                        register | mask
                    } else {
                        register & !mask
                    };
                }
                Code::Bst => self.status.set_copy(self.registers[a] & op.b as u8 != 0),
                Code::Adiw | Code::Sbiw => {
                    let adding = op.code == Code::Adiw;
                    let before = self.pair(a);
                    let result = if adding {
                        before.wrapping_add(op.b)
                    } else {
                        before.wrapping_sub(op.b)
                    };
                    self.set_pair(a, result);
                    self.status.word(before, result, adding);
                    cycles = 2;
                }

                Code::In => {
                    self.registers[a] = self.load_elsewhere(io, 0x20 + (op.b & 0x3F), at!(1));
                    look_up!();
                }
                Code::Out => {
                    let value = self.registers[a];
                    self.store_elsewhere(io, 0x20 + (op.b & 0x3F), value, at!(1));
                    look_up!();
                }
                Code::Sbi | Code::Cbi => {
                    cycles = 2;
                    let set = op.code == Code::Sbi;
                    io.write_bit(0x20 + u16::from(op.a), op.b as u8, set, at!(2));
                    look_up!();
                }
                Code::Sbic | Code::Sbis => {
                    let value = io.read(0x20 + u16::from(op.a), at!(1));
                    let set = value & op.b as u8 != 0;
                    skip_if!(set == (op.code == Code::Sbis));
                    look_up!();
                }
                Code::Sbrc => skip_if!(self.registers[a] & op.b as u8 == 0),
                Code::Sbrs => skip_if!(self.registers[a] & op.b as u8 != 0),

                Code::Rjmp => {
                    pc = op.address();
                    cycles = 2;
                }
                Code::Jmp => {
                    pc = op.address();
                    cycles = 3;
                }
                Code::Ijmp => {
                    pc = u32::from(self.pair(Z));
                    cycles = 2;
                }
                Code::Eijmp => {
                    pc = u32::from(self.eind) << 16 | u32::from(self.pair(Z));
                    cycles = 2;
                }
                Code::Rcall | Code::Call | Code::Icall | Code::Eicall => {
                    let (target, took) = match op.code {
                        Code::Rcall => (op.address(), 4),
                        Code::Call => {
                            pc += 1;
                            (op.address(), 5)
                        }
                        Code::Icall => (u32::from(self.pair(Z)), 4),
                        _ => (u32::from(self.eind) << 16 | u32::from(self.pair(Z)), 4),
                    };
                    self.program_counter = here;
                    self.push_address(io, pc % FLASH_WORDS as u32, cycle + took - 1);
                    pc = target;
                    cycles = took;
                    if self.verdict.is_some() {
                        limit = 0;
                    }
                }
                Code::Ret | Code::Reti => {
                    self.program_counter = here;
                    pc = self.pop_address(io, cycle + 4);
                    cycles = 5;
                    if op.code == Code::Reti {
                        self.status.interrupts = true;
                        self.shadow = true;
                        limit = 0;
                    }
                }
                Code::Breq => branch_if!(self.status.zero(), op.address()),
                Code::Brne => branch_if!(!self.status.zero(), op.address()),
                Code::Brcs => branch_if!(self.status.carry(), op.address()),
                Code::Brcc => branch_if!(!self.status.carry(), op.address()),
                Code::Brbs => branch_if!(self.status.bit(op.a), near(here, op.b)),
                Code::Brbc => branch_if!(!self.status.bit(op.a), near(here, op.b)),

                Code::Sleep => {
                    if io.sleep(cycle) {
                        self.sleeping = true;
                        limit = 0;
                    }
                }
                Code::Wdr => {
                    io.reset_watchdog(cycle);
                    look_up!();
                }
                // Without a debugger on the chip it does nothing.
                Code::Break => {}
                Code::Breakpoint => {
                    self.program_counter = here % FLASH_WORDS as u32;
                    self.cycle = cycle;
                    return true;
                }
                Code::Erased => {
                    self.end(Verdict::ErasedFlash {
                        program_counter: here,
                        cycle,
                    });
                    self.program_counter = here;
                    self.cycle = cycle;
                    return false;
                }
                Code::Illegal => {
                    self.end(Verdict::IllegalInstruction {
                        program_counter: here,
                        word: op.b,
                        cycle,
                    });
                    self.program_counter = here;
                    self.cycle = cycle;
                    return false;
                }
            }
            cycle += cycles;
            if cycle >= limit {
                self.program_counter = pc % FLASH_WORDS as u32;
                self.cycle = cycle;
                return false;
            }
        }
    }

    #[inline(always)]
    fn program_pointer(&self, extended: bool) -> u32 {
        let high = if extended {
            u32::from(self.rampz) << 16
        } else {
            0
        };
        high | u32::from(self.pair(Z))
    }

    #[inline(always)]
    fn multiply(&mut self, product: u16, fractional: bool) {
        let result = self.status.product(product, fractional);
        self.set_pair(0, result);
    }
}

/// The pointer register of a load or store that moves it.
#[inline(always)]
const fn pointer_of(code: Code) -> usize {
    match code {
        Code::LdXInc | Code::LdXDec | Code::StXInc | Code::StXDec => X,
        Code::LdYInc | Code::LdYDec | Code::StYInc | Code::StYDec => Y,
        _ => Z,
    }
}

/// The target of a branch, at a signed distance from its own address.
#[inline(always)]
const fn near(here: u32, distance: u16) -> u32 {
    here.wrapping_add(distance.cast_signed() as i32 as u32) % FLASH_WORDS as u32
}
