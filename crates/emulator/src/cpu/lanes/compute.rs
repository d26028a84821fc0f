//! What an instruction makes of operands that differ from round to round: the operations of [`Status`], for all lanes at once and
//! without a branch, so that the compiler makes vector instructions of them.

use super::{LANES, Lane, Lanes, REGISTERS, Step};
use crate::cpu::uses::{C, H, I, N, S, T, V, Z, uses};
use crate::decode::Code;
use crate::registers::SREG;
use crate::status::Status;

/// X, Y and Z.
const POINTERS: u32 = 0x3F << 26;

/// A result with its flags, each 0 or 1; Z follows.
#[derive(Clone, Copy)]
struct Result {
    value: u8,
    carry: u8,
    overflow: u8,
    half: u8,
}

const fn sum(a: u8, b: u8, carry: u8) -> Result {
    let value = a.wrapping_add(b).wrapping_add(carry);
    Result {
        value,
        carry: (a & b | (a | b) & !value) >> 7,
        overflow: ((a ^ value) & (b ^ value)) >> 7,
        half: (a ^ b ^ value) >> 4 & 1,
    }
}

const fn difference(a: u8, b: u8, borrow: u8) -> Result {
    let value = a.wrapping_sub(b).wrapping_sub(borrow);
    Result {
        value,
        carry: (!a & b | (!a | b) & value) >> 7,
        overflow: ((a ^ b) & (a ^ value)) >> 7,
        half: (a ^ b ^ value) >> 4 & 1,
    }
}

/// Of a bitwise operation, or one whose carry is 1; or of a count that overflows at one value.
const fn plain(value: u8, overflow: u8) -> Result {
    Result {
        value,
        carry: 1,
        overflow,
        half: 0,
    }
}

const fn shifted(a: u8, value: u8) -> Result {
    Result {
        value,
        carry: a & 1,
        overflow: value >> 7 ^ a & 1,
        half: 0,
    }
}

impl Lanes {
    pub(super) fn put(&mut self, register: usize, values: Lane) {
        match register.checked_sub(REGISTERS) {
            None => {
                self.varying |= 1 << register;
                self.values[register] = values;
            }
            Some(flag) => {
                self.flags_put |= 1 << flag;
                self.flags[flag] = values;
            }
        }
    }

    /// A register before the instruction.
    fn value(&self, step: &Step, register: usize) -> Lane {
        match self.varying >> register & 1 {
            0 => [step.registers[register]; LANES],
            _ => self.values[register],
        }
    }

    /// The flags that differ from round to round.
    pub(super) const fn varying_flags(&self) -> u8 {
        match self.flags_put & (N | V) {
            0 => self.flags_put,
            _ => self.flags_put | S,
        }
    }

    /// A flag, where the round that ran had this status.
    pub(super) fn flag(&self, status: Status, bit: u8) -> Lane {
        let own = |bit: u8| match self.flags_put >> bit & 1 {
            0 => [status.bit(bit).into(); LANES],
            _ => self.flags[usize::from(bit)],
        };
        if bit != 4 || self.flags_put & (N | V) == 0 {
            return own(bit);
        }
        let (negative, overflow) = (own(2), own(3));
        std::array::from_fn(|lane| negative[lane] ^ overflow[lane])
    }

    /// Whether the lanes that count are all this.
    pub(super) fn all(&self, values: &Lane, same: u8) -> bool {
        let differing = values[..self.alike].iter();
        differing.fold(0, |all, value| all | value ^ same) == 0
    }

    /// Rounds for which this does not hold go another way.
    pub(super) fn keep(&mut self, holds: impl Fn(&Lanes, usize) -> bool) {
        let other = (0..self.alike).find(|lane| !holds(self, *lane));
        self.alike = other.unwrap_or(self.alike);
    }

    /// An instruction with operands that differ; `after` is what the round that ran left.
    pub(super) fn compute(&mut self, step: &Step, after: (&[u8; 32], Status)) -> Option<()> {
        let op = step.op;
        let (a, b) = (usize::from(op.a & 31), usize::from(op.b & 31));
        match op.code {
            Code::Mov => self.copy(step, a, b),
            Code::Movw => {
                self.copy(step, a, b);
                self.copy(step, a + 1, b + 1);
            }
            Code::Add => self.two(step, after, |a, b, _| sum(a, b, 0)),
            Code::Adc => self.two(step, after, sum),
            Code::Sub | Code::Cp | Code::Subi | Code::Cpi => {
                self.two(step, after, |a, b, _| difference(a, b, 0));
            }
            Code::Sbc | Code::Cpc | Code::Sbci => self.two(step, after, difference),
            Code::And | Code::Andi => self.two(step, after, |a, b, _| plain(a & b, 0)),
            Code::Or | Code::Ori => self.two(step, after, |a, b, _| plain(a | b, 0)),
            Code::Eor => self.two(step, after, |a, b, _| plain(a ^ b, 0)),
            Code::Com => self.two(step, after, |a, _, _| plain(!a, 0)),
            Code::Neg => self.two(step, after, |a, _, _| difference(0, a, 0)),
            Code::Inc => self.two(step, after, |a, _, _| {
                plain(a.wrapping_add(1), (a == 0x7F).into())
            }),
            Code::Dec => self.two(step, after, |a, _, _| {
                plain(a.wrapping_sub(1), (a == 0x80).into())
            }),
            Code::Lsr => self.two(step, after, |a, _, _| shifted(a, a >> 1)),
            Code::Asr => self.two(step, after, |a, _, _| shifted(a, a >> 1 | a & 0x80)),
            Code::Ror => self.two(step, after, |a, _, carry| shifted(a, a >> 1 | carry << 7)),
            Code::Swap => self.values[a] = self.values[a].map(|value| value.rotate_left(4)),
            Code::Adiw | Code::Sbiw => self.word(step, after.1, a),
            Code::Cpse => {
                let (own, other) = (self.value(step, a), self.value(step, b));
                let same = step.registers[a] == step.registers[b];
                self.keep(|_, lane| (own[lane] == other[lane]) == same);
            }
            Code::Sbrc | Code::Sbrs => {
                let (own, mask) = (self.value(step, a), op.b as u8);
                let set = step.registers[a] & mask;
                self.keep(|_, lane| own[lane] & mask == set);
            }
            Code::Breq | Code::Brne => self.branch(step, 1),
            Code::Brcs | Code::Brcc => self.branch(step, 0),
            Code::Brbs | Code::Brbc => self.branch(step, op.a),
            _ => return self.transfer(step, a),
        }
        Some(())
    }

    fn branch(&mut self, step: &Step, bit: u8) {
        let (values, set) = (self.flag(step.status, bit), u8::from(step.status.bit(bit)));
        self.keep(|_, lane| values[lane] == set);
    }

    /// A load or store that has to do with values that differ, at an address that does not.
    fn transfer(&mut self, step: &Step, a: usize) -> Option<()> {
        let touch = step.touch?;
        let direct = matches!(
            step.op.code,
            Code::Lds | Code::Sts | Code::Push | Code::Pop | Code::In | Code::Out
        );
        let pointer = if direct {
            0
        } else {
            uses(step.op).reads & POINTERS
        };
        if touch.bytes > 1 || self.varying & pointer != 0 {
            return None;
        }
        match (touch.address, touch.writes) {
            (SREG, true) => self.write_status(step, a),
            (SREG, false) => {
                let mut bits = [step.status.bits() & (T | I); LANES];
                for bit in 0..6 {
                    let flag = self.flag(step.status, bit);
                    bits.iter_mut()
                        .zip(flag)
                        .for_each(|(bits, flag)| *bits |= flag << bit);
                }
                self.put(a, bits);
            }
            (_, true) => {}
            (address, false) => {
                if let Some(values) = self.cell(address) {
                    self.put(a, *values);
                }
                // A counter has been put there; its bits are not looked at in place.
                return (!matches!(step.op.code, Code::Sbic | Code::Sbis)).then_some(());
            }
        }
        Some(())
    }

    /// SREG is written: T and I as in the round that ran, and S as N and V have it.
    fn write_status(&mut self, step: &Step, a: usize) {
        let values = self.value(step, a);
        let kept = step.registers[a] & (T | I);
        self.keep(|_, lane| {
            let bits = values[lane];
            bits & (T | I) == kept && (bits >> 4 ^ bits >> 3 ^ bits >> 2) & 1 == 0
        });
        for (bit, flag) in self.flags.iter_mut().enumerate() {
            *flag = values.map(|bits| bits >> bit & 1);
        }
        self.flags_put = !(T | I | S);
    }

    fn copy(&mut self, step: &Step, to: usize, from: usize) {
        if self.varying >> from & 1 != 0 {
            self.put(to, self.value(step, from));
        } else {
            self.varying &= !(1 << to);
        }
    }

    /// Result and flags of the register `a`, and another or a constant.
    #[inline(always)]
    fn two(
        &mut self,
        step: &Step,
        (registers, status): (&[u8; 32], Status),
        operation: impl Fn(u8, u8, u8) -> Result,
    ) {
        let (op, uses) = (step.op, uses(step.op));
        let register = usize::from(op.a);
        let own = self.value(step, register);
        let other = match op.code {
            Code::Subi | Code::Sbci | Code::Cpi | Code::Andi | Code::Ori => [op.b as u8; LANES],
            _ => self.value(step, usize::from(op.b & 31)),
        };
        let carry = match uses.tests & C {
            0 => [0; LANES],
            _ => self.flag(step.status, 0),
        };
        // A difference goes on from the byte below.
        let below = match uses.tests & Z {
            0 => [1; LANES],
            _ => self.flag(step.status, 1),
        };
        let mut values = [0; LANES];
        let [mut carries, mut zeros, mut signs, mut overflows, mut halves] = [[0; LANES]; 5];
        for lane in 0..LANES {
            let result = operation(own[lane], other[lane], carry[lane]);
            values[lane] = result.value;
            carries[lane] = result.carry;
            zeros[lane] = u8::from(result.value == 0) & below[lane];
            signs[lane] = result.value >> 7;
            overflows[lane] = result.overflow;
            halves[lane] = result.half;
        }
        self.set_flags(uses.sets, [carries, zeros, signs, overflows], status);
        if uses.sets & H != 0 {
            self.set_flag(5, halves, status);
        }
        if uses.writes != 0 {
            self.put(register, values);
            // Most often the higher bytes do not differ.
            if self.all(&values, registers[register]) {
                self.varying &= !(1 << register);
            }
        }
    }

    fn word(&mut self, step: &Step, status: Status, a: usize) {
        let (low, high) = (self.value(step, a), self.value(step, a + 1));
        let adding = step.op.code == Code::Adiw;
        let by = if adding {
            step.op.b
        } else {
            step.op.b.wrapping_neg()
        };
        let [mut lows, mut highs] = [[0; LANES]; 2];
        let [mut carries, mut zeros, mut signs, mut overflows] = [[0; LANES]; 4];
        for lane in 0..LANES {
            let before = high[lane];
            let result = u16::from_le_bytes([low[lane], before]).wrapping_add(by);
            let top = (result >> 8) as u8;
            let (up, down) = ((!before & top) >> 7, (before & !top) >> 7);
            (overflows[lane], carries[lane]) = if adding { (up, down) } else { (down, up) };
            zeros[lane] = u8::from(result == 0);
            signs[lane] = top >> 7;
            [lows[lane], highs[lane]] = result.to_le_bytes();
        }
        let flags = [carries, zeros, signs, overflows];
        self.set_flags(uses(step.op).sets, flags, status);
        self.put(a, lows);
        self.put(a + 1, highs);
    }

    /// C, Z, N and V, of those that the operation sets.
    fn set_flags(&mut self, sets: u8, flags: [Lane; 4], status: Status) {
        for (bit, values) in (0..).zip(flags) {
            if sets >> bit & 1 != 0 {
                self.set_flag(bit, values, status);
            }
        }
    }

    fn set_flag(&mut self, bit: u8, values: Lane, status: Status) {
        if self.all(&values, status.bit(bit).into()) {
            self.flags_put &= !(1 << bit);
        } else {
            self.put(REGISTERS + usize::from(bit), values);
        }
    }
}
