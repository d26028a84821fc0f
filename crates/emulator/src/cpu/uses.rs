//! What an instruction does with registers and flags, apart from the data space ([`super::touch`]).

use crate::decode::{Code, Op};

pub(super) const C: u8 = 0x01;
pub(super) const Z: u8 = 0x02;
pub(super) const N: u8 = 0x04;
pub(super) const V: u8 = 0x08;
pub(super) const S: u8 = 0x10;
pub(super) const H: u8 = 0x20;
pub(super) const T: u8 = 0x40;
pub(super) const I: u8 = 0x80;
/// Z, N, V, S of a bitwise operation; C besides of shifts and words; H too of sums and differences.
const LOGIC: u8 = Z | N | V | S;
const SHIFT: u8 = C | LOGIC;
const SUM: u8 = H | SHIFT;

/// Registers by their numbers as bits, flags as in SREG.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Uses {
    pub(super) reads: u32,
    pub(super) writes: u32,
    pub(super) tests: u8,
    pub(super) sets: u8,
}

impl Uses {
    const fn of(reads: u32, writes: u32, tests: u8, sets: u8) -> Uses {
        Uses {
            reads,
            writes,
            tests,
            sets,
        }
    }
}

/// What an operation, alone, reads and writes. SREG as an address of the data space is not among it.
pub(super) const fn uses(op: Op) -> Uses {
    const X_PAIR: u32 = 3 << 26;
    const Y_PAIR: u32 = 3 << 28;
    const Z_PAIR: u32 = 3 << 30;
    let a = 1 << (op.a & 31);
    let b = 1 << (op.b & 31);
    let (pair, source) = (3 << (op.a & 30), 3 << (op.b & 30));
    match op.code {
        Code::Movw => Uses::of(source, pair, 0, 0),
        Code::Muls | Code::Mulsu | Code::Mul | Code::Fmul | Code::Fmuls | Code::Fmulsu => {
            Uses::of(a | b, 3, 0, C | Z)
        }
        Code::Add | Code::Sub => Uses::of(a | b, a, 0, SUM),
        Code::Adc => Uses::of(a | b, a, C, SUM),
        Code::Sbc => Uses::of(a | b, a, C | Z, SUM),
        Code::Cp => Uses::of(a | b, 0, 0, SUM),
        Code::Cpc => Uses::of(a | b, 0, C | Z, SUM),
        Code::Cpse => Uses::of(a | b, 0, 0, 0),
        Code::And | Code::Or | Code::Eor => Uses::of(a | b, a, 0, LOGIC),
        Code::Mov => Uses::of(b, a, 0, 0),
        Code::Cpi => Uses::of(a, 0, 0, SUM),
        Code::Subi | Code::Neg => Uses::of(a, a, 0, SUM),
        Code::Sbci => Uses::of(a, a, C | Z, SUM),
        Code::Ori | Code::Andi | Code::Inc | Code::Dec => Uses::of(a, a, 0, LOGIC),
        Code::Ldi | Code::Lds | Code::Pop | Code::In => Uses::of(0, a, 0, 0),
        Code::Sts | Code::Push | Code::Out | Code::Sbrc | Code::Sbrs => Uses::of(a, 0, 0, 0),
        Code::LdX => Uses::of(X_PAIR, a, 0, 0),
        Code::LddY => Uses::of(Y_PAIR, a, 0, 0),
        Code::LddZ | Code::Lpm | Code::Elpm => Uses::of(Z_PAIR, a, 0, 0),
        Code::LdXInc | Code::LdXDec => Uses::of(X_PAIR, a | X_PAIR, 0, 0),
        Code::LdYInc | Code::LdYDec => Uses::of(Y_PAIR, a | Y_PAIR, 0, 0),
        Code::LdZInc | Code::LdZDec | Code::LpmInc | Code::ElpmInc => {
            Uses::of(Z_PAIR, a | Z_PAIR, 0, 0)
        }
        Code::StX => Uses::of(X_PAIR | a, 0, 0, 0),
        Code::StdY => Uses::of(Y_PAIR | a, 0, 0, 0),
        Code::StdZ => Uses::of(Z_PAIR | a, 0, 0, 0),
        Code::StXInc | Code::StXDec => Uses::of(X_PAIR | a, X_PAIR, 0, 0),
        Code::StYInc | Code::StYDec => Uses::of(Y_PAIR | a, Y_PAIR, 0, 0),
        Code::StZInc | Code::StZDec => Uses::of(Z_PAIR | a, Z_PAIR, 0, 0),
        Code::Com | Code::Asr | Code::Lsr => Uses::of(a, a, 0, SHIFT),
        Code::Ror => Uses::of(a, a, C, SHIFT),
        Code::Swap => Uses::of(a, a, 0, 0),
        Code::Bset | Code::Bclr => Uses::of(0, 0, 0, 1 << (op.a & 7)),
        Code::Bld => Uses::of(a, a, T, 0),
        Code::Bst => Uses::of(a, 0, 0, T),
        Code::Adiw | Code::Sbiw => Uses::of(pair, pair, 0, SHIFT),
        Code::Ijmp | Code::Eijmp | Code::Icall | Code::Eicall => Uses::of(Z_PAIR, 0, 0, 0),
        Code::Reti => Uses::of(0, 0, 0, I),
        Code::Brbs | Code::Brbc => Uses::of(0, 0, 1 << (op.a & 7), 0),
        Code::Breq | Code::Brne => Uses::of(0, 0, Z, 0),
        Code::Brcs | Code::Brcc => Uses::of(0, 0, C, 0),
        _ => Uses::of(0, 0, 0, 0),
    }
}
