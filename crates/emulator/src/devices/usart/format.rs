//! What a frame of a USART looks like: data bits, parity, stop bits (2549Q, section 22.4).

/// The format as UCSRB and UCSRC set it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Format {
    /// Data bits, 5 to 9.
    pub(super) data: u32,
    pub(super) parity: Option<Parity>,
    /// Stop bits sent; the receiver checks only the first.
    pub(super) stop: u32,
    pub(super) mode: Mode,
    lowest_first: bool,
}

/// How bits and clock go together, UMSEL.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mode {
    Asynchronous,
    Synchronous,
    /// Eight bits without a frame, the highest first unless UDORD is set.
    SpiMaster,
}

/// What the parity bit makes the number of ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Parity {
    Even,
    Odd,
}

impl Format {
    /// From UCSZ2 to UCSZ0, and UCSRC.
    pub(super) fn new(size: u8, control: u8) -> Format {
        if control >> 6 == 3 {
            return Format {
                data: 8,
                parity: None,
                stop: 0,
                mode: Mode::SpiMaster,
                lowest_first: control & 4 != 0,
            };
        }
        Format {
            data: match size & 7 {
                7 => 9,
                // 4 to 6 are reserved.
                size => u32::from(size & 3) + 5,
            },
            parity: match control >> 4 & 3 {
                2 => Some(Parity::Even),
                3 => Some(Parity::Odd),
                _ => None,
            },
            stop: if control & 8 != 0 { 2 } else { 1 },
            mode: match control >> 6 {
                0 => Mode::Asynchronous,
                // 2 is reserved.
                _ => Mode::Synchronous,
            },
            lowest_first: true,
        }
    }

    /// The data bits of a value.
    pub(super) fn mask(self, value: u16) -> u16 {
        value & ((1 << self.data) - 1)
    }

    /// The parity bit of `data`.
    fn parity_bit(self, data: u16) -> Option<u32> {
        let odd = data.count_ones() & 1;
        self.parity.map(|parity| match parity {
            Parity::Even => odd,
            Parity::Odd => 1 - odd,
        })
    }

    /// The levels of a whole frame, start bit first, and how many there are.
    pub(super) fn frame(self, data: u16) -> (u32, u32) {
        if self.mode == Mode::SpiMaster {
            let [byte, _] = data.to_le_bytes();
            return (u32::from(self.in_order(byte)), 8);
        }
        let mut bits = u32::from(data) << 1;
        let mut count = 1 + self.data;
        if let Some(parity) = self.parity_bit(data) {
            bits |= parity << count;
            count += 1;
        }
        for _ in 0..self.stop {
            bits |= 1 << count;
            count += 1;
        }
        (bits, count)
    }

    /// The bits of a byte without a frame in the order in which they cross the line, the first one lowest; and back.
    pub(super) fn in_order(self, byte: u8) -> u8 {
        if self.lowest_first {
            byte
        } else {
            byte.reverse_bits()
        }
    }

    /// How many bits the receiver takes after the start bit.
    pub(super) fn received(self) -> u32 {
        self.data + u32::from(self.parity.is_some()) + 1
    }

    /// Takes received bits apart: data, whether the parity is wrong, the first stop bit.
    pub(super) fn take_apart(self, bits: u32) -> (u16, bool, bool) {
        let data = self.mask(bits as u16);
        let parity_wrong = self
            .parity_bit(data)
            .is_some_and(|parity| bits >> self.data & 1 != parity);
        (data, parity_wrong, bits >> (self.received() - 1) & 1 != 0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_have_the_bits_of_the_datasheet() {
        // 8N1, 7E2, 9O1, 5N1.
        for (size, control, data, bits, count) in [
            (3, 0x06, 0x55, 0b10_1010_1010, 10),
            (2, 0x2C, 0x45, 0b111_1000_1010, 11),
            (7, 0x36, 0x101, 0b1110_0000_0010, 12),
            (0, 0x00, 0x1F, 0b111_1110, 7),
        ] {
            let format = Format::new(size, control);
            assert_eq!(format.frame(data), (bits, count), "{format:?}");
            let taken = format.take_apart(bits >> 1);
            assert_eq!(taken, (data, false, true), "{format:?}");
        }
        assert_eq!(Format::new(3, 0xC0).frame(0x35), (0xAC, 8), "SPI");
        let even = Format::new(2, 0x2C);
        assert_eq!(even.take_apart(0b1_1100_0100), (0x44, true, true));
        assert_eq!(even.take_apart(0b0_1100_0101), (0x45, false, false));
    }
}
