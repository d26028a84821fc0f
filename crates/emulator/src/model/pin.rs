//! The pins of the ports A to L, and the registers of these.

/// How many ports there are: A to H and J to L.
pub const PORTS: usize = 11;
const LETTERS: [u8; PORTS] = *b"ABCDEFGHJKL";

/// A pin of the chip: port and bit.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Pin(u8);

impl Pin {
    /// Bit `bit` of port `letter` (`A` to `H`, `J` to `L`); `None` if the chip has no such pin.
    pub const fn new(letter: char, bit: u8) -> Option<Pin> {
        let mut port = 0;
        while port < PORTS {
            if LETTERS[port] as char == letter && bit < 8 {
                return Some(Pin(port as u8 * 8 + bit));
            }
            port += 1;
        }
        None
    }

    pub(crate) const fn at(port: usize, bit: u8) -> Pin {
        Pin(port as u8 * 8 + bit)
    }

    /// Number of its port, 0 for A.
    pub const fn port(self) -> usize {
        self.0 as usize / 8
    }

    /// Its bit in the port.
    pub const fn bit(self) -> u8 {
        self.0 % 8
    }

    /// Its number among all pins, below 88.
    pub(crate) const fn number(self) -> u8 {
        self.0
    }

    pub(crate) const fn mask(self) -> u8 {
        1 << (self.0 % 8)
    }
}

impl std::fmt::Debug for Pin {
    fn fmt(&self, out: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(out, "{}", self)
    }
}

/// As the datasheet calls it: `PB7`.
impl std::fmt::Display for Pin {
    fn fmt(&self, out: &mut std::fmt::Formatter) -> std::fmt::Result {
        let letter = char::from(LETTERS[self.port() % PORTS]);
        write!(out, "P{letter}{}", self.bit())
    }
}

/// What a register of a port is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PortRegister {
    Pin,
    Direction,
    Output,
}

/// Port and register at an address of the data space.
pub(crate) const fn register(address: u16) -> Option<(usize, PortRegister)> {
    let index = match address {
        0x20..=0x34 => address - 0x20,
        0x100..=0x10B => address - 0x100 + 21,
        _ => return None,
    };
    let register = match index % 3 {
        0 => PortRegister::Pin,
        1 => PortRegister::Direction,
        _ => PortRegister::Output,
    };
    Some(((index / 3) as usize, register))
}
