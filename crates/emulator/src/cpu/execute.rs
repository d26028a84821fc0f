//! The loop over instructions: what each does and how many cycles it takes.

use super::Cpu;
use crate::decode::{Code, FLASH_WORDS};
use crate::io::{Access, Io};
use crate::status::Status;
use crate::verdict::Verdict;

const X: usize = 26;
const Y: usize = 28;
const Z: usize = 30;

impl Cpu {
    /// Runs instructions while the cycle is below `limit`, at least one; returns whether a breakpoint stopped it.
    pub(super) fn step_until<I: Io>(&mut self, io: &mut I, mut limit: u64, until: u64) -> bool {
        let mut pc = self.program_counter;
        let mut cycle = self.cycle;
        loop {
            let op = self.operations[pc as usize % FLASH_WORDS];
            let (a, b) = (usize::from(op.a), usize::from(op.b as u8));
            let mut cycles = 1;

            /// Where and when an access of this instruction takes place: in its last cycle.
            macro_rules! at {
                ($cycles:expr) => {
                    Access {
                        cycle: cycle + $cycles - 1,
                        program_counter: pc,
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
            macro_rules! load_elsewhere {
                ($address:expr, $at:expr) => {{
                    let value = self.load_elsewhere(io, $address, $at);
                    look_up!();
                    value
                }};
            }
            macro_rules! store_elsewhere {
                ($address:expr, $value:expr, $at:expr) => {{
                    self.store_elsewhere(io, $address, $value, $at);
                    look_up!();
                }};
            }
            macro_rules! load {
                ($address:expr) => {{
                    cycles = 2;
                    let address = $address;
                    match self
                        .sram
                        .get(usize::from(address.wrapping_sub(self.sram_start)))
                    {
                        Some(value) => *value,
                        None => load_elsewhere!(address, at!(2)),
                    }
                }};
            }
            macro_rules! store {
                ($address:expr, $value:expr) => {{
                    cycles = 2;
                    let (address, value) = ($address, $value);
                    match self
                        .sram
                        .get_mut(usize::from(address.wrapping_sub(self.sram_start)))
                    {
                        Some(place) => *place = value,
                        None => store_elsewhere!(address, value, at!(2)),
                    }
                }};
            }
            /// A byte onto the stack, in the last cycle of the instruction.
            macro_rules! push {
                ($cycles:expr, $value:expr) => {{
                    let (address, value) = (self.stack_pointer(), $value);
                    match self
                        .sram
                        .get_mut(usize::from(address.wrapping_sub(self.sram_start)))
                    {
                        Some(place) => *place = value,
                        None => store_elsewhere!(address, value, at!($cycles)),
                    }
                    self.set_stack_pointer(address.wrapping_sub(1));
                }};
            }
            macro_rules! pop {
                ($cycles:expr) => {{
                    let address = self.stack_pointer().wrapping_add(1);
                    self.set_stack_pointer(address);
                    match self
                        .sram
                        .get(usize::from(address.wrapping_sub(self.sram_start)))
                    {
                        Some(value) => *value,
                        None => load_elsewhere!(address, at!($cycles)),
                    }
                }};
            }
            /// After a push: below its floor the stack has overflowed.
            macro_rules! check_stack {
                () => {
                    if self.stack_pointer().wrapping_add(1) < self.stack_floor {
                        self.stack_overflow(pc, cycle + cycles - 1);
                        if self.verdict.is_some() {
                            limit = 0;
                        }
                    }
                };
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
            /// The next instruction is there: the end of the loop adds a word.
            macro_rules! jump {
                ($target:expr) => {
                    pc = $target.wrapping_sub(1)
                };
            }
            /// A target at which the program restarts.
            macro_rules! restart {
                ($target:expr) => {
                    if $target == 0 {
                        self.note_restart(pc);
                    }
                };
            }
            /// A target computed at run time.
            macro_rules! look_ahead {
                ($target:expr) => {
                    if self.is_astray($target) {
                        self.note_astray($target, op.code, pc);
                    }
                };
            }
            macro_rules! branch_if {
                ($condition:expr, $target:expr) => {
                    if $condition {
                        jump!($target);
                        cycles = 2;
                    }
                };
            }

            /// A run ends before the next event, or only its first instruction is done now.
            macro_rules! count {
                ($cycles:expr) => {
                    if cycle + $cycles * u64::from(op.follow()) < limit {
                        1 + op.follow()
                    } else {
                        1
                    }
                };
            }
            /// A run of instructions that look at registers only.
            macro_rules! run {
                ($run:ident $(, $argument:expr)*) => {{
                    let count = count!(1);
                    self.$run(pc, count $(, $argument)*);
                    pc += count - 1;
                    cycles = u64::from(count);
                }};
            }
            /// A run of instructions of two cycles and so many words; else its first one.
            macro_rules! run_or {
                ($words:expr, $run:ident $(($argument:expr))?, $first:expr) => {{
                    let done = self.$run(pc, count!(2) $(, $argument)?);
                    if done > 0 {
                        pc = pc + $words * done - 1;
                        cycles = 2 * u64::from(done);
                    } else {
                        $first
                    }
                }};
            }

            match op.code {
                Code::Pushes => run_or!(1, pushes, {
                    let value = self.registers[a & 31];
                    push!(2, value);
                    cycles = 2;
                    check_stack!();
                }),
                Code::Pops => run_or!(1, pops, {
                    self.registers[a & 31] = pop!(2);
                    cycles = 2;
                }),
                Code::Ldses => run_or!(2, loads(None), {
                    self.registers[a & 31] = load!(op.b);
                    pc += 1;
                }),
                Code::Stses => run_or!(2, stores(None), {
                    store!(op.b, self.registers[a & 31]);
                    pc += 1;
                }),
                Code::LddsY => run_or!(1, loads(Some(Y)), {
                    self.registers[a & 31] = load!(self.pair(Y).wrapping_add(op.b));
                }),
                Code::LddsZ => run_or!(1, loads(Some(Z)), {
                    self.registers[a & 31] = load!(self.pair(Z).wrapping_add(op.b));
                }),
                Code::StdsY => run_or!(1, stores(Some(Y)), {
                    store!(self.pair(Y).wrapping_add(op.b), self.registers[a & 31])
                }),
                Code::StdsZ => run_or!(1, stores(Some(Z)), {
                    store!(self.pair(Z).wrapping_add(op.b), self.registers[a & 31])
                }),
                Code::Ldis | Code::Movs | Code::Movws => run!(moves),
                Code::Adds => {
                    self.status.begin();
                    run!(sum);
                }
                Code::Adcs => run!(sum),
                Code::Subs => {
                    self.status.begin();
                    run!(difference, false, true);
                }
                Code::Sbcs => run!(difference, false, true),
                Code::Subis => {
                    self.status.begin();
                    run!(difference, true, true);
                }
                Code::Sbcis => run!(difference, true, true),
                Code::Cps => {
                    self.status.begin();
                    run!(difference, false, false);
                }
                Code::Cpcs => run!(difference, false, false),
                Code::Cpis => run!(comparison),
                Code::Nop => {}
                Code::Movw => {
                    self.registers[a] = self.registers[b];
                    self.registers[(a + 1) & 31] = self.registers[(b + 1) & 31];
                }
                Code::Muls | Code::Fmuls => {
                    let product = i16::from(self.registers[a].cast_signed())
                        * i16::from(self.registers[b].cast_signed());
                    let result = self
                        .status
                        .product(product.cast_unsigned(), op.code == Code::Fmuls);
                    self.set_pair(0, result);
                    cycles = 2;
                }
                Code::Mulsu | Code::Fmulsu => {
                    let product = i16::from(self.registers[a].cast_signed())
                        .wrapping_mul(i16::from(self.registers[b]));
                    let result = self
                        .status
                        .product(product.cast_unsigned(), op.code == Code::Fmulsu);
                    self.set_pair(0, result);
                    cycles = 2;
                }
                Code::Mul | Code::Fmul => {
                    let product = u16::from(self.registers[a]) * u16::from(self.registers[b]);
                    let result = self.status.product(product, op.code == Code::Fmul);
                    self.set_pair(0, result);
                    cycles = 2;
                }
                Code::Add => {
                    self.registers[a] = self.status.add(self.registers[a], self.registers[b], 0);
                }
                Code::Adc => {
                    self.registers[a] = self.status.add_on(self.registers[a], self.registers[b]);
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
                    self.registers[a] = load!(op.b);
                    pc += 1;
                }
                Code::Sts => {
                    store!(op.b, self.registers[a]);
                    pc += 1;
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
                    let value = self.registers[a];
                    push!(2, value);
                    cycles = 2;
                    check_stack!();
                }
                Code::Pop => {
                    self.registers[a] = pop!(2);
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
                    let carry = self.status.carry_on_top();
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
                    let address = 0x20 + (op.b & 0x3F);
                    self.registers[a] = load_elsewhere!(address, at!(1));
                }
                Code::Out => {
                    let address = 0x20 + (op.b & 0x3F);
                    store_elsewhere!(address, self.registers[a], at!(1));
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
                    jump!(op.address());
                    cycles = 2;
                }
                Code::Jmp => {
                    restart!(op.address());
                    jump!(op.address());
                    cycles = 3;
                }
                Code::Ijmp | Code::Eijmp => {
                    let target = self.pointed(op.code == Code::Eijmp);
                    look_ahead!(target);
                    restart!(target);
                    jump!(target);
                    cycles = 2;
                }
                Code::Rcall | Code::Call | Code::Icall | Code::Eicall => {
                    let mut back = pc + 1;
                    let (target, took) = match op.code {
                        Code::Rcall => (op.address(), 4),
                        Code::Call => {
                            back += 1;
                            (op.address(), 5)
                        }
                        _ => {
                            let target = self.pointed(op.code == Code::Eicall);
                            look_ahead!(target);
                            (target, 4)
                        }
                    };
                    let [low, middle, high, _] = (back & self.last_word).to_le_bytes();
                    cycles = took - u64::from(!self.is_far);
                    let stored = if self.is_far {
                        self.store_address([high, middle, low])
                    } else {
                        self.store_address([middle, low])
                    };
                    if !stored {
                        push!(cycles, low);
                        push!(cycles, middle);
                        if self.is_far {
                            push!(cycles, high);
                        }
                    }
                    check_stack!();
                    restart!(target);
                    jump!(target);
                }
                Code::Ret | Code::Reti => {
                    cycles = 5 - u64::from(!self.is_far);
                    let stored = if self.is_far {
                        let bytes = self.load_address::<3>();
                        bytes.map(|[high, middle, low]| [0, high, middle, low])
                    } else {
                        let bytes = self.load_address::<2>();
                        bytes.map(|[high, low]| [0, 0, high, low])
                    };
                    let bytes = match stored {
                        Some(bytes) => bytes,
                        None if self.is_far => [0, pop!(cycles), pop!(cycles), pop!(cycles)],
                        None => [0, 0, pop!(cycles), pop!(cycles)],
                    };
                    // The program counter of a Mega has 17 bits, that of an Uno 14.
                    let target = u32::from_be_bytes(bytes) & self.last_word;
                    look_ahead!(target);
                    restart!(target);
                    jump!(target);
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
                Code::Brbs => branch_if!(self.status.bit(op.a), near(pc, op.b)),
                Code::Brbc => branch_if!(!self.status.bit(op.a), near(pc, op.b)),

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
                    self.rest(pc, cycle);
                    return true;
                }
                Code::Waits => {
                    if self.arrive(pc, cycle, limit) {
                        self.rest(pc, cycle);
                        return false;
                    }
                    continue;
                }
                Code::Erased if self.runs_through(pc) => {}
                Code::Erased => {
                    self.rest(pc, cycle);
                    self.end(Verdict::ErasedFlash {
                        program_counter: self.program_counter,
                        arrival: self.arrival(self.program_counter),
                        cycle,
                    });
                    return false;
                }
                Code::Illegal => {
                    self.rest(pc, cycle);
                    self.end(Verdict::IllegalInstruction {
                        program_counter: self.program_counter,
                        word: op.b,
                        arrival: self.arrival(self.program_counter),
                        cycle,
                    });
                    return false;
                }
            }
            pc = pc.wrapping_add(1);
            cycle += cycles;
            if cycle >= limit {
                self.rest(pc, cycle);
                return false;
            }
        }
    }

    /// Leaves everything where it is found again.
    fn rest(&mut self, program_counter: u32, cycle: u64) {
        self.program_counter = program_counter & self.last_word;
        self.cycle = cycle;
    }

    /// Where Z leads as a pointer to an instruction [words].
    #[inline(always)]
    fn pointed(&self, extended: bool) -> u32 {
        let high = if extended {
            u32::from(self.eind) << 16
        } else {
            0
        };
        high | u32::from(self.pair(Z))
    }

    /// Pushes a return address, the high byte first in memory, if all of it goes to SRAM.
    #[inline(always)]
    fn store_address<const N: usize>(&mut self, bytes: [u8; N]) -> bool {
        let top = self.stack_pointer();
        let lowest = top.wrapping_sub(N as u16 - 1);
        let start = usize::from(lowest.wrapping_sub(self.sram_start));
        let Some(places) = self.sram.get_mut(start..start + N) else {
            return false;
        };
        places.copy_from_slice(&bytes);
        self.set_stack_pointer(top.wrapping_sub(N as u16));
        true
    }

    /// Pops a return address, if all of it is in SRAM.
    #[inline(always)]
    fn load_address<const N: usize>(&mut self) -> Option<[u8; N]> {
        let top = self.stack_pointer();
        let start = usize::from(top.wrapping_add(1).wrapping_sub(self.sram_start));
        let bytes = *self.sram.get(start..start + N)?.first_chunk()?;
        self.set_stack_pointer(top.wrapping_add(N as u16));
        Some(bytes)
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
    let flipped = (distance ^ 0x8000) as u32;
    here.wrapping_add(flipped).wrapping_sub(0x8000) % FLASH_WORDS as u32
}
