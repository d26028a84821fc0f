//! Instruction words to predecoded operations: what can be known before the program runs is worked out once.
//!
//! Source: AVR Instruction Set Manual (DS40002198), opcodes of the AVRe+ core with a 22-bit program counter ("avr6").

/// Words of flash: 256 KB.
pub const FLASH_WORDS: usize = 0x2_0000;

/// Instructions of a run at most: as many as the high bits of [`Op::a`] can count.
pub const LONGEST_RUN: u32 = 8;

/// Declares the operations once: the enumeration and what the assembler calls them.
macro_rules! operations {
    ($( $code:ident = $name:literal, )+) => {
        /// What an operation does.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[repr(u8)]
        pub enum Code { $( #[doc = concat!("`", $name, "`")] $code, )+ }

        impl Code {
            /// The assembler's name.
            pub const fn mnemonic(self) -> &'static str {
                match self { $( Code::$code => $name, )+ }
            }
        }
    };
}

operations! {
    Nop = "nop", Movw = "movw", Muls = "muls", Mulsu = "mulsu", Fmul = "fmul", Fmuls = "fmuls", Fmulsu = "fmulsu",
    Cpc = "cpc", Sbc = "sbc", Add = "add", Cpse = "cpse", Cp = "cp", Sub = "sub", Adc = "adc",
    And = "and", Eor = "eor", Or = "or", Mov = "mov",
    Cpi = "cpi", Sbci = "sbci", Subi = "subi", Ori = "ori", Andi = "andi", Ldi = "ldi",
    LddY = "ldd Y+", LddZ = "ldd Z+", StdY = "std Y+", StdZ = "std Z+",
    LdX = "ld X", LdXInc = "ld X+", LdXDec = "ld -X", LdYInc = "ld Y+", LdYDec = "ld -Y", LdZInc = "ld Z+", LdZDec = "ld -Z",
    StX = "st X", StXInc = "st X+", StXDec = "st -X", StYInc = "st Y+", StYDec = "st -Y", StZInc = "st Z+", StZDec = "st -Z",
    Lds = "lds", Sts = "sts", Lpm = "lpm", LpmInc = "lpm Z+", Elpm = "elpm", ElpmInc = "elpm Z+", Spm = "spm",
    Pop = "pop", Push = "push",
    Com = "com", Neg = "neg", Swap = "swap", Inc = "inc", Asr = "asr", Lsr = "lsr", Ror = "ror", Dec = "dec",
    Bset = "bset", Bclr = "bclr", Bld = "bld", Bst = "bst",
    Adiw = "adiw", Sbiw = "sbiw", Mul = "mul",
    In = "in", Out = "out", Cbi = "cbi", Sbi = "sbi", Sbic = "sbic", Sbis = "sbis", Sbrc = "sbrc", Sbrs = "sbrs",
    Rjmp = "rjmp", Rcall = "rcall", Jmp = "jmp", Call = "call", Ijmp = "ijmp", Eijmp = "eijmp", Icall = "icall", Eicall = "eicall",
    Ret = "ret", Reti = "reti", Brbs = "brbs", Brbc = "brbc", Breq = "breq", Brne = "brne", Brcs = "brcs", Brcc = "brcc",
    Sleep = "sleep", Break = "break", Wdr = "wdr",
    Erased = "erased flash", Illegal = "illegal", Breakpoint = "breakpoint",
    // A loop that waits begins here.
    Waits = "wait",
    // The first of several of its kind ([`Op::before`]).
    Pushes = "push", Pops = "pop", Ldses = "lds", Stses = "sts",
    LddsY = "ldd Y+", LddsZ = "ldd Z+", StdsY = "std Y+", StdsZ = "std Z+",
    Ldis = "ldi", Movs = "mov", Movws = "movw",
    Adds = "add", Adcs = "adc", Subs = "sub", Sbcs = "sbc", Subis = "subi", Sbcis = "sbci",
    Cps = "cp", Cpcs = "cpc", Cpis = "cpi",
}

/// An operation with its operands, ready to run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Op {
    /// What it does.
    pub code: Code,
    /// Destination register, bit number, I/O address, or the high bits of a target.
    pub a: u8,
    /// Source register, constant, mask, data address, or the low bits of a target. Of an operation that may skip:
    /// the high byte is 1 more than the words it skips.
    pub b: u16,
}

impl Op {
    const fn new(code: Code, a: u8, b: u16) -> Op {
        Op { code, a, b }
    }

    const fn target(code: Code, target: u32) -> Op {
        let target = target % FLASH_WORDS as u32;
        Op {
            code,
            a: (target >> 16) as u8,
            b: target as u16,
        }
    }

    /// The words of its instruction.
    pub const fn words(self) -> u32 {
        match self.code {
            Code::Lds | Code::Sts | Code::Jmp | Code::Call => 2,
            _ => 1,
        }
    }

    /// As the first of a run with what follows: instructions of one kind that need no look at the next event in
    /// between. The high bits of `a` are how many follow in the run.
    pub const fn before(self, next: Op) -> Op {
        use Code::*;
        let code = match (self.code, next.code) {
            (Push, Push | Pushes) => Pushes,
            (Pop, Pop | Pops) => Pops,
            (Lds, Lds | Ldses) => Ldses,
            (Sts, Sts | Stses) => Stses,
            (LddY, LddY | LddsY) => LddsY,
            (LddZ, LddZ | LddsZ) => LddsZ,
            (StdY, StdY | StdsY) => StdsY,
            (StdZ, StdZ | StdsZ) => StdsZ,
            (Ldi, Ldi | Ldis | Mov | Movs | Movw | Movws) => Ldis,
            (Mov, Ldi | Ldis | Mov | Movs | Movw | Movws) => Movs,
            (Movw, Ldi | Ldis | Mov | Movs | Movw | Movws) => Movws,
            (Add, Adc | Adcs) => Adds,
            (Adc, Adc | Adcs) => Adcs,
            (Sub, Sbc | Sbcs) => Subs,
            (Sbc, Sbc | Sbcs) => Sbcs,
            (Subi, Sbci | Sbcis) => Subis,
            (Sbci, Sbci | Sbcis) => Sbcis,
            (Cp, Cpc | Cpcs) => Cps,
            (Cpc, Cpc | Cpcs) => Cpcs,
            (Cpi, Cpc | Cpcs) => Cpis,
            _ => return self,
        };
        let follow = next.follow() + 1;
        let follow = if follow > LONGEST_RUN - 1 {
            LONGEST_RUN - 1
        } else {
            follow
        };
        Op {
            code,
            a: self.a | (follow as u8) << 5,
            b: self.b,
        }
    }

    /// The same without those that follow.
    pub const fn alone(self) -> Op {
        use Code::*;
        let code = match self.code {
            Pushes => Push,
            Pops => Pop,
            Ldses => Lds,
            Stses => Sts,
            LddsY => LddY,
            LddsZ => LddZ,
            StdsY => StdY,
            StdsZ => StdZ,
            Ldis => Ldi,
            Movs => Mov,
            Movws => Movw,
            Adds => Add,
            Adcs => Adc,
            Subs => Sub,
            Sbcs => Sbc,
            Subis => Subi,
            Sbcis => Sbci,
            Cps => Cp,
            Cpcs => Cpc,
            Cpis => Cpi,
            _ => return self,
        };
        Op {
            code,
            a: self.a & 31,
            b: self.b,
        }
    }

    /// How many follow in its run.
    #[inline(always)]
    pub const fn follow(self) -> u32 {
        self.a as u32 >> 5
    }

    /// Where a jump or a call leads [words].
    #[inline(always)]
    pub const fn address(self) -> u32 {
        (self.a as u32) << 16 | self.b as u32
    }
}

/// An instruction of this word takes two.
pub const fn is_long(word: u16) -> bool {
    // LDS and STS; JMP and CALL.
    word & 0xFC0F == 0x9000 || word & 0xFE0C == 0x940C
}

/// The operation at word address `pc`, whose word is `word` and which is followed by `next`.
pub fn decode(pc: u32, word: u16, next: u16) -> Op {
    match word >> 12 {
        0x0..=0x2 => two_registers(word, next),
        0x3 => immediate(Code::Cpi, word),
        0x4 => immediate(Code::Sbci, word),
        0x5 => immediate(Code::Subi, word),
        0x6 => immediate(Code::Ori, word),
        0x7 => immediate(Code::Andi, word),
        0x8 | 0xA => displaced(word),
        0x9 => nine(word, next),
        0xB => {
            let address = (word >> 5 & 0x30 | word & 0xF) as u8;
            let code = if word & 0x800 == 0 {
                Code::In
            } else {
                Code::Out
            };
            Op::new(code, destination(word), u16::from(address))
        }
        0xC => Op::target(Code::Rjmp, relative(pc, word, 12)),
        0xD => Op::target(Code::Rcall, relative(pc, word, 12)),
        0xE => immediate(Code::Ldi, word),
        _ => fifteen(pc, word, next),
    }
}

const fn destination(word: u16) -> u8 {
    (word >> 4 & 0x1F) as u8
}

const fn source(word: u16) -> u16 {
    word >> 5 & 0x10 | word & 0xF
}

/// The address `bits` wide and signed, relative to the next instruction.
const fn relative(pc: u32, word: u16, bits: u32) -> u32 {
    let offset = ((word << (16 - bits)) as i16) >> (16 - bits);
    pc.wrapping_add(1).wrapping_add(offset as i32 as u32)
}

/// High byte of a skipping operation's `b`: 1 more than the words that it skips.
const fn skipped(next: u16) -> u16 {
    if is_long(next) { 0x300 } else { 0x200 }
}

fn two_registers(word: u16, next: u16) -> Op {
    let (d, r) = (destination(word), source(word));
    let upper = |code| Op::new(code, 16 + (d & 0xF), 16 + (word & 0xF));
    let middle = |code| Op::new(code, 16 + (d & 7), 16 + (word & 7));
    match word >> 10 {
        0 => match word >> 8 & 3 {
            0 if word == 0 => Op::new(Code::Nop, 0, 0),
            0 => Op::new(Code::Illegal, 0, word),
            1 => Op::new(Code::Movw, (d & 0xF) * 2, (word & 0xF) * 2),
            2 => upper(Code::Muls),
            _ => match (word & 0x80 != 0, word & 0x08 != 0) {
                (false, false) => middle(Code::Mulsu),
                (false, true) => middle(Code::Fmul),
                (true, false) => middle(Code::Fmuls),
                (true, true) => middle(Code::Fmulsu),
            },
        },
        1 => Op::new(Code::Cpc, d, r),
        2 => Op::new(Code::Sbc, d, r),
        3 => Op::new(Code::Add, d, r),
        4 => Op::new(Code::Cpse, d, r | skipped(next)),
        5 => Op::new(Code::Cp, d, r),
        6 => Op::new(Code::Sub, d, r),
        7 => Op::new(Code::Adc, d, r),
        8 => Op::new(Code::And, d, r),
        9 => Op::new(Code::Eor, d, r),
        10 => Op::new(Code::Or, d, r),
        _ => Op::new(Code::Mov, d, r),
    }
}

fn immediate(code: Code, word: u16) -> Op {
    Op::new(
        code,
        16 + (word >> 4 & 0xF) as u8,
        word >> 4 & 0xF0 | word & 0xF,
    )
}

fn displaced(word: u16) -> Op {
    let q = word >> 8 & 0x20 | word >> 7 & 0x18 | word & 7;
    let code = match (word & 0x200 != 0, word & 8 != 0) {
        (false, false) => Code::LddZ,
        (false, true) => Code::LddY,
        (true, false) => Code::StdZ,
        (true, true) => Code::StdY,
    };
    Op::new(code, destination(word), q)
}

/// 1001 ....
fn nine(word: u16, next: u16) -> Op {
    let d = destination(word);
    match word >> 8 & 0xF {
        0x0 | 0x1 => {
            let code = match word & 0xF {
                0x0 => return Op::new(Code::Lds, d, next),
                0x1 => Code::LdZInc,
                0x2 => Code::LdZDec,
                0x4 => Code::Lpm,
                0x5 => Code::LpmInc,
                0x6 => Code::Elpm,
                0x7 => Code::ElpmInc,
                0x9 => Code::LdYInc,
                0xA => Code::LdYDec,
                0xC => Code::LdX,
                0xD => Code::LdXInc,
                0xE => Code::LdXDec,
                0xF => Code::Pop,
                _ => return Op::new(Code::Illegal, 0, word),
            };
            Op::new(code, d, 0)
        }
        0x2 | 0x3 => {
            let code = match word & 0xF {
                0x0 => return Op::new(Code::Sts, d, next),
                0x1 => Code::StZInc,
                0x2 => Code::StZDec,
                0x9 => Code::StYInc,
                0xA => Code::StYDec,
                0xC => Code::StX,
                0xD => Code::StXInc,
                0xE => Code::StXDec,
                0xF => Code::Push,
                _ => return Op::new(Code::Illegal, 0, word),
            };
            Op::new(code, d, 0)
        }
        0x4 | 0x5 => one_register(word, next),
        0x6 | 0x7 => {
            let code = if word & 0x100 == 0 {
                Code::Adiw
            } else {
                Code::Sbiw
            };
            let register = 24 + (word >> 3 & 6) as u8;
            Op::new(code, register, word >> 2 & 0x30 | word & 0xF)
        }
        0x8..=0xB => {
            let (address, mask) = ((word >> 3 & 0x1F) as u8, 1 << (word & 7));
            match word >> 8 & 3 {
                0 => Op::new(Code::Cbi, address, mask),
                1 => Op::new(Code::Sbic, address, mask | skipped(next)),
                2 => Op::new(Code::Sbi, address, mask),
                _ => Op::new(Code::Sbis, address, mask | skipped(next)),
            }
        }
        _ => Op::new(Code::Mul, d, source(word)),
    }
}

/// 1001 010. ....
fn one_register(word: u16, next: u16) -> Op {
    let d = destination(word);
    let code = match word & 0xF {
        0x0 => Code::Com,
        0x1 => Code::Neg,
        0x2 => Code::Swap,
        0x3 => Code::Inc,
        0x5 => Code::Asr,
        0x6 => Code::Lsr,
        0x7 => Code::Ror,
        0xA => Code::Dec,
        0xC..=0xF => {
            let high = u32::from(word >> 3 & 0x3E | word & 1);
            let code = if word & 2 == 0 { Code::Jmp } else { Code::Call };
            return Op::target(code, high << 16 | u32::from(next));
        }
        _ => return alone(word),
    };
    Op::new(code, d, 0)
}

/// The instructions without operands, and those on a bit of the status register.
fn alone(word: u16) -> Op {
    let code = match word {
        0x9409 => Code::Ijmp,
        0x9419 => Code::Eijmp,
        0x9509 => Code::Icall,
        0x9519 => Code::Eicall,
        0x9508 => Code::Ret,
        0x9518 => Code::Reti,
        0x9588 => Code::Sleep,
        0x9598 => Code::Break,
        0x95A8 => Code::Wdr,
        0x95C8 => Code::Lpm,
        0x95D8 => Code::Elpm,
        0x95E8 => Code::Spm,
        _ if word & 0xFF8F == 0x9408 => {
            return Op::new(Code::Bset, (word >> 4 & 7) as u8, 0);
        }
        _ if word & 0xFF8F == 0x9488 => {
            return Op::new(Code::Bclr, (word >> 4 & 7) as u8, 0);
        }
        _ => return Op::new(Code::Illegal, 0, word),
    };
    Op::new(code, 0, 0)
}

/// 1111 ....
fn fifteen(pc: u32, word: u16, next: u16) -> Op {
    let bit = (word & 7) as u8;
    if word & 0x800 == 0 {
        let set = word & 0x400 == 0;
        let target = relative(pc, word >> 3, 7);
        return match (bit, set) {
            (1, true) => Op::target(Code::Breq, target),
            (1, false) => Op::target(Code::Brne, target),
            (0, true) => Op::target(Code::Brcs, target),
            (0, false) => Op::target(Code::Brcc, target),
            // The target is near: its distance fits beside the bit.
            (_, set) => Op::new(
                if set { Code::Brbs } else { Code::Brbc },
                bit,
                (target.wrapping_sub(pc) & 0xFFFF) as u16,
            ),
        };
    }
    if word & 8 != 0 {
        let code = if word == 0xFFFF {
            Code::Erased
        } else {
            Code::Illegal
        };
        return Op::new(code, 0, word);
    }
    let (d, mask) = (destination(word), 1 << bit);
    match word >> 9 & 3 {
        0 => Op::new(Code::Bld, d, mask),
        1 => Op::new(Code::Bst, d, mask),
        2 => Op::new(Code::Sbrc, d, mask | skipped(next)),
        _ => Op::new(Code::Sbrs, d, mask | skipped(next)),
    }
}

#[cfg(test)]
mod tests;
