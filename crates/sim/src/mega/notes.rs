//! What is odd about a program on the robot, a line each: registers that are not modelled, motors and links that it never used.

use super::Mega;
use super::console::Console;
use super::firmware::Language;
use rumbo_emulator::devices::Unmodelled;

/// The USARTs as a sketch calls them.
const NAMES: [&str; 4] = ["Serial (USB)", "Serial1", "Serial2", "Serial3"];

impl Mega {
    /// Registers that the emulator does not model, and what a program for this robot would have done.
    pub fn notes(&self) -> Vec<String> {
        let image = self.firmware.image();
        let line = |access: &Unmodelled| {
            let done = if access.written { "written" } else { "read" };
            format!(
                "firmware {}: register 0x{:03x}, {done} at {}, is not modelled",
                self.firmware.name(),
                access.address,
                image.place(access.program_counter)
            )
        };
        let strange = self.chip.unmodelled().iter().map(line);
        strange.chain(self.silence()).collect()
    }

    /// What a program for another wiring, or for no robot at all, does not do.
    fn silence(&self) -> Vec<String> {
        let (name, wiring) = (self.firmware.name(), self.firmware.wiring());
        let mut silence = Vec::new();
        if self.firmware.language() == Language::Frames || self.verdict.is_some() {
            return silence;
        }
        if !self.has_driven {
            silence.push(format!(
                "firmware {name}: it never drove a motor; are its pins those of wiring {wiring}? (docs/emulator.md)"
            ));
        }
        let spoke = |usart: usize| self.consoles.get(usart).is_some_and(Console::has_spoken);
        if let Some(link) = self.firmware.link_usart().map(usize::from)
            && !spoke(link)
        {
            let others: Vec<&str> = (0..4)
                .filter(|usart| spoke(*usart))
                .map(|usart| NAMES[usart])
                .collect();
            let others = if others.is_empty() {
                "on no other either".to_owned()
            } else {
                format!("but on {}", others.join(", "))
            };
            silence.push(format!(
                "firmware {name}: nothing came over the Bluetooth link, {} in wiring {wiring}, {others}",
                NAMES[link % 4]
            ));
        }
        silence
    }
}
