//! The stack: from the state of the chip to the frames of the functions that run, by what the compiler says where it
//! saved registers (`.debug_frame`).
//!
//! A frame's CFA is the stack pointer before the call; the return address is below it, high byte first. Of a routine in
//! assembly nothing is known; it is believed to be called where the word on top of the stack follows a call.
//!
//! Source: DWARF 4, section 6.4; GCC's `avr.c` for the numbers of registers and where return addresses are.

use crate::spot::Piece;
use gimli::{
    BaseAddresses, CieOrFde, DebugFrame, EndianSlice, LittleEndian, Register, RegisterRule,
    UnwindContext,
};
use gimli::{CfaRule, UnwindSection};
use rumbo_emulator::chip::Chip;
use rumbo_emulator::decode::{Code, Op, decode};
use rumbo_emulator::space::DATA;
use std::ops::Range;

/// The stack pointer, as DWARF numbers it behind r31.
pub(crate) const STACK_POINTER: u16 = 32;
/// The return address, as DWARF numbers it.
const RETURN_ADDRESS: Register = Register(36);
/// Most frames of a stack: it fits into 8 KB.
const MOST: usize = 500;

/// Where the registers are at some addresses.
#[derive(Clone, Debug)]
struct Row {
    addresses: Range<u32>,
    /// The register that the CFA is counted from: the stack pointer, or Y.
    base: u16,
    offset: i64,
    /// Registers saved, and where from the CFA.
    saved: Vec<(u8, i64)>,
    /// Where the return address begins, from the CFA.
    return_at: i64,
}

/// The table of `.debug_frame`, by address.
#[derive(Clone, Debug, Default)]
pub(crate) struct Unwinder {
    rows: Vec<Row>,
}

/// A function that runs.
#[derive(Clone, Debug)]
pub(crate) struct Frame {
    /// Address of its next instruction [bytes].
    pub(crate) program_counter: u32,
    /// It called the one above; else it was interrupted, or is the innermost.
    pub(crate) has_called: bool,
    /// The stack pointer before it was called.
    pub(crate) cfa: Option<u16>,
    pub(crate) stack_pointer: Option<u16>,
    registers: [Piece; 32],
}

impl Frame {
    /// An address within the instruction that it is at: where it called, the call.
    pub(crate) fn address_in_code(&self) -> u32 {
        self.program_counter - u32::from(self.has_called)
    }

    pub(crate) fn register(&self, number: usize) -> Piece {
        let register = self.registers.get(number);
        register.copied().unwrap_or(Piece::Unknown)
    }

    pub(crate) fn innermost(chip: &Chip) -> Frame {
        Frame {
            program_counter: 2 * chip.cpu().program_counter(),
            has_called: false,
            cfa: None,
            stack_pointer: Some(chip.cpu().stack_pointer()),
            registers: std::array::from_fn(|number| Piece::Register(number as u8)),
        }
    }

    fn pair(&self, chip: &Chip, number: usize) -> Option<u16> {
        let byte = |number| self.register(number).read(chip);
        Some(u16::from_le_bytes([byte(number)?, byte(number + 1)?]))
    }
}

impl Unwinder {
    /// Reads the table.
    pub(crate) fn read(section: &[u8], flash: &[u8]) -> gimli::Result<Unwinder> {
        let mut frames = DebugFrame::from(EndianSlice::new(section, LittleEndian));
        frames.set_address_size(4);
        let bases = BaseAddresses::default();
        let mut context = UnwindContext::new();
        let mut rows = Vec::new();
        let mut entries = frames.entries(&bases);
        while let Some(entry) = entries.next()? {
            let CieOrFde::Fde(partial) = entry else {
                continue;
            };
            let entry = partial.parse(DebugFrame::cie_from_offset)?;
            let uncounted = uncounted(flash, entry.initial_address() as u32);
            let mut table = entry.rows(&frames, &bases, &mut context)?;
            while let Some(row) = table.next_row()? {
                let CfaRule::RegisterAndOffset { register, offset } = *row.cfa() else {
                    continue;
                };
                let saved = row.registers().filter_map(|(register, rule)| match rule {
                    RegisterRule::Offset(at) => Some((register, *at)),
                    _ => None,
                });
                let (returns, saved): (Vec<_>, Vec<_>) =
                    saved.partition(|(register, _)| **register == RETURN_ADDRESS);
                let Some((_, return_at)) = returns.first() else {
                    continue;
                };
                let of_byte = |(register, at): (&Register, i64)| (register.0 as u8, at);
                rows.extend(counted(
                    Row {
                        addresses: row.start_address() as u32..row.end_address() as u32,
                        base: register.0,
                        offset,
                        saved: saved.into_iter().map(of_byte).collect(),
                        return_at: *return_at,
                    },
                    &uncounted,
                ));
            }
        }
        rows.sort_by_key(|row| row.addresses.start);
        Ok(Unwinder { rows })
    }

    fn row(&self, address: u32) -> Option<&Row> {
        let rows = &self.rows;
        let after = rows.partition_point(|row| row.addresses.start <= address);
        let row = self.rows.get(after.checked_sub(1)?)?;
        row.addresses.contains(&address).then_some(row)
    }

    /// The CFA of a frame at an address with this stack pointer and Y.
    pub(crate) fn cfa(&self, address: u32, stack_pointer: u16, y: u16) -> Option<u16> {
        let row = self.row(address)?;
        let is_stack_pointer = row.base == STACK_POINTER;
        let base = if is_stack_pointer { stack_pointer } else { y };
        Some(base.wrapping_add(row.offset as u16))
    }

    /// The frames, innermost first, up to the one that `is_outermost`; `is_interrupt` knows interrupt routines.
    pub(crate) fn frames(
        &self,
        chip: &Chip,
        is_outermost: impl Fn(u32) -> bool,
        is_interrupt: impl Fn(u32) -> bool,
    ) -> Vec<Frame> {
        let mut frames = Vec::new();
        let mut next = Some(Frame::innermost(chip));
        while let Some(mut frame) = next
            && frames.len() < MOST
        {
            let interrupts = is_interrupt(frame.address_in_code());
            let caller = self.caller(chip, &mut frame, interrupts);
            next = caller.filter(|_| !is_outermost(frame.address_in_code()));
            frames.push(frame);
        }
        frames
    }

    /// The frame that called or was interrupted; gives the callee its CFA.
    fn caller(&self, chip: &Chip, frame: &mut Frame, interrupts: bool) -> Option<Frame> {
        let stack_pointer = frame.stack_pointer?;
        let width = chip.model().address_bytes();
        let Some(row) = self.row(frame.address_in_code()) else {
            let cfa = stack_pointer.wrapping_add(width);
            let program_counter = return_address(chip, stack_pointer.wrapping_add(1))?;
            if !follows_call(chip, program_counter) {
                return None;
            }
            frame.cfa = Some(cfa);
            return Some(Frame {
                program_counter,
                has_called: true,
                cfa: None,
                stack_pointer: Some(cfa),
                ..frame.clone()
            });
        };
        let base = if row.base == STACK_POINTER {
            stack_pointer
        } else {
            frame.pair(chip, row.base.into())?
        };
        let cfa = base.wrapping_add(row.offset as u16);
        frame.cfa = Some(cfa);
        let mut registers = frame.registers;
        for (register, at) in &row.saved {
            if let Some(place) = registers.get_mut(usize::from(*register)) {
                *place = Piece::Memory(DATA | u32::from(cfa.wrapping_add(*at as u16)));
            }
        }
        let program_counter = return_address(chip, cfa.wrapping_add(row.return_at as u16))?;
        if !interrupts && !follows_call(chip, program_counter) {
            return None;
        }
        Some(Frame {
            program_counter,
            has_called: !interrupts,
            cfa: None,
            stack_pointer: Some(cfa),
            registers,
        })
    }
}

/// Behind which instructions an interrupt routine has pushed more than GCC's table says, and how much is on the stack
/// there: it forgets where the routine saves SREG and RAMPZ, by way of r0.
fn uncounted(flash: &[u8], entry: u32) -> Vec<(u32, i64)> {
    let (mut found, mut pushed, mut copied) = (Vec::new(), 0, false);
    for address in (entry..).step_by(2) {
        let op = operation(flash, address);
        match op.code {
            Code::In if op.a == 0 => copied = true,
            Code::Push if op.a == 0 && copied => {
                copied = false;
                found.push((address + 2, pushed));
            }
            Code::Push => pushed += 1,
            Code::Eor => {}
            _ => return found,
        }
    }
    found
}

/// A row with what the table forgets: before, behind the first push of that kind, and so on.
fn counted(row: Row, uncounted: &[(u32, i64)]) -> Vec<Row> {
    let mut rows = vec![row];
    for (index, (from, pushed)) in uncounted.iter().enumerate() {
        let Some(mut last) = rows.pop() else { break };
        if last.addresses.end <= *from {
            rows.push(last);
            break;
        }
        if last.addresses.start < *from {
            rows.push(Row {
                addresses: last.addresses.start..*from,
                ..last.clone()
            });
            last.addresses.start = *from;
        }
        last.offset += 1;
        // What was pushed later is one lower than it says; of the return address nothing changes.
        let first_later = last.return_at - 1 - pushed - index as i64;
        for (_, at) in last.saved.iter_mut().filter(|(_, at)| *at <= first_later) {
            *at -= 1;
        }
        rows.push(last);
    }
    rows
}

fn operation(flash: &[u8], address: u32) -> Op {
    let word = |at: u32| {
        let byte = |at: u32| flash.get(at as usize).copied().unwrap_or(0xFF);
        u16::from_le_bytes([byte(at), byte(at + 1)])
    };
    decode(address / 2, word(address), word(address + 2))
}

/// The address on the stack from here on [bytes].
fn return_address(chip: &Chip, at: u16) -> Option<u32> {
    let width = chip.model().address_bytes();
    if at.checked_add(width - 1)? > chip.model().ram_end {
        return None;
    }
    let word = (0..width).fold(0, |word, byte| {
        word << 8 | u32::from(chip.read_data(at + byte))
    });
    (word < chip.model().flash_words).then_some(2 * word)
}

/// Whether the instruction before an address [bytes] is a call.
fn follows_call(chip: &Chip, address: u32) -> bool {
    let before = |bytes: u32| {
        let at = address.checked_sub(bytes)?;
        Some(operation(chip.cpu().flash(), at).code)
    };
    matches!(before(2), Some(Code::Rcall | Code::Icall | Code::Eicall))
        || before(4) == Some(Code::Call)
}
