//! Where a variable is: DWARF's expressions, as avr-gcc makes them, evaluated in a frame.
//!
//! A value of several bytes may be in several registers, so a spot in registers is a list, a byte each. Addresses are
//! those of the toolchain, with all memories in one space (see `rumbo_emulator::space`); what an expression works out of
//! registers is an address of the data space.
//!
//! Source: DWARF 4, section 2.5; <https://gcc.gnu.org/wiki/> for DW_OP_GNU_entry_value and DW_OP_GNU_regval_type.

use crate::spot::{Piece, Spot};
use crate::unwind::{Frame, STACK_POINTER};
use gimli::{
    EndianSlice, Evaluation, EvaluationResult, Expression, LittleEndian, Location, Register, Value,
    ValueType,
};
use rumbo_emulator::chip::Chip;
use rumbo_emulator::space::DATA;
use std::ops::Range;
use std::sync::Arc;

/// A section of the file, or a part of one.
pub(crate) type Bytes<'a> = EndianSlice<'a, LittleEndian>;

/// An expression.
#[derive(Clone, Debug)]
pub(crate) struct Code {
    pub(crate) bytes: Arc<[u8]>,
    pub(crate) encoding: gimli::Encoding,
    /// The base types that it names, by their offsets.
    pub(crate) base_types: Vec<(usize, ValueType)>,
}

/// Where something is, as the compiler describes it.
#[derive(Clone, Debug, Default)]
pub(crate) enum Place {
    /// Nowhere: it was optimised out.
    #[default]
    None,
    /// The same everywhere.
    Code(Code),
    /// By the address of the program.
    List(Vec<(Range<u32>, Code)>),
    /// It has this value.
    Constant(Arc<[u8]>),
}

impl Place {
    /// It was optimised out, or left out by the linker.
    pub(crate) fn is_nowhere(&self) -> bool {
        match self {
            Place::None => true,
            // DW_OP_addr 0.
            Place::Code(code) => *code.bytes == [3, 0, 0, 0, 0],
            Place::List(_) | Place::Constant(_) => false,
        }
    }

    fn code(&self, program_counter: u32) -> Option<&Code> {
        match self {
            Place::Code(code) => Some(code),
            Place::List(list) => {
                let mut list = list.iter();
                list.find(|(range, _)| range.contains(&program_counter))
                    .map(|(_, code)| code)
            }
            Place::None | Place::Constant(_) => None,
        }
    }
}

/// What evaluation needs: the chip, a frame, and the frame's base and caller.
pub(crate) struct Context<'a> {
    pub(crate) chip: &'a Chip,
    pub(crate) frame: &'a Frame,
    pub(crate) frame_base: &'a Place,
    /// What the caller passed in a register, if its call says.
    pub(crate) passed: &'a dyn Fn(u8) -> Option<u64>,
}

impl Context<'_> {
    /// Where a variable of so many bytes is; `None` if it is nowhere.
    pub(crate) fn spot(&self, place: &Place, bytes: usize) -> Option<Spot> {
        if let Place::Constant(value) = place {
            let byte = |at: usize| value.get(at).copied().unwrap_or(0);
            return Some(Spot::known(&(0..bytes).map(byte).collect::<Vec<_>>()));
        }
        let code = place.code(self.frame.address_in_code())?;
        let (pieces, of_registers) = self.evaluate(code)?;
        if let [piece] = &pieces[..]
            && piece.size_in_bits.is_none()
        {
            return self.whole(&piece.location, bytes, of_registers);
        }
        let mut spot = Vec::new();
        for piece in &pieces {
            let size = piece.size_in_bits.unwrap_or(8).div_ceil(8) as usize;
            match self.whole(&piece.location, size, of_registers) {
                Some(Spot::Memory(address)) => {
                    spot.extend((0..size as u32).map(|at| Piece::Memory(address + at)))
                }
                Some(Spot::Pieces(pieces)) => spot.extend(pieces),
                None => spot.extend(std::iter::repeat_n(Piece::Unknown, size)),
            }
        }
        (!spot.is_empty()).then_some(Spot::Pieces(spot))
    }

    fn whole(
        &self,
        location: &Location<Bytes<'_>>,
        bytes: usize,
        of_registers: bool,
    ) -> Option<Spot> {
        match location {
            Location::Register { register } => {
                let from = usize::from(register.0);
                let numbers = from..from + bytes;
                let pieces = numbers.map(|number| self.frame.register(number));
                Some(Spot::Pieces(pieces.collect()))
            }
            Location::Address { address } => Some(Spot::Memory(match of_registers {
                true => DATA | *address as u32 & 0xFFFF,
                false => *address as u32,
            })),
            Location::Value { value } => {
                let value = raw(*value).to_le_bytes();
                Some(Spot::known(&value[..bytes.min(8)]))
            }
            Location::Bytes { value } => Some(Spot::known(value.slice())),
            Location::Empty | Location::ImplicitPointer { .. } => None,
        }
    }

    /// The value of an expression that is one, such as what a call passes.
    pub(crate) fn value(&self, code: &Code) -> Option<u64> {
        let (pieces, _) = self.evaluate(code)?;
        match pieces.first()?.location {
            Location::Register { register } => {
                let high = self.byte(Register(register.0 + 1)).unwrap_or(0);
                Some(u16::from_le_bytes([self.byte(register)?, high]).into())
            }
            Location::Address { address } => Some(address),
            Location::Value { value } => Some(raw(value)),
            _ => None,
        }
    }

    fn byte(&self, register: Register) -> Option<u8> {
        self.frame.register(usize::from(register.0)).read(self.chip)
    }

    /// The pieces, and whether registers went into them.
    fn evaluate<'c>(&self, code: &'c Code) -> Option<(Vec<gimli::Piece<Bytes<'c>>>, bool)> {
        let expression = Expression(EndianSlice::new(&code.bytes, LittleEndian));
        let mut evaluation: Evaluation<Bytes<'c>> = expression.evaluation(code.encoding);
        evaluation.set_max_iterations(1_000);
        let mut of_registers = false;
        let mut result = evaluation.evaluate().ok()?;
        loop {
            result = match result {
                EvaluationResult::Complete => return Some((evaluation.result(), of_registers)),
                EvaluationResult::RequiresRegister {
                    register,
                    base_type,
                } => {
                    of_registers = true;
                    let of = self.base_type(code, base_type.0);
                    evaluation.resume_with_register(self.register(register, of)?)
                }
                EvaluationResult::RequiresCallFrameCfa => {
                    of_registers = true;
                    evaluation.resume_with_call_frame_cfa(self.frame.cfa?.into())
                }
                EvaluationResult::RequiresFrameBase => {
                    of_registers = true;
                    evaluation.resume_with_frame_base(self.base()?)
                }
                EvaluationResult::RequiresMemory {
                    address,
                    size,
                    base_type,
                    ..
                } => {
                    let location = Location::Address { address };
                    let spot = self.whole(&location, size.into(), of_registers)?;
                    let bytes = spot.read(self.chip, size.into())?;
                    let of = self.base_type(code, base_type.0);
                    evaluation.resume_with_memory(parsed(&bytes, of)?)
                }
                EvaluationResult::RequiresEntryValue(Expression(bytes)) => {
                    let inner = Expression(bytes).operations(code.encoding).next().ok()??;
                    evaluation.resume_with_entry_value(self.at_entry(code, &inner)?)
                }
                EvaluationResult::RequiresBaseType(offset) => {
                    evaluation.resume_with_base_type(self.base_type(code, offset.0))
                }
                EvaluationResult::RequiresRelocatedAddress(address) => {
                    evaluation.resume_with_relocated_address(address)
                }
                _ => return None,
            }
            .ok()?;
        }
    }

    fn base_type(&self, code: &Code, offset: usize) -> ValueType {
        let mut known = code.base_types.iter();
        let found = known.find(|(at, _)| *at == offset);
        found.map_or(ValueType::Generic, |(_, of)| *of)
    }

    /// A register; wider than a byte with those that follow it. A base of addresses is a pair.
    fn register(&self, register: Register, of: ValueType) -> Option<Value> {
        if register.0 == STACK_POINTER {
            let pointer = self.frame.stack_pointer?;
            return Some(Value::Generic(pointer.into()));
        }
        let count = match of {
            ValueType::Generic => 2,
            _ => of.bit_size(u64::MAX).div_ceil(8) as u16,
        };
        let bytes = (0..count).map(|more| self.byte(Register(register.0 + more)));
        parsed(&bytes.collect::<Option<Vec<u8>>>()?, of)
    }

    fn base(&self) -> Option<u64> {
        let code = self.frame_base.code(self.frame.address_in_code())?;
        match *code.bytes {
            // DW_OP_call_frame_cfa, which nearly every function has.
            [0x9c] => self.frame.cfa.map(u64::from),
            // A base may not refer to itself.
            _ => Context {
                frame_base: &Place::None,
                ..*self
            }
            .value(code),
        }
    }

    /// What a register held at the function's entry.
    fn at_entry(&self, code: &Code, operation: &gimli::Operation<Bytes<'_>>) -> Option<Value> {
        let (register, of) = match operation {
            gimli::Operation::Register { register } => (*register, ValueType::Generic),
            gimli::Operation::RegisterOffset {
                register,
                base_type,
                ..
            } => (*register, self.base_type(code, base_type.0)),
            _ => return None,
        };
        let value = (self.passed)(u8::try_from(register.0).ok()?)?;
        match of {
            ValueType::Generic => Some(Value::Generic(value)),
            _ => {
                let bytes = of.bit_size(u64::MAX).div_ceil(8).min(8) as usize;
                parsed(&value.to_le_bytes()[..bytes], of)
            }
        }
    }
}

/// Little-endian bytes as a number of this type.
fn parsed(bytes: &[u8], of: ValueType) -> Option<Value> {
    if of == ValueType::Generic {
        let mut wide = [0; 8];
        wide.get_mut(..bytes.len())?.copy_from_slice(bytes);
        return Some(Value::Generic(u64::from_le_bytes(wide)));
    }
    Value::parse(of, EndianSlice::new(bytes, LittleEndian)).ok()
}

/// The bits of a number.
fn raw(value: Value) -> u64 {
    match value {
        Value::F32(value) => value.to_bits().into(),
        Value::F64(value) => value.to_bits(),
        Value::I8(value) => value as u64,
        Value::I16(value) => value as u64,
        Value::I32(value) => value as u64,
        Value::I64(value) => value as u64,
        Value::U8(value) => value.into(),
        Value::U16(value) => value.into(),
        Value::U32(value) => value.into(),
        Value::U64(value) | Value::Generic(value) => value,
    }
}
