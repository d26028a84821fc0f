//! The text of an instruction, in the assembler's language.

use crate::decode::{Code, FLASH_WORDS, Op};

/// What the operation at word address `program_counter` reads in a listing; addresses of code are in bytes, as there.
pub fn text(program_counter: u32, op: Op) -> String {
    let name = op.code.mnemonic();
    let (a, b) = (op.a, op.b);
    match op.code {
        Code::Nop
        | Code::Ijmp
        | Code::Eijmp
        | Code::Icall
        | Code::Eicall
        | Code::Ret
        | Code::Reti
        | Code::Spm
        | Code::Sleep
        | Code::Break
        | Code::Wdr
        | Code::Erased
        | Code::Breakpoint => name.to_owned(),
        Code::Illegal => format!(".word 0x{b:04x}"),
        Code::Cpi | Code::Sbci | Code::Subi | Code::Ori | Code::Andi | Code::Ldi => {
            format!("{name} r{a}, 0x{b:02X}")
        }
        Code::Com
        | Code::Neg
        | Code::Swap
        | Code::Inc
        | Code::Asr
        | Code::Lsr
        | Code::Ror
        | Code::Dec
        | Code::Pop
        | Code::Push => format!("{name} r{a}"),
        Code::LddY | Code::LddZ => {
            let pointer = if op.code == Code::LddY { 'Y' } else { 'Z' };
            if b == 0 {
                format!("ld r{a}, {pointer}")
            } else {
                format!("ldd r{a}, {pointer}+{b}")
            }
        }
        Code::StdY | Code::StdZ => {
            let pointer = if op.code == Code::StdY { 'Y' } else { 'Z' };
            if b == 0 {
                format!("st {pointer}, r{a}")
            } else {
                format!("std {pointer}+{b}, r{a}")
            }
        }
        Code::Lds => format!("lds r{a}, 0x{b:04X}"),
        Code::Sts => format!("sts 0x{b:04X}, r{a}"),
        Code::Lpm | Code::Elpm => format!("{name} r{a}, Z"),
        Code::In => format!("in r{a}, 0x{b:02x}"),
        Code::Out => format!("out 0x{b:02x}, r{a}"),
        Code::Adiw | Code::Sbiw => format!("{name} r{a}, 0x{b:02x}"),
        Code::Cbi | Code::Sbi | Code::Sbic | Code::Sbis => {
            format!("{name} 0x{a:02x}, {}", bit(b))
        }
        Code::Sbrc | Code::Sbrs | Code::Bld | Code::Bst => format!("{name} r{a}, {}", bit(b)),
        Code::Bset => format!("se{}", flag(a)),
        Code::Bclr => format!("cl{}", flag(a)),
        Code::Rjmp | Code::Rcall | Code::Jmp | Code::Call => {
            format!("{name} 0x{:x}", 2 * op.address())
        }
        Code::Breq | Code::Brne | Code::Brcs | Code::Brcc => {
            format!("{name} 0x{:x}", 2 * op.address())
        }
        Code::Brbs | Code::Brbc => {
            let distance = b.cast_signed() as i32 as u32;
            let target = program_counter.wrapping_add(distance) % FLASH_WORDS as u32;
            format!("{} 0x{:x}", branch(op.code == Code::Brbs, a), 2 * target)
        }
        // The name distinguishes the rest: either it contains a pointer, or the operation has two registers.
        _ => match name.split_once(' ') {
            Some((load @ ("ld" | "lpm" | "elpm"), pointer)) => format!("{load} r{a}, {pointer}"),
            Some((store, pointer)) => format!("{store} {pointer}, r{a}"),
            None => format!("{name} r{a}, r{}", b & 31),
        },
    }
}

fn bit(mask: u16) -> u32 {
    (mask & 0xFF).trailing_zeros()
}

fn flag(bit: u8) -> char {
    char::from(b"cznvshti"[usize::from(bit & 7)])
}

/// The names of the branches on flags; equal, and carry, are operations of their own.
const fn branch(set: bool, bit: u8) -> &'static str {
    match (bit & 7, set) {
        (0, true) => "brcs",
        (0, false) => "brcc",
        (1, true) => "breq",
        (1, false) => "brne",
        (2, true) => "brmi",
        (2, false) => "brpl",
        (3, true) => "brvs",
        (3, false) => "brvc",
        (4, true) => "brlt",
        (4, false) => "brge",
        (5, true) => "brhs",
        (5, false) => "brhc",
        (6, true) => "brts",
        (6, false) => "brtc",
        (_, true) => "brie",
        (_, false) => "brid",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::decode::decode;

    #[test]
    fn instructions_read_as_in_a_listing() {
        for (word, next, expected) in [
            (0x0000, 0, "nop"),
            (0x01FE, 0, "movw r30, r28"),
            (0x0F00, 0, "add r16, r16"),
            (0xE0F2, 0, "ldi r31, 0x02"),
            (0x9631, 0, "adiw r30, 0x01"),
            (0xBFCD, 0, "out 0x3d, r28"),
            (0xB6CE, 0, "in r12, 0x3e"),
            (0x9A2D, 0, "sbi 0x05, 5"),
            (0x8189, 0, "ldd r24, Y+1"),
            (0x8188, 0, "ld r24, Y"),
            (0x900D, 0, "ld r0, X+"),
            (0x921E, 0, "st -X, r1"),
            (0x9180, 0x0217, "lds r24, 0x0217"),
            (0x9380, 0x0217, "sts 0x0217, r24"),
            (0x95C8, 0, "lpm r0, Z"),
            (0x9007, 0, "elpm r0, Z+"),
            (0x94F8, 0, "cli"),
            (0x9478, 0, "sei"),
            (0x940E, 0x1234, "call 0x2468"),
            (0xF7F1, 0, "brne 0x1fe"),
            (0xF40C, 0, "brge 0x204"),
            (0xFD07, 0, "sbrc r16, 7"),
            (0x9DF0, 0, "mul r31, r0"),
            (0x0001, 0, ".word 0x0001"),
        ] {
            assert_eq!(text(0x100, decode(0x100, word, next)), expected);
        }
    }
}
