//! When a program reaches some of its functions: breakpoints that record the cycle and continue.

use super::Mega;

/// The functions that are looked for, and when the program came to them.
#[derive(Clone, Debug, Default)]
pub(super) struct Marks {
    addresses: Vec<u32>,
    met: Vec<(usize, u64)>,
}

impl Mega {
    /// Records from now on when the program reaches these functions; returns whether it has them all. Not while a
    /// debugger holds it.
    pub fn mark(&mut self, functions: &[&str]) -> bool {
        let image = self.firmware.image();
        let address = |name: &&str| image.function_named(name).map(|function| function.address);
        let Some(addresses) = functions.iter().map(address).collect::<Option<Vec<_>>>() else {
            return false;
        };
        for address in &addresses {
            self.chip.cpu_mut().set_breakpoint(*address);
        }
        self.marks.addresses = addresses;
        true
    }

    /// Drains the functions reached since the last call: index in the list, and the chip's cycle.
    pub fn take_marks(&mut self) -> Vec<(usize, u64)> {
        std::mem::take(&mut self.marks.met)
    }

    /// At a breakpoint: notes it if it is a mark, and steps over it.
    pub(super) fn pass_mark(&mut self) -> bool {
        let here = self.chip.cpu().program_counter();
        let Some(mark) = self.marks.addresses.iter().position(|at| *at == here) else {
            return false;
        };
        self.marks.met.push((mark, self.chip.cycle()));
        self.chip.step();
        true
    }
}
