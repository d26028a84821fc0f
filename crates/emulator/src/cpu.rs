//! The CPU: registers, memories, and the loop that runs predecoded operations.
//!
//! # Theory of operation
//!
//! The loop runs until `limit`, the cycle of whatever comes first: the caller's end, an event of the peripherals, or
//! nothing at all when an interrupt may be due. Only there does it look up from the program: it lets the peripherals
//! catch up, enters an interrupt, or sleeps. An access to a peripheral may change when the next event is, so it sets
//! the limit anew. Cost thus grows with what happens, not with what exists.
//!
//! Instruction timing: DS40002549 (ATmega640/1280/1281/2560/2561), section 33; interrupts take 5 cycles to enter, 5 more
//! out of sleep, and the instruction after SEI or RETI always runs first (sections 7.7 and 7.8).

use crate::decode::{Code, FLASH_WORDS, Op, decode};
use crate::io::{Access, Io};
use crate::status::Status;
use crate::verdict::Verdict;

/// First address of SRAM in the data space.
pub const SRAM_START: u16 = 0x200;
/// Bytes of SRAM.
pub const SRAM_BYTES: usize = 0x2000;
/// Last address of SRAM.
pub const RAMEND: u16 = 0x21FF;
/// Bytes of flash.
pub const FLASH_BYTES: usize = 2 * FLASH_WORDS;

const RAMPZ: u16 = 0x5B;
const EIND: u16 = 0x5C;
const SPL: u16 = 0x5D;
const SPH: u16 = 0x5E;
const SREG: u16 = 0x5F;

const X: usize = 26;
const Y: usize = 28;
const Z: usize = 30;

/// Cycles from the recognition of an interrupt to the first instruction of its routine: a jump in the table.
const ENTRY_CYCLES: u64 = 5;
/// Cycles more out of sleep.
const WAKE_CYCLES: u64 = 5;

/// Why [`Cpu::run`] returned.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Stopped {
    /// The cycle was reached.
    Reached,
    /// A breakpoint stands at the program counter; nothing of the instruction has been done.
    Breakpoint,
    /// The program cannot go on.
    Ended(Verdict),
}

/// The processor with its memories.
#[derive(Clone, Debug)]
pub struct Cpu {
    registers: [u8; 32],
    status: Status,
    stack_pointer: u16,
    program_counter: u32,
    cycle: u64,
    rampz: u8,
    eind: u8,
    sram: Box<[u8; SRAM_BYTES]>,
    flash: Box<[u8]>,
    operations: Box<[Op; FLASH_WORDS]>,
    breakpoints: Vec<u32>,
    /// Pushing below this address runs the stack into data.
    stack_floor: u16,
    sleeping: bool,
    /// The next instruction runs before any interrupt.
    shadow: bool,
    verdict: Option<Verdict>,
}

impl Cpu {
    /// A processor after power-on with this program in its flash; what `flash` does not fill is erased.
    ///
    /// Anything beyond [`FLASH_BYTES`] is ignored: loaders refuse it before.
    pub fn new(program: &[u8]) -> Cpu {
        let mut flash = vec![0xFF; FLASH_BYTES];
        let fits = program.len().min(FLASH_BYTES);
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
            registers: [0; 32],
            status: Status::default(),
            stack_pointer: RAMEND,
            program_counter: 0,
            cycle: 0,
            rampz: 0,
            eind: 0,
            sram: Box::new([0; SRAM_BYTES]),
            flash: flash.into(),
            operations,
            breakpoints: Vec::new(),
            stack_floor: SRAM_START,
            sleeping: false,
            shadow: false,
            verdict: None,
        };
        cpu.status = Status::from_bits(0);
        for word in 0..fits.div_ceil(2) as u32 {
            cpu.predecode(word);
        }
        cpu
    }

    /// Starts over at address `program_counter` [words], as after a reset: memories keep what they hold.
    pub fn reset(&mut self, program_counter: u32) {
        self.status = Status::from_bits(0);
        self.stack_pointer = RAMEND;
        self.program_counter = program_counter % FLASH_WORDS as u32;
        self.rampz = 0;
        self.eind = 0;
        self.sleeping = false;
        self.shadow = false;
        self.verdict = None;
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
        self.program_counter = words % FLASH_WORDS as u32;
    }

    /// The registers r0 to r31.
    pub fn registers(&self) -> &[u8; 32] {
        &self.registers
    }

    /// The same, to change them.
    pub fn registers_mut(&mut self) -> &mut [u8; 32] {
        &mut self.registers
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
    pub fn stack_pointer(&self) -> u16 {
        self.stack_pointer
    }

    /// Sets the stack pointer.
    pub fn set_stack_pointer(&mut self, address: u16) {
        self.stack_pointer = address;
    }

    /// The SRAM, from [`SRAM_START`] on.
    pub fn sram(&self) -> &[u8; SRAM_BYTES] {
        &self.sram
    }

    /// The same, to change it.
    pub fn sram_mut(&mut self) -> &mut [u8; SRAM_BYTES] {
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

    /// Pushing below this address is a stack that has run into data.
    pub fn set_stack_floor(&mut self, address: u16) {
        self.stack_floor = address.max(SRAM_START);
    }

    /// Stops before the instruction at `word`; takes no time until it is reached.
    pub fn set_breakpoint(&mut self, word: u32) {
        let word = word % FLASH_WORDS as u32;
        if !self.breakpoints.contains(&word) {
            self.breakpoints.push(word);
        }
        self.predecode(word);
    }

    /// Removes a breakpoint.
    pub fn clear_breakpoint(&mut self, word: u32) {
        let word = word % FLASH_WORDS as u32;
        self.breakpoints.retain(|other| *other != word);
        self.predecode(word);
    }

    /// Writes a word of flash, as SPM does.
    pub fn write_flash(&mut self, word: u32, value: u16) {
        let word = word % FLASH_WORDS as u32;
        let at = 2 * word as usize;
        let [low, high] = value.to_le_bytes();
        self.flash[at] = low;
        self.flash[at + 1] = high;
        // The word before may be a skip that must know how long this one is, or the first half of it.
        self.predecode(word.wrapping_sub(1) % FLASH_WORDS as u32);
        self.predecode(word);
    }

    fn flash_word(&self, word: u32) -> u16 {
        let at = 2 * (word as usize % FLASH_WORDS);
        u16::from_le_bytes([self.flash[at], self.flash[at + 1]])
    }

    fn original(&self, word: u32) -> Op {
        decode(word, self.flash_word(word), self.flash_word(word + 1))
    }

    fn predecode(&mut self, word: u32) {
        let mut op = self.original(word);
        if self.breakpoints.contains(&word) {
            op.code = Code::Breakpoint;
        }
        self.operations[word as usize % FLASH_WORDS] = op;
    }

    /// Runs until `until` cycles have passed since power-on, to the end of the instruction that passes them.
    pub fn run<I: Io>(&mut self, io: &mut I, until: u64) -> Stopped {
        loop {
            if let Some(verdict) = &self.verdict {
                return Stopped::Ended(verdict.clone());
            }
            if self.cycle >= until {
                return Stopped::Reached;
            }
            io.advance(self.cycle);
            if !self.shadow {
                if self.sleeping && !self.wake(io, until) {
                    continue;
                }
                self.enter_interrupt(io);
            }
            // One instruction only while an interrupt waits for it, else up to the next event.
            let limit = if self.shadow {
                self.cycle
            } else {
                io.deadline(self.status.interrupts).min(until)
            };
            self.shadow = false;
            if self.step_until(io, limit, until) {
                return Stopped::Breakpoint;
            }
        }
    }

    /// Runs the instruction at a breakpoint, and no other.
    pub fn step<I: Io>(&mut self, io: &mut I) -> Stopped {
        let here = self.program_counter;
        let held = self.breakpoints.contains(&here);
        if held {
            self.operations[here as usize % FLASH_WORDS] = self.original(here);
        }
        let stopped = self.run(io, self.cycle + 1);
        if held {
            self.predecode(here);
        }
        stopped
    }

    /// Sleeps on to the next event; says whether the CPU is awake.
    fn wake<I: Io>(&mut self, io: &mut I, until: u64) -> bool {
        if io.pending().is_some() {
            self.sleeping = false;
            self.cycle += WAKE_CYCLES;
            return true;
        }
        let next = io.deadline(true).max(self.cycle + 1);
        self.cycle = next.min(until);
        false
    }

    fn enter_interrupt<I: Io>(&mut self, io: &mut I) {
        if !self.status.interrupts {
            return;
        }
        let Some(vector) = io.pending() else { return };
        io.acknowledge(vector, self.cycle);
        self.push_address(io, self.program_counter, self.cycle);
        self.status.interrupts = false;
        self.program_counter = u32::from(vector) * 2 + io.vector_base();
        self.cycle += ENTRY_CYCLES;
    }

    #[inline(always)]
    fn pair(&self, low: usize) -> u16 {
        u16::from_le_bytes([self.registers[low & 31], self.registers[(low + 1) & 31]])
    }

    #[inline(always)]
    fn set_pair(&mut self, low: usize, value: u16) {
        let [l, h] = value.to_le_bytes();
        self.registers[low & 31] = l;
        self.registers[(low + 1) & 31] = h;
    }

    #[inline(always)]
    fn load<I: Io>(&mut self, io: &mut I, address: u16, at: Access) -> u8 {
        let index = usize::from(address.wrapping_sub(SRAM_START));
        if index < SRAM_BYTES {
            self.sram[index]
        } else {
            self.load_elsewhere(io, address, at)
        }
    }

    #[inline(never)]
    fn load_elsewhere<I: Io>(&mut self, io: &mut I, address: u16, at: Access) -> u8 {
        match address {
            0..32 => self.registers[usize::from(address) & 31],
            RAMPZ => self.rampz,
            EIND => self.eind,
            SPL => self.stack_pointer.to_le_bytes()[0],
            SPH => self.stack_pointer.to_le_bytes()[1],
            SREG => self.status.bits(),
            _ => io.read(address, at),
        }
    }

    /// Stores a byte; says whether the limit must be set anew.
    #[inline(always)]
    fn store<I: Io>(&mut self, io: &mut I, address: u16, value: u8, at: Access) -> bool {
        let index = usize::from(address.wrapping_sub(SRAM_START));
        if index < SRAM_BYTES {
            self.sram[index] = value;
            false
        } else {
            self.store_elsewhere(io, address, value, at);
            true
        }
    }

    #[inline(never)]
    fn store_elsewhere<I: Io>(&mut self, io: &mut I, address: u16, value: u8, at: Access) {
        let [low, high] = self.stack_pointer.to_le_bytes();
        match address {
            0..32 => self.registers[usize::from(address) & 31] = value,
            RAMPZ => self.rampz = value & 3,
            EIND => self.eind = value & 1,
            SPL => self.stack_pointer = u16::from_le_bytes([value, high]),
            SPH => self.stack_pointer = u16::from_le_bytes([low, value]),
            SREG => {
                let enabled_before = self.status.interrupts;
                self.status = Status::from_bits(value);
                self.shadow |= self.status.interrupts && !enabled_before;
            }
            _ => io.write(address, value, at),
        }
    }

    #[inline(always)]
    fn push<I: Io>(&mut self, io: &mut I, value: u8, cycle: u64) {
        let at = Access {
            cycle,
            program_counter: self.program_counter,
        };
        self.store(io, self.stack_pointer, value, at);
        self.stack_pointer = self.stack_pointer.wrapping_sub(1);
        if self.stack_pointer.wrapping_add(1) < self.stack_floor {
            self.stack_overflow(cycle);
        }
    }

    #[cold]
    fn stack_overflow(&mut self, cycle: u64) {
        self.end(Verdict::StackOverflow {
            program_counter: self.program_counter,
            stack_pointer: self.stack_pointer,
            floor: self.stack_floor,
            cycle,
        });
    }

    #[cold]
    fn end(&mut self, verdict: Verdict) {
        self.verdict.get_or_insert(verdict);
    }

    #[inline(always)]
    fn pop<I: Io>(&mut self, io: &mut I, cycle: u64) -> u8 {
        let at = Access {
            cycle,
            program_counter: self.program_counter,
        };
        self.stack_pointer = self.stack_pointer.wrapping_add(1);
        self.load(io, self.stack_pointer, at)
    }

    #[inline(always)]
    fn push_address<I: Io>(&mut self, io: &mut I, words: u32, cycle: u64) {
        let [low, middle, high, _] = words.to_le_bytes();
        self.push(io, low, cycle);
        self.push(io, middle, cycle);
        self.push(io, high, cycle);
    }

    #[inline(always)]
    fn pop_address<I: Io>(&mut self, io: &mut I, cycle: u64) -> u32 {
        let high = self.pop(io, cycle);
        let middle = self.pop(io, cycle);
        let low = self.pop(io, cycle);
        u32::from_le_bytes([low, middle, high, 0]) % FLASH_WORDS as u32
    }

    #[inline(always)]
    fn program_byte(&self, address: u32) -> u8 {
        self.flash[address as usize % FLASH_BYTES]
    }

    /// Runs instructions while the cycle is below `limit`, at least one; says whether a breakpoint stopped it.
    fn step_until<I: Io>(&mut self, io: &mut I, mut limit: u64, until: u64) -> bool {
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
                    self.registers[a] = self.program_byte(address);
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
                    self.registers[a] = self.program_byte(address);
                    cycles = 3;
                }
                Code::Spm => {
                    let address = self.program_pointer(true);
                    let value = self.pair(0);
                    let held = io.store_program(address, value, at!(1));
                    for (word, value) in held {
                        self.write_flash(word, value);
                    }
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
