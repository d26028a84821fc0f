//! Random programs: all of the chip's instructions in any order, each program ending in a report of all that it left.

use super::assembler::*;
use super::bench::{TCNT1H, TCNT1L, UCSR0A, UDR0};
use rumbo_emulator::model::Model;

/// 32 registers, SREG, SPL, SPH, TCNT1L, TCNT1H.
const REPORT_BYTES: u8 = 37;
/// Programs store from the second page of SRAM on, in this many bytes.
const DATA_BYTES: u16 = 0x400;

/// Where a program has what, on one model.
#[derive(Clone, Copy)]
struct Layout {
    model: &'static Model,
    /// Final registers, status, stack pointer and timer are put here before they are reported.
    report: u16,
    data: u16,
    /// The stack starts here: programs may pop more than they pushed.
    stack: u16,
}

impl Layout {
    fn new(model: &'static Model) -> Layout {
        Layout {
            model,
            report: model.ram_end - 0x7F,
            data: model.sram_start + 0x100,
            stack: model.ram_end - 0xFF,
        }
    }

    fn address(&self, random: &mut Random) -> u16 {
        self.data + random.below(DATA_BYTES)
    }
}

/// GPIOR0, a register without side effects in reach of SBI.
const GPIOR0: u8 = 0x1E;
const SREG: u8 = 0x3F;
const SPL: u8 = 0x3D;
const SPH: u8 = 0x3E;
const RAMPZ: u8 = 0x3B;
const EIND: u8 = 0x3C;

/// A reproducible source of numbers (splitmix64).
pub(crate) struct Random(pub(crate) u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ z >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ z >> 31
    }

    pub(crate) fn below(&mut self, end: u16) -> u16 {
        (self.next() % u64::from(end)) as u16
    }

    fn byte(&mut self) -> u8 {
        self.below(256) as u8
    }

    pub(crate) fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[usize::from(self.below(from.len() as u16))]
    }
}

/// Words of flash being written.
#[derive(Default)]
pub(crate) struct Program {
    pub(crate) words: Vec<u16>,
}

impl Program {
    fn put(&mut self, words: impl IntoIterator<Item = u16>) {
        self.words.extend(words);
    }

    fn here(&self) -> u32 {
        self.words.len() as u32
    }

    /// An image of `count` programs, which reports each on a line and then sleeps for ever.
    pub(crate) fn image(model: &'static Model, seed: u64, count: u16) -> Program {
        let layout = Layout::new(model);
        let mut program = Program::default();
        // A jump over the routines, which are called from everywhere.
        program.put(jump(0x940C, 0));
        let report = program.here();
        program.write_report(layout);
        let routines: Vec<u32> = {
            let mut random = Random(seed ^ 0xABCD);
            (0..8).map(|_| program.write_routine(&mut random)).collect()
        };
        let start = program.here();
        program.words[1] = start as u16;
        program.write_set_up(layout);
        for number in 0..count {
            let mut random = Random(seed.wrapping_mul(1_000_003).wrapping_add(u64::from(number)));
            program.write_one(layout, &mut random, report, &routines);
        }
        // CLI, SLEEP: the end.
        program.put([0x94F8, 0x9588, relative(0xC000, -1)]);
        program
    }

    /// USART0 as fast as it goes, the timer at the CPU's clock, data cleared, sleeping enabled.
    fn write_set_up(&mut self, layout: Layout) {
        self.put([ldi(16, 2)]);
        self.put(sts(UCSR0A, 16));
        self.put([ldi(16, 0)]);
        for address in [0xC5, 0xC4, 0x80] {
            self.put(sts(address, 16));
        }
        self.put([ldi(16, 8)]);
        self.put(sts(0xC1, 16));
        self.put([ldi(16, 1)]);
        self.put(sts(0x81, 16));
        // Y over the SRAM: clear.
        let [start, end] = [layout.model.sram_start, layout.model.ram_end + 1];
        self.put([ldi(28, 0), ldi(29, (start >> 8) as u8), ldi(16, 0)]);
        self.put([
            one(0x9209, 16),
            immediate(0x3000, 29, (end >> 8) as u8),
            branch(0xF400, 1, -3),
        ]);
        // Sleep mode control: enabled.
        self.put([ldi(16, 1), output(0x33, 16)]);
    }

    /// Reports what lies at REPORT and a hash of the data, in hexadecimal, on a line.
    fn write_report(&mut self, layout: Layout) {
        let send_nibbles = |program: &mut Program, register: u8| {
            for swap in [true, false] {
                program.put([mov(20, register)]);
                if swap {
                    program.put([one(0x9402, 20)]);
                }
                // & 0xF, + '0', and 7 more beyond '9'.
                program.put([immediate(0x7000, 20, 0x0F), immediate(0x5000, 20, 0xD0)]);
                program.put([
                    immediate(0x3000, 20, 0x3A),
                    branch(0xF000, 0, 1),
                    immediate(0x5000, 20, 0xF9),
                ]);
                program.put_byte();
            }
        };
        // The hash first: r24 and r25 over the data, rotated and summed.
        let [low, high] = layout.data.to_le_bytes();
        self.put([ldi(26, low), ldi(27, high), ldi(24, 0), ldi(25, 0)]);
        let again = self.here();
        self.put([
            one(0x900D, 18),
            two(0x0C00, 24, 24),
            two(0x1C00, 25, 25),
            ldi(19, 0),
        ]);
        self.put([
            two(0x1C00, 24, 19),
            two(0x2400, 24, 18),
            two(0x0C00, 25, 24),
        ]);
        let end = ((layout.data + DATA_BYTES) >> 8) as u8;
        self.put([immediate(0x3000, 27, end)]);
        let back = again as i16 - (self.here() as i16 + 1);
        self.put([branch(0xF400, 1, back)]);
        // Then the report's bytes.
        let [low, high] = layout.report.to_le_bytes();
        self.put([ldi(26, low), ldi(27, high), ldi(23, REPORT_BYTES)]);
        let again = self.here();
        self.put([one(0x900D, 22)]);
        send_nibbles(self, 22);
        self.put([one(0x940A, 23)]);
        // Too far for a branch: skip a jump.
        self.put([branch(0xF000, 1, 2)]);
        self.put(jump(0x940C, again));
        send_nibbles(self, 24);
        send_nibbles(self, 25);
        self.put([ldi(20, b'\n')]);
        self.put_byte();
        self.put([RET]);
    }

    /// Sends r20 when the line is free.
    fn put_byte(&mut self) {
        // LDS r21, UCSR0A; SBRS r21, 5; RJMP back.
        self.put(lds(21, UCSR0A));
        self.put([one(0xFE05, 21), relative(0xC000, -4)]);
        self.put(sts(UDR0, 20));
    }

    /// A routine that leaves its mark and returns.
    fn write_routine(&mut self, random: &mut Random) -> u32 {
        let start = self.here();
        for _ in 0..3 {
            let words = arithmetic(random);
            self.put(words);
        }
        self.put([RET]);
        start
    }

    fn write_one(&mut self, layout: Layout, random: &mut Random, report: u32, routines: &[u32]) {
        let [low, high] = layout.stack.to_le_bytes();
        for (register, value) in [(SPH, high), (SPL, low)] {
            self.put([ldi(16, value), output(register, 16)]);
        }
        if layout.model.is_far() {
            self.put([ldi(16, 0), output(EIND, 16)]);
        }
        for register in 0..16 {
            self.put([ldi(16, random.byte()), mov(register, 16)]);
        }
        for register in 16..26 {
            self.put([ldi(register, random.byte())]);
        }
        for pointer in [26, 28, 30] {
            self.put(set_pointer(pointer, layout.address(random)));
        }
        // SREG without I; then the timer starts at 0.
        let flags = random.byte() & 0x7F;
        self.put([ldi(16, 0)]);
        self.put(sts(TCNT1H, 16));
        self.put(sts(TCNT1L, 16));
        self.put([ldi(16, flags), output(SREG, 16), ldi(16, random.byte())]);

        let mut items = Vec::new();
        for _ in 0..60 {
            items.push(item(layout, random, routines));
        }
        self.write_items(&items);

        for register in 0..32 {
            self.put(sts(layout.report + u16::from(register), register));
        }
        self.put([input(16, SREG)]);
        self.put(sts(layout.report + 32, 16));
        for (index, address) in [(33, SPL), (34, SPH)] {
            self.put([input(16, address)]);
            self.put(sts(layout.report + index, 16));
        }
        for (index, address) in [(35, TCNT1L), (36, TCNT1H)] {
            self.put(lds(16, address));
            self.put(sts(layout.report + index, 16));
        }
        self.put(jump(CALL, report));
    }

    /// Puts items in place; branches get their distance to the item that they lead to.
    fn write_items(&mut self, items: &[Item]) {
        for (index, item) in items.iter().enumerate() {
            match item {
                Item::Words(words) => self.put(words.iter().copied()),
                Item::Branch(base, flag, over) => {
                    let end = (index + 1 + usize::from(*over)).min(items.len());
                    let words: usize = items[index + 1..end].iter().map(Item::len).sum();
                    self.put([branch(*base, *flag, words as i16)]);
                }
                Item::Jump(base, over) => {
                    let end = (index + 1 + usize::from(*over)).min(items.len());
                    let words: usize = items[index + 1..end].iter().map(Item::len).sum();
                    self.put([relative(*base, words as i16)]);
                }
            }
        }
    }
}

/// Something of which a program is made.
enum Item {
    Words(Vec<u16>),
    /// A branch over the next items: base, flag, how many.
    Branch(u16, u8, u8),
    /// RJMP or RCALL over the next items.
    Jump(u16, u8),
}

impl Item {
    fn len(&self) -> usize {
        match self {
            Item::Words(words) => words.len(),
            Item::Branch(..) | Item::Jump(..) => 1,
        }
    }
}

fn set_pointer(pointer: u8, address: u16) -> [u16; 2] {
    let [low, high] = address.to_le_bytes();
    [ldi(pointer, low), ldi(pointer + 1, high)]
}

/// Registers that may be changed at will: not the pointers.
fn free(random: &mut Random) -> u8 {
    random.below(26) as u8
}

fn free_upper(random: &mut Random) -> u8 {
    16 + random.below(10) as u8
}

fn any(random: &mut Random) -> u8 {
    random.below(32) as u8
}

fn arithmetic(random: &mut Random) -> Vec<u16> {
    vec![match random.below(8) {
        // ADD ADC SUB SBC AND EOR OR MOV
        0..=2 => {
            let base = random.pick(&[
                0x0C00, 0x1C00, 0x1800, 0x0800, 0x2000, 0x2400, 0x2800, 0x2C00,
            ]);
            two(base, free(random), any(random))
        }
        // CP CPC
        3 => two(random.pick(&[0x1400, 0x0400]), any(random), any(random)),
        // SUBI SBCI ORI ANDI LDI; CPI may look at a pointer too
        4 => {
            let base = random.pick(&[0x5000, 0x4000, 0x6000, 0x7000, 0xE000, 0x3000]);
            immediate(base, free_upper(random), random.byte())
        }
        // COM NEG SWAP INC ASR LSR ROR DEC
        5 => {
            let base = random.pick(&[
                0x9400, 0x9401, 0x9402, 0x9403, 0x9405, 0x9406, 0x9407, 0x940A,
            ]);
            one(base, free(random))
        }
        // MUL, MULS, MULSU, FMUL, FMULS, FMULSU
        6 => match random.below(3) {
            0 => two(0x9C00, any(random), any(random)),
            1 => 0x0200 | random.below(256),
            _ => {
                random.pick(&[0x0300, 0x0308, 0x0380, 0x0388])
                    | random.below(8) << 4
                    | random.below(8)
            }
        },
        // ADIW SBIW on r24; MOVW. Constants whose low digit is C to F are left out: after a skip simavr 1.6 takes such
        // an ADIW or SBIW for a JMP and skips two words (manual DS40002198: JMP is 1001 010k, these are 1001 011x).
        _ => match random.below(3) {
            0 => 0x9600 | random.below(12) | random.below(4) << 6,
            1 => 0x9700 | random.below(12) | random.below(4) << 6,
            _ => 0x0100 | random.below(13) << 4 | random.below(16),
        },
    }]
}

fn memory(layout: Layout, random: &mut Random) -> Vec<u16> {
    let pointers = [26u8, 28, 30];
    match random.below(5) {
        // LD and ST with X, X+, -X, Y+, -Y, Z+, -Z
        0 | 1 => {
            let store = random.pick(&[0x9000, 0x9200]);
            let mode = random.pick(&[0xC, 0xD, 0xE, 0x9, 0xA, 0x1, 0x2]);
            vec![one(store | mode, free(random))]
        }
        // LDD and STD
        2 => {
            let q = random.below(64);
            let bits = (q & 0x20) << 8 | (q & 0x18) << 7 | q & 7;
            let base = random.pick(&[0x8000, 0x8008, 0x8200, 0x8208]);
            vec![one(base | bits, free(random))]
        }
        3 => {
            let address = layout.address(random);
            let register = free(random);
            if random.below(2) == 0 {
                lds(register, address).into()
            } else {
                sts(address, any(random)).into()
            }
        }
        _ => set_pointer(random.pick(&pointers), layout.address(random)).into(),
    }
}

fn program_memory(layout: Layout, random: &mut Random) -> Vec<u16> {
    let address = random.below(0x4000);
    if !layout.model.is_far() {
        let mut words = vec![0x0000];
        words.extend(set_pointer(30, address));
        // LPM Z, LPM Z+; and that into r0
        let mode = random.pick(&[0x9004, 0x9005]);
        words.push(match random.below(3) {
            0 => 0x95C8,
            _ => one(mode, free(random)),
        });
        words.extend([mov(22, 30), mov(23, 31)]);
        words.extend(set_pointer(30, layout.address(random)));
        return words;
    }
    let high = random.below(4) as u8;
    let mut words = vec![0x0000, ldi(20, high), output(RAMPZ, 20)];
    words.extend(set_pointer(30, address));
    // LPM Z, LPM Z+, ELPM Z, ELPM Z+; and those into r0
    let mode = random.pick(&[0x9004, 0x9005, 0x9006, 0x9007]);
    words.push(match random.below(6) {
        0 => 0x95C8,
        1 => 0x95D8,
        _ => one(mode, free(random)),
    });
    // What is left in RAMPZ and Z.
    words.extend([input(21, RAMPZ), mov(22, 30), mov(23, 31)]);
    words.extend(set_pointer(30, layout.address(random)));
    words
}

fn item(layout: Layout, random: &mut Random, routines: &[u32]) -> Item {
    let flag = random.below(8) as u8;
    let over = random.below(4) as u8;
    match random.below(24) {
        0..=8 => Item::Words(arithmetic(random)),
        9..=12 => Item::Words(memory(layout, random)),
        13 => Item::Branch(random.pick(&[0xF000, 0xF400]), flag, over),
        14 => Item::Jump(random.pick(&[0xC000, 0xD000]), over),
        // CPSE, SBRC, SBRS, over whatever follows
        15 => {
            let words = match random.below(3) {
                0 => two(0x1000, any(random), any(random)),
                1 => one(0xFC00 | u16::from(flag), any(random)),
                _ => one(0xFE00 | u16::from(flag), any(random)),
            };
            Item::Words(vec![words])
        }
        16 => Item::Words(vec![bit_of_io(
            random.pick(&[0x9800, 0x9900, 0x9A00, 0x9B00]),
            GPIOR0,
            flag,
        )]),
        17 => Item::Words(vec![if random.below(2) == 0 {
            input(free(random), random.pick(&[GPIOR0, SREG, SPL, SPH]))
        } else {
            output(GPIOR0, any(random))
        }]),
        // PUSH, POP
        18 | 19 => Item::Words(vec![if random.below(2) == 0 {
            one(0x920F, any(random))
        } else {
            one(0x900F, free(random))
        }]),
        // BST, BLD, BSET and BCLR but I
        20 => Item::Words(vec![match random.below(3) {
            0 => one(0xFA00 | u16::from(flag), any(random)),
            1 => one(0xF800 | u16::from(flag), free(random)),
            _ => random.pick(&[0x9408, 0x9488]) | random.below(7) << 4,
        }]),
        21 => Item::Words(program_memory(layout, random)),
        // CALL, ICALL, EICALL
        22 => {
            let routine = random.pick(routines);
            // A skip before may take the first word, which must not be half of the pointer.
            let mut words = vec![0x0000];
            words.extend(set_pointer(30, routine as u16));
            let kinds = if layout.model.is_far() { 3 } else { 2 };
            match random.below(kinds) {
                0 => words = jump(CALL, routine).into(),
                1 => words.push(0x9509),
                _ => words.push(0x9519),
            }
            words.extend(set_pointer(30, layout.address(random)));
            Item::Words(words)
        }
        // NOP, WDR
        _ => Item::Words(vec![random.pick(&[0x0000, 0x95A8])]),
    }
}
