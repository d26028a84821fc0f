//! The status register, kept apart as the operations leave it: cheap to set, put together only when it is read.
//!
//! | bit | flag | kept as |
//! |---|---|---|
//! | 0 | C carry | `carry`, 0 or 1 |
//! | 1 | Z zero | `nonzero` is 0 |
//! | 2 | N negative | bit 7 of `negative` |
//! | 3 | V two's complement overflow | bit 7 of `overflow` |
//! | 4 | S sign | N xor V; not so if bit 8 of `negative` is set, which only a program that writes the register can do |
//! | 5 | H half carry | bit 4 of `half` |
//! | 6 | T copy bit | `copy` |
//! | 7 | I interrupts enabled | `interrupts` |
//!
//! No operation needs to know a flag that it leaves as it was: the parts of one can be computed while those of the last are
//! still on their way.

/// The status register in parts.
#[derive(Clone, Copy, Debug, Default)]
pub struct Status {
    carry: u8,
    nonzero: u8,
    negative: u16,
    overflow: u8,
    half: u8,
    copy: bool,
    /// The global interrupt enable.
    pub(crate) interrupts: bool,
}

/// Two are the same if the register reads the same.
impl PartialEq for Status {
    fn eq(&self, other: &Status) -> bool {
        self.bits() == other.bits()
    }
}

impl Eq for Status {}

/// In `negative`: S is not N xor V.
const ODD: u16 = 0x100;
/// Where H stands in `half`.
const HALF: u8 = 0x10;

impl Status {
    /// From the register's value.
    pub const fn from_bits(bits: u8) -> Status {
        let odd = (bits >> 4 ^ bits >> 3 ^ bits >> 2) & 1;
        Status {
            carry: bits & 1,
            nonzero: !bits >> 1 & 1,
            negative: (bits << 5 & 0x80) as u16 | (odd as u16 * ODD),
            overflow: bits << 4 & 0x80,
            half: bits >> 1 & HALF,
            copy: bits & 0x40 != 0,
            interrupts: bits & 0x80 != 0,
        }
    }

    /// The flags of a register's value, I to C, set ones in capitals: `iTHsvnZc`.
    pub fn letters(bits: u8) -> String {
        let flag = |bit: u8| {
            let letter = char::from(b"cznvshti"[usize::from(bit)]);
            match bits >> bit & 1 {
                0 => letter,
                _ => letter.to_ascii_uppercase(),
            }
        };
        (0..8).rev().map(flag).collect()
    }

    /// The register's value.
    pub const fn bits(self) -> u8 {
        let mut bits = 0;
        let mut bit = 0;
        while bit < 8 {
            bits |= (self.bit(bit) as u8) << bit;
            bit += 1;
        }
        bits
    }

    #[inline(always)]
    pub(crate) const fn carry(self) -> bool {
        self.carry != 0
    }

    #[inline(always)]
    pub(crate) const fn zero(self) -> bool {
        self.nonzero == 0
    }

    #[inline(always)]
    pub(crate) const fn copy(self) -> bool {
        self.copy
    }

    #[inline(always)]
    pub(crate) const fn set_copy(&mut self, copy: bool) {
        self.copy = copy;
    }

    /// Flag number `bit`.
    #[inline(always)]
    pub(crate) const fn bit(self, bit: u8) -> bool {
        match bit {
            0 => self.carry(),
            1 => self.zero(),
            2 => self.negative & 0x80 != 0,
            3 => self.overflow & 0x80 != 0,
            4 => (self.negative ^ self.overflow as u16 ^ self.negative >> 1) & 0x80 != 0,
            5 => self.half & HALF != 0,
            6 => self.copy,
            _ => self.interrupts,
        }
    }

    #[inline(always)]
    fn result(&mut self, result: u8, overflow: u8) {
        self.negative = u16::from(result);
        self.overflow = overflow;
    }

    /// Before the lowest byte of a sum or difference that takes in the carry of the byte below.
    #[inline(always)]
    pub(crate) const fn begin(&mut self) {
        self.carry = 0;
        self.nonzero = 0;
    }

    /// a + b + carry.
    #[inline(always)]
    pub(crate) fn add(&mut self, a: u8, b: u8, carry: u8) -> u8 {
        let wide = u32::from(a) + u32::from(b) + u32::from(carry);
        let result = wide as u8;
        self.carry = (wide >> 8) as u8;
        self.half = a ^ b ^ result;
        self.result(result, (a ^ result) & (b ^ result));
        self.nonzero = result;
        result
    }

    /// a + b + C.
    #[inline(always)]
    pub(crate) fn add_on(&mut self, a: u8, b: u8) -> u8 {
        self.add(a, b, self.carry)
    }

    #[inline(always)]
    fn difference(&mut self, a: u8, b: u8, borrow: u8) -> u8 {
        let wide = i32::from(a) - i32::from(b) - i32::from(borrow);
        let result = wide as u8;
        self.carry = u8::from(wide < 0);
        self.half = a ^ b ^ result;
        self.result(result, (a ^ b) & (a ^ result));
        result
    }

    /// a - b.
    #[inline(always)]
    pub(crate) fn subtract(&mut self, a: u8, b: u8) -> u8 {
        let result = self.difference(a, b, 0);
        self.nonzero = result;
        result
    }

    /// a - b - C; zero only if it was zero before too.
    #[inline(always)]
    pub(crate) fn subtract_on(&mut self, a: u8, b: u8) -> u8 {
        let result = self.difference(a, b, self.carry);
        self.nonzero |= result;
        result
    }

    /// The flags of a bitwise operation.
    #[inline(always)]
    pub(crate) fn logic(&mut self, result: u8) -> u8 {
        self.nonzero = result;
        self.result(result, 0);
        result
    }

    #[inline(always)]
    pub(crate) fn complement(&mut self, a: u8) -> u8 {
        self.carry = 1;
        self.logic(!a)
    }

    #[inline(always)]
    pub(crate) fn increment(&mut self, a: u8) -> u8 {
        self.count(a.wrapping_add(1), 0x80)
    }

    #[inline(always)]
    pub(crate) fn decrement(&mut self, a: u8) -> u8 {
        self.count(a.wrapping_sub(1), 0x7F)
    }

    #[inline(always)]
    fn count(&mut self, result: u8, overflows_to: u8) -> u8 {
        self.nonzero = result;
        self.result(result, u8::from(result == overflows_to) << 7);
        result
    }

    /// The flags of a shift to the right that pushed out the lowest bit of `a`.
    #[inline(always)]
    pub(crate) fn shifted(&mut self, a: u8, result: u8) -> u8 {
        self.carry = a & 1;
        self.nonzero = result;
        self.result(result, result ^ a << 7);
        result
    }

    /// C as the highest bit of a byte.
    #[inline(always)]
    pub(crate) fn carry_on_top(self) -> u8 {
        self.carry << 7
    }

    /// The flags of a word operation: C and V change places between addition and subtraction.
    #[inline(always)]
    pub(crate) fn word(&mut self, before: u16, result: u16, adding: bool) {
        let (before_high, high) = ((before >> 8) as u8, (result >> 8) as u8);
        let (up, down) = (!before_high & high, before_high & !high);
        let (overflow, carry) = if adding { (up, down) } else { (down, up) };
        self.carry = carry >> 7;
        self.nonzero = high | result as u8;
        self.result(high, overflow);
    }

    /// The flags of a multiplication with this product, `shifted` by one for the fractional ones: C and Z.
    #[inline(always)]
    pub(crate) fn product(&mut self, product: u16, fractional: bool) -> u16 {
        let result = if fractional { product << 1 } else { product };
        self.carry = (product >> 15) as u8;
        self.nonzero = (result >> 8) as u8 | result as u8;
        result
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_value_of_the_register_comes_back() {
        for bits in 0..=255 {
            let status = Status::from_bits(bits);
            assert_eq!(status.bits(), bits);
            for bit in 0..8 {
                assert_eq!(status.bit(bit), bits >> bit & 1 != 0);
            }
        }
    }

    /// Flags as the manual's Boolean formulas give them, bit by bit.
    fn manual_add(a: u8, b: u8, r: u8) -> [bool; 3] {
        let bit = |value: u8, n: u8| value >> n & 1 != 0;
        let carry =
            |n| bit(a, n) && bit(b, n) || bit(b, n) && !bit(r, n) || !bit(r, n) && bit(a, n);
        let overflow =
            bit(a, 7) && bit(b, 7) && !bit(r, 7) || !bit(a, 7) && !bit(b, 7) && bit(r, 7);
        [carry(7), carry(3), overflow]
    }

    fn manual_subtract(a: u8, b: u8, r: u8) -> [bool; 3] {
        let bit = |value: u8, n: u8| value >> n & 1 != 0;
        let borrow =
            |n| !bit(a, n) && bit(b, n) || bit(b, n) && bit(r, n) || bit(r, n) && !bit(a, n);
        let overflow =
            bit(a, 7) && !bit(b, 7) && !bit(r, 7) || !bit(a, 7) && bit(b, 7) && bit(r, 7);
        [borrow(7), borrow(3), overflow]
    }

    #[test]
    fn sums_and_differences_have_the_flags_of_the_manual_for_all_operands() {
        for (a, b) in (0..=255u8).flat_map(|a| (0..=255u8).map(move |b| (a, b))) {
            for carry in [false, true] {
                let start = Status::from_bits(u8::from(carry) | 2);
                let mut status = start;
                let sum = status.add(a, b, carry.into());
                assert_eq!(sum, a.wrapping_add(b).wrapping_add(carry.into()));
                let found = [status.bit(0), status.bit(5), status.bit(3)];
                assert_eq!(found, manual_add(a, b, sum), "{a} + {b} + {carry}");
                let mut status = start;
                let difference = status.subtract_on(a, b);
                let found = [status.bit(0), status.bit(5), status.bit(3)];
                assert_eq!(
                    found,
                    manual_subtract(a, b, difference),
                    "{a} - {b} - {carry}"
                );
                assert_eq!(status.bit(1), difference == 0);
                assert_eq!(status.bit(4), status.bit(2) != status.bit(3));
            }
        }
    }

    #[test]
    fn a_chain_of_subtractions_is_zero_only_if_every_link_is() {
        let mut status = Status::default();
        status.subtract(5, 4);
        status.subtract_on(0, 0);
        assert!(!status.bit(1));
        status.subtract(5, 5);
        status.subtract_on(0, 0);
        assert!(status.bit(1));
    }
}
