//! What an instruction is about to touch in the data space.

use super::Cpu;
use crate::decode::{Code, Op};
use crate::model::Model;

const X: usize = 26;
const Y: usize = 28;
const Z: usize = 30;
/// Where IN, OUT and the instructions on bits count from.
const IO_START: u16 = 0x20;

/// An access to the data space by an instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Touch {
    /// Its lowest address.
    pub address: u16,
    /// How many bytes from there on.
    pub bytes: u16,
    /// They are read.
    pub reads: bool,
    /// They are written.
    pub writes: bool,
    /// It pushes.
    pub stack: bool,
}

impl Touch {
    const fn read(address: u16) -> Touch {
        Touch {
            address,
            bytes: 1,
            reads: true,
            writes: false,
            stack: false,
        }
    }

    const fn written(address: u16) -> Touch {
        Touch {
            address,
            bytes: 1,
            reads: false,
            writes: true,
            stack: false,
        }
    }

    const fn pushed(stack_pointer: u16, bytes: u16) -> Touch {
        Touch {
            address: stack_pointer.wrapping_sub(bytes - 1),
            bytes,
            reads: false,
            writes: true,
            stack: true,
        }
    }

    /// A call or an interrupt, with the stack pointer before it.
    pub(crate) const fn pushed_address(model: &Model, stack_pointer: u16) -> Touch {
        Touch::pushed(stack_pointer, model.address_bytes())
    }
}

/// What the operation, about to run, will touch; `None` if nothing but registers as operands.
pub fn touch(cpu: &Cpu, op: Op) -> Option<Touch> {
    let pair = |low: usize| u16::from_le_bytes([cpu.registers()[low], cpu.registers()[low + 1]]);
    let io = |address: u16| IO_START + (address & 0x3F);
    let stack_pointer = cpu.stack_pointer();
    Some(match op.code {
        Code::LddY => Touch::read(pair(Y).wrapping_add(op.b)),
        Code::LddZ => Touch::read(pair(Z).wrapping_add(op.b)),
        Code::StdY => Touch::written(pair(Y).wrapping_add(op.b)),
        Code::StdZ => Touch::written(pair(Z).wrapping_add(op.b)),
        Code::LdX | Code::LdXInc => Touch::read(pair(X)),
        Code::LdYInc => Touch::read(pair(Y)),
        Code::LdZInc => Touch::read(pair(Z)),
        Code::LdXDec => Touch::read(pair(X).wrapping_sub(1)),
        Code::LdYDec => Touch::read(pair(Y).wrapping_sub(1)),
        Code::LdZDec => Touch::read(pair(Z).wrapping_sub(1)),
        Code::StX | Code::StXInc => Touch::written(pair(X)),
        Code::StYInc => Touch::written(pair(Y)),
        Code::StZInc => Touch::written(pair(Z)),
        Code::StXDec => Touch::written(pair(X).wrapping_sub(1)),
        Code::StYDec => Touch::written(pair(Y).wrapping_sub(1)),
        Code::StZDec => Touch::written(pair(Z).wrapping_sub(1)),
        Code::Lds => Touch::read(op.b),
        Code::Sts => Touch::written(op.b),
        Code::Push => Touch::pushed(stack_pointer, 1),
        Code::Pop => Touch::read(stack_pointer.wrapping_add(1)),
        Code::Call | Code::Rcall | Code::Icall | Code::Eicall => {
            Touch::pushed_address(cpu.model(), stack_pointer)
        }
        Code::Ret | Code::Reti => Touch {
            bytes: cpu.model().address_bytes(),
            ..Touch::read(stack_pointer.wrapping_add(1))
        },
        Code::In => Touch::read(io(op.b)),
        Code::Out => Touch::written(io(op.b)),
        Code::Sbic | Code::Sbis => Touch::read(io(op.a.into())),
        Code::Sbi | Code::Cbi => Touch {
            reads: true,
            ..Touch::written(io(op.a.into()))
        },
        _ => return None,
    })
}
