//! Location lists (`.debug_loc`): where variables are.
//!
//! LLVM describes a variable in several registers by pieces of two registers, of which GDB 13 reads one; here each
//! register has a separate piece, as in avr-gcc's output. And a variable of a frame is one byte above LLVM's offset:
//! Y points below the frame, as the stack pointer does. Delete this when LLVM is fixed.

use std::collections::{HashMap, HashSet};
use std::error::Error;

use gimli::write::{EndianVec, Result as Written, Writer};
use gimli::{
    AttributeValue, Dwarf, Encoding, Expression, Format, LittleEndian, Operation, Reader, Register,
    constants,
};

/// The frame pointer Y.
pub(super) const Y: Register = Register(28);
/// Expressions as they are read here.
const ENCODING: Encoding = Encoding {
    address_size: 4,
    format: Format::Dwarf32,
    version: 4,
};

/// Addresses of the functions with Y as their frame pointer; in others Y is a register like any.
pub(super) fn frames<R: Reader<Offset = usize>>(dwarf: &Dwarf<R>) -> gimli::Result<HashSet<u64>> {
    let mut frames = HashSet::new();
    let mut units = dwarf.units();
    while let Some(header) = units.next()? {
        let unit = dwarf.unit(header)?;
        let mut entries = unit.entries();
        while let Some((_, entry)) = entries.next_dfs()? {
            let base = entry.attr_value(constants::DW_AT_frame_base)?;
            let base = base.and_then(|base| base.exprloc_value());
            let first = base
                .map(|base| base.operations(ENCODING).next())
                .transpose()?;
            if let Some(Some(Operation::Register { register: Y })) = first
                && let Some(AttributeValue::Addr(begin)) =
                    entry.attr_value(constants::DW_AT_low_pc)?
            {
                frames.insert(begin);
            }
        }
    }
    Ok(frames)
}

/// Location lists.
pub(super) struct Lists {
    pub(super) bytes: Vec<u8>,
    /// Offset of each: before, and now.
    pub(super) moved: HashMap<usize, usize>,
}

/// Rewrites the lists, with addresses of 32 bits.
pub(super) fn rewrite<R: Reader<Offset = usize>>(
    section: &R,
    frames: &HashSet<u64>,
) -> Result<Lists, Box<dyn Error>> {
    let mut lists = EndianVec::new(LittleEndian);
    let mut moved = HashMap::new();
    let mut rest = section.clone();
    let mut is_new = true;
    // Each list begins with its function's address.
    let mut function = 0;
    while !rest.is_empty() {
        if is_new {
            moved.insert(rest.offset_from(section), lists.len());
            function = 0;
        }
        let [begin, end] = [rest.read_address(4)?, rest.read_address(4)?];
        lists.write_udata(begin, 4)?;
        lists.write_udata(end, 4)?;
        is_new = (begin, end) == (0, 0);
        if begin == u64::from(u32::MAX) {
            function = end;
        }
        if is_new || begin == u64::from(u32::MAX) {
            continue;
        }
        let length = usize::from(rest.read_u16()?);
        let place = expression(Expression(rest.split(length)?), frames.contains(&function))?;
        lists.write_u16(place.len() as u16)?;
        lists.write(&place)?;
    }
    Ok(Lists {
        bytes: lists.into_vec(),
        moved,
    })
}

/// The expression as avr-gcc would write it.
fn expression<R: Reader<Offset = usize>>(
    old: Expression<R>,
    has_frame: bool,
) -> Result<Vec<u8>, Box<dyn Error>> {
    let mut new = EndianVec::new(LittleEndian);
    let mut register = None;
    let mut operations = old.clone().operations(ENCODING);
    let mut from = 0;
    while let Some(operation) = operations.next()? {
        let to = operations.offset_from(&old);
        match (register.take(), operation) {
            (_, Operation::Register { register: first }) => register = Some(first),
            (Some(Register(first)), Operation::Piece { size_in_bits, .. }) => {
                for index in 0..size_in_bits / 8 {
                    write_register(&mut new, u64::from(first) + index)?;
                    new.write_u8(constants::DW_OP_piece.0)?;
                    new.write_uleb128(1)?;
                }
            }
            (
                _,
                Operation::RegisterOffset {
                    register: Y,
                    offset,
                    ..
                },
            ) if has_frame => {
                new.write_u8(constants::DW_OP_breg28.0)?;
                new.write_sleb128(offset + 1)?;
            }
            (_, Operation::Address { address }) => {
                new.write_u8(constants::DW_OP_addr.0)?;
                new.write_udata(address, 4)?;
            }
            _ => {
                let mut bytes = old.0.clone();
                bytes.skip(from)?;
                bytes.truncate(to - from)?;
                new.write(&bytes.to_slice()?)?;
            }
        }
        from = to;
    }
    // A register that is all of it.
    if let Some(Register(whole)) = register {
        write_register(&mut new, whole.into())?;
    }
    Ok(new.into_vec())
}

fn write_register(to: &mut impl Writer, register: u64) -> Written<()> {
    to.write_u8(constants::DW_OP_regx.0)?;
    to.write_uleb128(register)
}
