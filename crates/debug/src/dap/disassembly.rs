//! Instructions around an address.

use super::breakpoints::address;
use super::inspect::source;
use super::message::Disassemble;
use super::{Adapter, LaunchHost};
use rumbo_emulator::decode::is_long;
use rumbo_emulator::disassemble;
use serde_json::{Value, json};

/// Most instructions of a response.
const MOST: usize = 4_096;
/// Longest instruction [bytes].
const LONGEST: i64 = 4;

impl<H: LaunchHost> Adapter<H> {
    pub(super) fn disassemble(&mut self, wanted: &Disassemble) -> Result<Value, String> {
        let first = self.lines_start_at;
        let at = address(&wanted.memory_reference)? + wanted.offset;
        let debugger = self.debugger()?;
        let (chip, symbols) = (debugger.chip(), &debugger.symbols);
        let end = chip.model().flash_bytes() as i64;
        let count = wanted.instruction_count.min(MOST) as i64;
        // From a function that begins early enough: where an instruction begins, only what is before it shows.
        let early = at + LONGEST * wanted.instruction_offset.clamp(-(MOST as i64), 0);
        let functions = symbols.image.functions().iter();
        let starts = functions.map(|function| 2 * i64::from(function.address));
        let mut next = starts
            .take_while(|start| *start <= early)
            .last()
            .unwrap_or(0);
        let (mut before, mut from) = (Vec::new(), Vec::new());
        let needed = count + wanted.instruction_offset.clamp(0, MOST as i64);
        while next < end && (from.len() as i64) < needed {
            if next < at { &mut before } else { &mut from }.push(next);
            let low = |at: i64| chip.cpu().flash()[at as usize];
            let is_long = is_long(u16::from_le_bytes([low(next), low(next + 1)]));
            next += if is_long { LONGEST } else { 2 };
        }
        let all: Vec<i64> = before.iter().chain(&from).copied().collect();
        let start = before.len() as i64 + wanted.instruction_offset;
        let instructions = (start..start + count).map(|index| {
            let Some(address) = usize::try_from(index).ok().and_then(|index| all.get(index)) else {
                return json!({"address": "0x0", "instruction": "", "presentationHint": "invalid"});
            };
            let word = (address / 2) as u32;
            let text = disassemble::text(word, chip.cpu().operation(word));
            let mut shown = json!({"address": format!("0x{address:x}"), "instruction": text});
            if let Some(name) = symbols.image.function(word) {
                shown["symbol"] = json!(name);
            }
            if let Some(row) = symbols.lines.row(*address as u32) {
                shown["location"] = source(&symbols.lines.files[row.file]);
                shown["line"] = json!(i64::from(row.line) - 1 + first);
            }
            shown
        });
        Ok(json!({"instructions": instructions.collect::<Vec<_>>()}))
    }
}
