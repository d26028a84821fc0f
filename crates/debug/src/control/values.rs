//! Expressions and assignments where the program stands.

use super::Debugger;
use crate::expression::{self, Item};
use crate::spot::Spot;
use rumbo_emulator::gdb::DebuggedWorld;
use rumbo_emulator::space::DATA;

impl<W: DebuggedWorld> Debugger<W> {
    /// An expression in a frame of the stack, by its number.
    pub(crate) fn evaluate(&self, text: &str, frame: usize) -> Result<Item, String> {
        let stack = self.stack();
        let frame = stack.get(frame).or(stack.first());
        let frame = frame.ok_or("the program stands nowhere")?;
        expression::evaluate(text, frame)
    }

    /// Sets what an expression names in a frame.
    pub(crate) fn assign(&mut self, frame: usize, target: &str, value: &str) -> Result<(), String> {
        let (spot, bytes) = {
            let Item::Value(to) = self.evaluate(target, frame)? else {
                return Err(format!(
                    "{target} is calculated; only a variable or a register of a peripheral can be set"
                ));
            };
            let to = self.memory().referred(to);
            let item = self.evaluate(value, frame)?;
            if to.bits.is_some() {
                return Err(format!("{target} is a bit field, which cannot be set"));
            }
            (to.spot, expression::encoded(&item, to.of, self.memory())?)
        };
        let Some(spot) = spot else {
            return Err(format!("{target} was optimised out"));
        };
        match self.write(&spot, &bytes) {
            true => Ok(()),
            false => Err(format!("{target} is nowhere that can be written to")),
        }
    }

    pub(crate) fn write(&mut self, spot: &Spot, bytes: &[u8]) -> bool {
        self.history
            .change(|world| spot.write(world.chip_mut(), bytes))
    }

    /// The address in the data space of what an expression names, and its bytes.
    pub(crate) fn watched(&self, text: &str, frame: usize) -> Result<(u16, u16), String> {
        let Item::Value(value) = self.evaluate(text, frame)? else {
            return Err(format!("{text} is calculated"));
        };
        let bytes = self.symbols.types.bytes(value.of);
        match value.spot {
            Some(Spot::Memory(address)) if address & DATA != 0 && bytes > 0 => {
                Ok((address as u16, bytes as u16))
            }
            _ => Err(format!(
                "{text} is not in the SRAM: only what is there can be watched"
            )),
        }
    }
}
