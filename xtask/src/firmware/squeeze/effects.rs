//! What an instruction reads and writes.
//!
//! Registers, and of the flags those that any instruction asks for: half carry is none of them.

use std::ops::{BitAnd, BitOr, BitOrAssign, Not};

use super::assembly::{Flow, Instruction};
use super::stack_arguments::FARTHEST;

/// Registers and flags.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Set(u64);

impl Set {
    pub(super) const NONE: Self = Self(0);
    pub(super) const CARRY: Self = Self(1 << 32);
    pub(super) const ZERO: Self = Self(1 << 33);
    /// Sign and overflow: signed comparisons ask for both.
    pub(super) const SIGN: Self = Self(1 << 34);
    pub(super) const BIT: Self = Self(1 << 35);
    /// What arithmetic sets.
    pub(super) const ARITHMETIC: Self = Self(0b111 << 32);
    pub(super) const FLAGS: Self = Self(0b1111 << 32);
    pub(super) const ALL: Self = Self((1 << 36) - 1);
    /// What a function may change without giving it back, by the convention of avr-gcc and LLVM; r1 is always zero.
    pub(super) const FREE: Self = Self(0b1100_1111_1111_1100_0000_0000_0000_0001 | Self::FLAGS.0);
    /// What may hold arguments.
    pub(super) const ARGUMENTS: Self = Self(0x03FF_FF00);
    /// What may hold results.
    pub(super) const RESULTS: Self = Self(0x03FC_0000);
    /// What a function gives back as it was.
    pub(super) const KEPT: Self = Self(0x3003_FFFC);

    /// A register.
    pub(super) fn register(number: u8) -> Self {
        Self(1 << number)
    }

    /// Registers from one to another.
    pub(super) fn registers(from: u8, to: u8) -> Self {
        (from..=to).fold(Self::NONE, |set, number| set | Self::register(number))
    }

    pub(super) fn has(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    pub(super) fn meets(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }

    pub(super) fn is_empty(self) -> bool {
        self.0 == 0
    }

    pub(super) fn without(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }
}

impl BitOr for Set {
    type Output = Self;
    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl BitOrAssign for Set {
    fn bitor_assign(&mut self, other: Self) {
        self.0 |= other.0;
    }
}

impl BitAnd for Set {
    type Output = Self;
    fn bitand(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
}

impl Not for Set {
    type Output = Self;
    fn not(self) -> Self {
        Self(!self.0 & Self::ALL.0)
    }
}

/// What an instruction does with memory or the hardware.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Memory {
    /// Nothing.
    #[default]
    None,
    /// Reads.
    Load,
    /// Writes.
    Store,
    /// Hardware, the stack, interrupts, or what it is is not known: it stays, and in its place.
    Fixed,
}

/// What an instruction does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Effect {
    pub(super) reads: Set,
    pub(super) writes: Set,
    pub(super) memory: Memory,
}

/// The number of a register.
pub(super) fn register(operand: &str) -> Option<u8> {
    operand
        .strip_prefix('r')?
        .parse()
        .ok()
        .filter(|it| *it < 32)
}

/// The lower register of the pointer that an operand goes by, and how far beyond it reaches; `None` where the pointer moves.
pub(super) fn pointer(operand: &str) -> Option<(u8, i32)> {
    let base = match operand.get(..1)? {
        "X" => 26,
        "Y" => 28,
        "Z" => 30,
        _ => return None,
    };
    match operand.get(1..)? {
        "" => Some((base, 0)),
        rest => Some((base, rest.strip_prefix('+')?.parse().ok()?)),
    }
}

/// Flags that are lost where the pointer must move for an access ([`super::shifts`]).
fn far(operand: &str) -> Set {
    match pointer(operand) {
        Some((_, distance)) if distance > FARTHEST => Set::ARITHMETIC,
        _ => Set::NONE,
    }
}

/// The lower register of a pointer, and whether it moves.
pub(super) fn any_pointer(operand: &str) -> Option<(u8, bool)> {
    let still = operand.trim_start_matches('-');
    let moving = still.len() != operand.len() || still.ends_with('+');
    pointer(still.trim_end_matches('+')).map(|(base, _)| (base, moving))
}

/// Two registers, the lower of which is given.
pub(super) fn pair(number: u8) -> Set {
    Set::register(number) | Set::register(number + 1)
}

impl Effect {
    /// What an instruction does by itself; calls and returns do more.
    pub(super) fn of(instruction: &Instruction) -> Result<Self, String> {
        if matches!(instruction.flow(), Flow::Call | Flow::Return | Flow::Jump) {
            return Ok(Self {
                memory: Memory::Fixed,
                ..Self::default()
            });
        }
        Self::known(instruction)
            .ok_or_else(|| format!("`{instruction}`: what it does is not known here"))
    }

    fn known(it: &Instruction) -> Option<Self> {
        use Set as S;
        let first = register(it.operand(0));
        let second = register(it.operand(1));
        let one = |number: Option<u8>| number.map(S::register);
        let two = |number: Option<u8>| number.filter(|it| it % 2 == 0).map(pair);
        let plain = |reads: S, writes: S| {
            Some(Self {
                reads,
                writes,
                memory: Memory::None,
            })
        };
        let fixed = |reads: S, writes: S| {
            Some(Self {
                reads,
                writes,
                memory: Memory::Fixed,
            })
        };
        let logic = S::ZERO | S::SIGN;
        match it.name.as_str() {
            "eor" | "sub" if first.is_some() && first == second => plain(
                S::NONE,
                one(first)?
                    | if it.name == "eor" {
                        logic
                    } else {
                        S::ARITHMETIC
                    },
            ),
            "clr" => plain(S::NONE, one(first)? | logic),
            "add" | "sub" => plain(one(first)? | one(second)?, one(first)? | S::ARITHMETIC),
            "adc" => plain(
                one(first)? | one(second)? | S::CARRY,
                one(first)? | S::ARITHMETIC,
            ),
            "sbc" => plain(
                one(first)? | one(second)? | S::CARRY | S::ZERO,
                one(first)? | S::ARITHMETIC,
            ),
            "and" | "or" | "eor" => plain(one(first)? | one(second)?, one(first)? | logic),
            "adiw" | "sbiw" => plain(two(first)?, two(first)? | S::ARITHMETIC),
            "andi" | "ori" | "inc" | "dec" => plain(one(first)?, one(first)? | logic),
            "tst" => plain(one(first)?, logic),
            "asr" | "lsl" | "lsr" | "com" | "neg" | "subi" => {
                plain(one(first)?, one(first)? | S::ARITHMETIC)
            }
            "rol" | "ror" => plain(one(first)? | S::CARRY, one(first)? | S::ARITHMETIC),
            "sbci" => plain(
                one(first)? | S::CARRY | S::ZERO,
                one(first)? | S::ARITHMETIC,
            ),
            "swap" => plain(one(first)?, one(first)?),
            "bld" => plain(one(first)? | S::BIT, one(first)?),
            "bst" => plain(one(first)?, S::BIT),
            "cp" => plain(one(first)? | one(second)?, S::ARITHMETIC),
            "cpc" => plain(
                one(first)? | one(second)? | S::CARRY | S::ZERO,
                S::ARITHMETIC,
            ),
            "cpi" => plain(one(first)?, S::ARITHMETIC),
            "ldi" => plain(S::NONE, one(first)?),
            "mov" => plain(one(second)?, one(first)?),
            "movw" => plain(two(second)?, two(first)?),
            "mul" | "muls" | "mulsu" => {
                plain(one(first)? | one(second)?, pair(0) | S::CARRY | S::ZERO)
            }
            "sec" | "clc" => plain(S::NONE, S::CARRY),
            "set" | "clt" => plain(S::NONE, S::BIT),
            "nop" => fixed(S::NONE, S::NONE),
            "in" if it.operand(1) == "63" => fixed(S::FLAGS, one(first)?),
            "in" | "lds" | "pop" => fixed(S::NONE, one(first)?),
            "out" if it.operand(0) == "63" => fixed(one(second)?, S::FLAGS),
            "out" | "sts" => fixed(one(second)?, S::NONE),
            "push" => fixed(one(first)?, S::NONE),
            "sbi" | "cbi" | "cli" | "sei" | "sleep" | "wdr" => fixed(S::NONE, S::NONE),
            "ld" | "ldd" | "lpm" => {
                let (base, moves) = any_pointer(it.operand(1))?;
                Some(Self {
                    reads: pair(base),
                    writes: one(first)?
                        | if moves {
                            pair(base)
                        } else {
                            far(it.operand(1))
                        },
                    memory: if it.name == "lpm" {
                        Memory::None
                    } else {
                        Memory::Load
                    },
                })
            }
            "st" | "std" => {
                let (base, moves) = any_pointer(it.operand(0))?;
                Some(Self {
                    reads: pair(base) | one(second)?,
                    writes: if moves {
                        pair(base)
                    } else {
                        far(it.operand(0))
                    },
                    memory: Memory::Store,
                })
            }
            "breq" | "brne" => plain(S::ZERO, S::NONE),
            "brlo" | "brsh" | "brcs" | "brcc" => plain(S::CARRY, S::NONE),
            "brlt" | "brge" | "brmi" | "brpl" | "brvs" | "brvc" => plain(S::SIGN, S::NONE),
            "brts" | "brtc" => plain(S::BIT, S::NONE),
            _ => None,
        }
    }
}
