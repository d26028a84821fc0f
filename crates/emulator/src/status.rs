//! The status register, kept apart as the operations leave it: cheap to set, put together only when it is read.
//!
//! | bit | flag | kept as |
//! |---|---|---|
//! | 0 | C carry | bit 7 of `carries` |
//! | 1 | Z zero | `nonzero` is 0 |
//! | 2 | N negative | bit 7 of `negative` |
//! | 3 | V two's complement overflow | bit 7 of `overflow` |
//! | 4 | S sign, N xor V | bit 7 of `sign` |
//! | 5 | H half carry | bit 3 of `carries` |
//! | 6 | T copy bit | `copy` |
//! | 7 | I interrupts enabled | `interrupts` |

/// The status register in parts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Status {
    carries: u8,
    nonzero: u8,
    negative: u8,
    overflow: u8,
    sign: u8,
    copy: bool,
    /// The global interrupt enable.
    pub(crate) interrupts: bool,
}

impl Status {
    /// From the register's value.
    pub const fn from_bits(bits: u8) -> Status {
        Status {
            carries: (bits & 1) << 7 | (bits >> 5 & 1) << 3,
            nonzero: !bits >> 1 & 1,
            negative: bits << 5 & 0x80,
            overflow: bits << 4 & 0x80,
            sign: bits << 3 & 0x80,
            copy: bits & 0x40 != 0,
            interrupts: bits & 0x80 != 0,
        }
    }

    /// The register's value.
    pub const fn bits(self) -> u8 {
        self.carries >> 7
            | ((self.nonzero == 0) as u8) << 1
            | self.negative >> 5 & 4
            | self.overflow >> 4 & 8
            | self.sign >> 3 & 0x10
            | self.carries << 2 & 0x20
            | (self.copy as u8) << 6
            | (self.interrupts as u8) << 7
    }

    #[inline(always)]
    pub(crate) const fn carry(self) -> bool {
        self.carries & 0x80 != 0
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
            4 => self.sign & 0x80 != 0,
            5 => self.carries & 8 != 0,
            6 => self.copy,
            _ => self.interrupts,
        }
    }

    #[inline(always)]
    fn arithmetic(&mut self, result: u8, carries: u8, overflow: u8) {
        self.carries = carries;
        self.negative = result;
        self.overflow = overflow;
        self.sign = result ^ overflow;
    }

    /// a + b + carry.
    #[inline(always)]
    pub(crate) fn add(&mut self, a: u8, b: u8, carry: bool) -> u8 {
        let result = a.wrapping_add(b).wrapping_add(u8::from(carry));
        let carries = a & b | (a | b) & !result;
        self.arithmetic(result, carries, (a ^ result) & (b ^ result));
        self.nonzero = result;
        result
    }

    /// a - b.
    #[inline(always)]
    pub(crate) fn subtract(&mut self, a: u8, b: u8) -> u8 {
        let result = a.wrapping_sub(b);
        let borrows = !a & b | (!a | b) & result;
        self.arithmetic(result, borrows, (a ^ b) & (a ^ result));
        self.nonzero = result;
        result
    }

    /// a - b - carry; zero only if it was zero before too.
    #[inline(always)]
    pub(crate) fn subtract_on(&mut self, a: u8, b: u8) -> u8 {
        let result = a.wrapping_sub(b).wrapping_sub(u8::from(self.carry()));
        let borrows = !a & b | (!a | b) & result;
        self.arithmetic(result, borrows, (a ^ b) & (a ^ result));
        self.nonzero |= result;
        result
    }

    /// The flags of a bitwise operation.
    #[inline(always)]
    pub(crate) fn logic(&mut self, result: u8) -> u8 {
        self.nonzero = result;
        self.negative = result;
        self.overflow = 0;
        self.sign = result;
        result
    }

    #[inline(always)]
    pub(crate) fn complement(&mut self, a: u8) -> u8 {
        self.carries |= 0x80;
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
        self.negative = result;
        self.overflow = u8::from(result == overflows_to) << 7;
        self.sign = result ^ self.overflow;
        result
    }

    /// The flags of a shift to the right that pushed out the lowest bit of `a`.
    #[inline(always)]
    pub(crate) fn shifted(&mut self, a: u8, result: u8) -> u8 {
        let out = a << 7;
        self.carries = self.carries & 0x7F | out;
        self.nonzero = result;
        self.negative = result;
        self.overflow = result ^ out;
        self.sign = out;
        result
    }

    /// The flags of a word operation: C and V change places between addition and subtraction.
    #[inline(always)]
    pub(crate) fn word(&mut self, before: u16, result: u16, adding: bool) {
        let (before_high, high) = ((before >> 8) as u8, (result >> 8) as u8);
        let (up, down) = (!before_high & high, before_high & !high);
        let (overflow, carry) = if adding { (up, down) } else { (down, up) };
        self.carries = self.carries & 0x7F | carry & 0x80;
        self.nonzero = u8::from(result != 0);
        self.negative = high;
        self.overflow = overflow;
        self.sign = high ^ overflow;
    }

    /// The flags of a multiplication with this product, `shifted` by one for the fractional ones.
    #[inline(always)]
    pub(crate) fn product(&mut self, product: u16, fractional: bool) -> u16 {
        let result = if fractional { product << 1 } else { product };
        self.carries = self.carries & 0x7F | (product >> 8) as u8 & 0x80;
        self.nonzero = u8::from(result != 0);
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
                let sum = status.add(a, b, carry);
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
