//! A HEX file does not name its chip, but its start reveals it: the compiler's first instructions set the stack pointer
//! to the end of the chip's SRAM.

use super::{Image, ImageError};
use crate::decode::{Code, decode};
use crate::model::{MODELS, Model};

/// Ends of SRAM of chips that there are no models of, and who has them.
const OTHERS: [(u16, &str); 4] = [
    (0x02FF, "ATmega88"),
    (0x04FF, "ATmega168"),
    (0x0AFF, "ATmega32U4 of an Arduino Leonardo or Micro"),
    (0x10FF, "ATmega128 or ATmega644"),
];
/// Instructions from the start within which the stack pointer is set.
const START: usize = 12;

/// The chip whose SRAM ends where the program sets its stack, if it does.
///
/// # Errors
/// There is no model of that chip.
pub(super) fn model(image: &Image) -> Result<Option<&'static Model>, ImageError> {
    let end = stack_at_start(image);
    if let Some((end, name)) = OTHERS.iter().find(|(known, _)| end == Some(*known)) {
        return Err(ImageError::Device(format!(
            "its stack begins at 0x{end:04x}, as on the {name}"
        )));
    }
    let mut models = MODELS.into_iter();
    Ok(models.find(|model| end == Some(model.ram_end)))
}

/// What the program's first instructions load into Y before they write it to the stack pointer.
fn stack_at_start(image: &Image) -> Option<u16> {
    let word = |at: u32| {
        let at = 2 * at as usize;
        let bytes = image.flash().get(at..at + 2)?;
        Some(u16::from_le_bytes([bytes[0], bytes[1]]))
    };
    let op = |at: u32| Some(decode(at, word(at)?, word(at + 1).unwrap_or_default()));
    let reset = op(0).filter(|op| matches!(op.code, Code::Jmp | Code::Rjmp))?;
    let [mut low, mut high] = [None; 2];
    for at in (reset.address()..).take(START) {
        let op = op(at)?;
        match (op.code, op.a) {
            (Code::Ldi, 28) => low = Some(op.b as u8),
            (Code::Ldi, 29) => high = Some(op.b as u8),
            // OUT to SPL.
            (Code::Out, 28) if op.b == 0x3D => return Some(u16::from_le_bytes([low?, high?])),
            _ => {}
        }
    }
    None
}
