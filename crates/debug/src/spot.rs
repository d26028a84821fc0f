//! Where a value is: in memory, or byte for byte in registers.

use rumbo_emulator::chip::Chip;

/// A byte of a value that is in pieces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Piece {
    Memory(u32),
    Register(u8),
    Known(u8),
    Unknown,
}

/// Where a value is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Spot {
    /// From this address on.
    Memory(u32),
    /// Byte for byte.
    Pieces(Vec<Piece>),
}

impl Spot {
    /// That of a number.
    pub(crate) fn known(bytes: &[u8]) -> Spot {
        Spot::Pieces(bytes.iter().map(|byte| Piece::Known(*byte)).collect())
    }

    /// That of a part of it.
    pub(crate) fn part(&self, offset: usize, bytes: usize) -> Spot {
        match self {
            Spot::Memory(address) => Spot::Memory(address.wrapping_add(offset as u32)),
            Spot::Pieces(pieces) => {
                let piece = |at: usize| pieces.get(at).copied().unwrap_or(Piece::Unknown);
                Spot::Pieces((offset..offset + bytes).map(piece).collect())
            }
        }
    }

    fn piece(&self, at: usize) -> Piece {
        match self {
            Spot::Memory(address) => Piece::Memory(address.wrapping_add(at as u32)),
            Spot::Pieces(pieces) => pieces.get(at).copied().unwrap_or(Piece::Unknown),
        }
    }

    /// The bytes there; `None` if one is not known.
    pub(crate) fn read(&self, chip: &Chip, bytes: usize) -> Option<Vec<u8>> {
        (0..bytes).map(|at| self.piece(at).read(chip)).collect()
    }

    /// Writes there. False: a byte of it is nowhere.
    pub(crate) fn write(&self, chip: &mut Chip, bytes: &[u8]) -> bool {
        let pieces: Vec<Piece> = (0..bytes.len()).map(|at| self.piece(at)).collect();
        let is_somewhere = |piece: &Piece| matches!(piece, Piece::Memory(_) | Piece::Register(_));
        pieces.iter().all(is_somewhere)
            && pieces.iter().zip(bytes).all(|(piece, byte)| match piece {
                Piece::Memory(address) => chip.write_space(*address, *byte),
                Piece::Register(register) => {
                    chip.cpu_mut().registers_mut()[usize::from(register & 31)] = *byte;
                    true
                }
                Piece::Known(_) | Piece::Unknown => false,
            })
    }
}

impl Piece {
    pub(crate) fn read(self, chip: &Chip) -> Option<u8> {
        match self {
            Piece::Memory(address) => chip.read_space(address),
            Piece::Register(register) => Some(chip.cpu().registers()[usize::from(register & 31)]),
            Piece::Known(byte) => Some(byte),
            Piece::Unknown => None,
        }
    }
}
