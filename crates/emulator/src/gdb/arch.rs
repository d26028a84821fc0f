//! The AVR as GDB's remote protocol knows it: registers and their order (`avr_register_type` in GDB's avr-tdep.c).

use gdbstub::arch::{Arch, RegId, Registers};
use std::num::NonZeroUsize;

/// r0 to r31, SREG, two bytes of SP, four of the program counter.
const PACKET_BYTES: usize = 39;

/// An AVR; the debugger learns the width of its program counter from the target description.
#[derive(Debug)]
pub enum Avr {}

impl Arch for Avr {
    type Usize = u32;
    type Registers = AvrRegisters;
    type BreakpointKind = usize;
    type RegId = AvrRegister;
}

/// All registers, as the `g` packet carries them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct AvrRegisters {
    /// r0 to r31.
    pub general: [u8; 32],
    /// The status register.
    pub status: u8,
    /// The stack pointer.
    pub stack_pointer: u16,
    /// The program counter [bytes].
    pub program_counter: u32,
}

impl Registers for AvrRegisters {
    type ProgramCounter = u32;

    fn pc(&self) -> u32 {
        self.program_counter
    }

    fn gdb_serialize(&self, mut write_byte: impl FnMut(Option<u8>)) {
        let general = self.general.iter().copied().chain([self.status]);
        let pointers = self.stack_pointer.to_le_bytes().into_iter();
        let counter = self.program_counter.to_le_bytes();
        for byte in general.chain(pointers).chain(counter) {
            write_byte(Some(byte));
        }
    }

    fn gdb_deserialize(&mut self, bytes: &[u8]) -> Result<(), ()> {
        let bytes: &[u8; PACKET_BYTES] = bytes.try_into().map_err(|_| ())?;
        self.general.copy_from_slice(&bytes[..32]);
        self.status = bytes[32];
        self.stack_pointer = u16::from_le_bytes([bytes[33], bytes[34]]);
        self.program_counter = u32::from_le_bytes([bytes[35], bytes[36], bytes[37], bytes[38]]);
        Ok(())
    }
}

/// One register.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AvrRegister {
    /// r0 to r31.
    General(u8),
    /// The status register.
    Status,
    /// The stack pointer.
    StackPointer,
    /// The program counter [bytes].
    ProgramCounter,
}

impl RegId for AvrRegister {
    fn from_raw_id(id: usize) -> Option<(Self, Option<NonZeroUsize>)> {
        let (register, bytes) = match id {
            0..32 => (AvrRegister::General(id as u8), 1),
            32 => (AvrRegister::Status, 1),
            33 => (AvrRegister::StackPointer, 2),
            34 => (AvrRegister::ProgramCounter, 4),
            _ => return None,
        };
        Some((register, NonZeroUsize::new(bytes)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_packet_of_registers_goes_there_and_back() {
        let registers = AvrRegisters {
            general: std::array::from_fn(|index| index as u8),
            status: 0x82,
            stack_pointer: 0x21F0,
            program_counter: 0x0_1234,
        };
        let mut bytes = Vec::new();
        registers.gdb_serialize(|byte| bytes.extend(byte));
        assert_eq!(bytes.len(), PACKET_BYTES);
        assert_eq!(bytes[31..], [31, 0x82, 0xF0, 0x21, 0x34, 0x12, 0, 0]);
        let mut again = AvrRegisters::default();
        assert_eq!(again.gdb_deserialize(&bytes), Ok(()));
        assert_eq!(again, registers);
        assert_eq!(again.gdb_deserialize(&bytes[1..]), Err(()));
    }
}
