//! Which operands of an instruction may name other registers, and which.

use super::assembly::Instruction;
use super::effects::{Effect, Set, pair, register};

/// An operand that names a register.
#[derive(Clone, Copy, Debug)]
pub(super) struct Operand {
    pub(super) place: usize,
    pub(super) reads: bool,
    pub(super) writes: bool,
    /// Whether it is the lower of two.
    is_pair: bool,
    /// Registers that it may name.
    pub(super) may: Set,
}

impl Operand {
    fn new(place: usize, reads: bool, writes: bool) -> Self {
        Self {
            place,
            reads,
            writes,
            is_pair: false,
            may: Set::registers(0, 31),
        }
    }

    fn read(place: usize) -> Self {
        Self::new(place, true, false)
    }

    fn written(place: usize) -> Self {
        Self::new(place, false, true)
    }

    fn changed(place: usize) -> Self {
        Self::new(place, true, true)
    }

    /// Of instructions that have four bits for a register.
    fn high(self) -> Self {
        self.among(Set::registers(16, 31))
    }

    fn among(self, may: Set) -> Self {
        Self { may, ..self }
    }

    fn pair(self) -> Self {
        Self {
            is_pair: true,
            ..self
        }
    }

    /// The registers that it names.
    pub(super) fn names(&self, it: &Instruction) -> Set {
        match register(it.operand(self.place)) {
            Some(number) if self.is_pair => pair(number),
            Some(number) => Set::register(number),
            None => Set::NONE,
        }
    }
}

/// Those of an instruction that does this; none where what they would do is something else.
pub(super) fn of(it: &Instruction, effect: &Effect) -> Vec<Operand> {
    use Operand as O;
    let pointers = [24, 26, 30].map(Set::register);
    let pointers = pointers.into_iter().fold(Set::NONE, |all, it| all | it);
    let operands = match it.name.as_str() {
        // What is cleared by itself reads nothing.
        "eor" | "sub" if it.operand(0) == it.operand(1) => vec![O::written(0), O::written(1)],
        "add" | "adc" | "sub" | "sbc" | "and" | "or" | "eor" => vec![O::changed(0), O::read(1)],
        "mov" => vec![O::written(0), O::read(1)],
        "movw" => vec![O::written(0).pair(), O::read(1).pair()],
        "adiw" | "sbiw" => vec![O::changed(0).pair().among(pointers)],
        "cp" | "cpc" | "mul" => vec![O::read(0), O::read(1)],
        "muls" => vec![O::read(0).high(), O::read(1).high()],
        "tst" | "bst" => vec![O::read(0)],
        "cpi" => vec![O::read(0).high()],
        "ldi" => vec![O::written(0).high()],
        "andi" | "ori" | "subi" | "sbci" => vec![O::changed(0).high()],
        "inc" | "dec" | "com" | "neg" | "asr" | "lsl" | "lsr" | "rol" | "ror" | "swap" | "bld" => {
            vec![O::changed(0)]
        }
        "clr" | "in" | "lds" | "ld" | "ldd" | "lpm" => vec![O::written(0)],
        "out" | "sts" | "st" | "std" => vec![O::read(1)],
        _ => Vec::new(),
    };
    let agrees = |operand: &Operand| {
        let named = operand.names(it);
        !named.is_empty()
            && (!operand.reads || effect.reads.has(named))
            && (!operand.writes || effect.writes.has(named))
    };
    if operands.iter().all(agrees) {
        operands
    } else {
        Vec::new()
    }
}
