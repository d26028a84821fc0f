//! Just enough of an assembler to write test programs: a word for each instruction.

/// rd, rr both 0..=31.
pub(crate) fn two(base: u16, d: u8, r: u8) -> u16 {
    let (d, r) = (u16::from(d), u16::from(r));
    base | (r & 0x10) << 5 | d << 4 | r & 0xF
}

/// rd 16..=31 and a constant.
pub(crate) fn immediate(base: u16, d: u8, k: u8) -> u16 {
    let (d, k) = (u16::from(d), u16::from(k));
    base | (k & 0xF0) << 4 | (d & 0xF) << 4 | k & 0xF
}

pub(crate) fn ldi(d: u8, k: u8) -> u16 {
    immediate(0xE000, d, k)
}

pub(crate) fn mov(d: u8, r: u8) -> u16 {
    two(0x2C00, d, r)
}

/// One register: base has the code in its low bits.
pub(crate) fn one(base: u16, d: u8) -> u16 {
    base | u16::from(d) << 4
}

pub(crate) fn input(d: u8, address: u8) -> u16 {
    let a = u16::from(address);
    0xB000 | (a & 0x30) << 5 | u16::from(d) << 4 | a & 0xF
}

pub(crate) fn output(address: u8, r: u8) -> u16 {
    input(r, address) | 0x800
}

pub(crate) fn lds(d: u8, address: u16) -> [u16; 2] {
    [one(0x9000, d), address]
}

pub(crate) fn sts(address: u16, r: u8) -> [u16; 2] {
    [one(0x9200, r), address]
}

/// SBI, CBI, SBIC, SBIS.
pub(crate) fn bit_of_io(base: u16, address: u8, bit: u8) -> u16 {
    base | u16::from(address) << 3 | u16::from(bit)
}

pub(crate) fn jump(base: u16, target: u32) -> [u16; 2] {
    [base | (target >> 17) as u16 & 1, target as u16]
}

pub(crate) const CALL: u16 = 0x940E;
pub(crate) const RET: u16 = 0x9508;

/// Relative jumps and calls, by words from the next instruction.
pub(crate) fn relative(base: u16, words: i16) -> u16 {
    base | words.cast_unsigned() & 0xFFF
}

/// BRBS (base 0xF000) and BRBC (0xF400).
pub(crate) fn branch(base: u16, flag: u8, words: i16) -> u16 {
    base | (words.cast_unsigned() & 0x7F) << 3 | u16::from(flag)
}
