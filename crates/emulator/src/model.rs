//! Which chip it is: memories, vectors, registers, and the pins of its peripherals. One core and one set of peripherals
//! run every model by its description.
//!
//! A register that several models have is at the same address in all of them. Sources: 2549Q
//! (ATmega640/1280/1281/2560/2561) and DS40002061B (ATmega48A/PA/88A/PA/168A/PA/328/P).

mod atmega2560;
mod atmega328p;
mod fuses;
pub(crate) mod map;
pub(crate) mod pin;
pub(crate) mod timer;
pub(crate) mod usart;

use crate::decode::{Code, Op};
pub use atmega328p::ATMEGA328P;
pub use atmega2560::ATMEGA2560;
pub use fuses::Fuses;
use map::{Owner, REGISTERS_END};
use pin::{PORTS, Pin};
use std::fmt;

/// The models that there are.
pub static MODELS: [&Model; 2] = [&ATMEGA2560, &ATMEGA328P];

/// A chip's description.
pub struct Model {
    /// As the compiler's option `-mmcu` names it.
    pub name: &'static str,
    /// The boards that have it, as the Arduino IDE's menu names them.
    pub boards: &'static str,
    /// Number of its architecture in the flags of an ELF file: 5 with a program counter of 16 bits, 6 with one of 22.
    pub architecture: u32,
    /// What it answers a programmer.
    pub signature: [u8; 3],
    /// Flash [words], a power of two.
    pub flash_words: u32,
    /// First address of the SRAM in the data space.
    pub sram_start: u16,
    /// Last address of the SRAM.
    pub ram_end: u16,
    /// EEPROM [bytes], a power of two.
    pub eeprom_bytes: usize,
    /// Words of a page of flash.
    pub page_words: usize,
    /// The largest boot section [words]; BOOTSZ halves it.
    pub boot_words: u32,
    /// From this word on the CPU cannot run beside the flash's programming.
    pub(crate) no_read_while_write: u32,
    /// The fuses of the Arduino board.
    pub fuses: Fuses,
    /// The names of its interrupts, as in the headers of avr-libc without `_vect`.
    pub vectors: &'static [&'static str],
    pub(crate) numbers: Vectors,
    /// Whose register each address is.
    pub(crate) owners: [Owner; REGISTERS_END],
    /// The bits that each port has.
    pub(crate) ports: [u8; PORTS],
    pub(crate) timers: &'static [timer::TimerInstance],
    pub(crate) usarts: &'static [usart::UsartInstance],
    /// The pins of INT0 and on; from the second value on, their edges need the clock of the peripherals.
    pub(crate) external: (&'static [Pin], usize),
    pub(crate) pin_changes: &'static [PinChange],
    /// SS, SCK, MOSI, MISO.
    pub(crate) spi: [Pin; 4],
    /// SCL, SDA.
    pub(crate) twi: [Pin; 2],
    pub(crate) analog: Analog,
    /// The output that two timers share: OC0A and OC1C.
    pub(crate) shared_output: Option<Pin>,
    /// The bits of MCUCR that keep what is written.
    pub(crate) control_bits: u8,
}

/// The numbers of single interrupt vectors. A lower one has priority.
pub(crate) struct Vectors {
    /// That of PCINT0; the others follow.
    pub(crate) pin_change: u8,
    pub(crate) watchdog: u8,
    pub(crate) spi: u8,
    pub(crate) compared: u8,
    pub(crate) converted: u8,
    pub(crate) eeprom_ready: u8,
    pub(crate) twi: u8,
    pub(crate) programmed: u8,
}

/// Pins of a port whose changes raise an interrupt.
pub(crate) struct PinChange {
    pub(crate) port: usize,
    pub(crate) pins: u8,
    /// The interrupt, PCINT0 to 2, and where in its mask the first pin is.
    pub(crate) group: usize,
    pub(crate) shift: u8,
}

/// What is on the converter and the comparator.
#[derive(Debug)]
pub(crate) struct Analog {
    /// The pins of ADC0 to ADC15, AREF (none of a port), AIN0 and AIN1.
    pub(crate) pins: [Option<Pin>; 19],
    /// The reference on the chip that REFS selects with 2 and 3 [V].
    pub(crate) internal_v: [f64; 2],
    /// It has MUX4 and MUX5, for differential inputs and a second bank; else MUX3 selects the temperature.
    pub(crate) differential: bool,
}

impl Analog {
    /// The pin of an analog input.
    pub(crate) fn pin(&self, channel: u8) -> Option<Pin> {
        self.pins.get(usize::from(channel)).copied().flatten()
    }

    /// The analog input on a pin, if one is.
    pub(crate) fn channel(&self, pin: Pin) -> Option<u8> {
        let found = self.pins.iter().position(|own| *own == Some(pin));
        found.map(|channel| channel as u8)
    }
}

impl Model {
    /// SRAM [bytes].
    pub const fn sram_bytes(&self) -> usize {
        (self.ram_end - self.sram_start) as usize + 1
    }

    /// Flash [bytes].
    pub const fn flash_bytes(&self) -> usize {
        2 * self.flash_words as usize
    }

    /// The inputs of timers and USARTs, by the pin's number.
    pub(crate) fn sensed(&self) -> u128 {
        let of_timers = self.timers.iter().flat_map(timer::TimerInstance::inputs);
        let of_usarts = self.usarts.iter().flat_map(usart::UsartInstance::inputs);
        let inputs = of_timers.chain(of_usarts);
        inputs.fold(0, |all, pin| all | 1 << pin.number())
    }

    /// Where the boot section starts with these fuses [words].
    pub const fn boot_start(&self, fuses: Fuses) -> u32 {
        self.flash_words - (self.boot_words >> (fuses.high >> 1 & 3))
    }

    /// Its program counter is wider than 16 bits: addresses on the stack take three bytes, and calls, returns and
    /// interrupts a cycle more; RAMPZ and EIND extend Z.
    pub const fn is_far(&self) -> bool {
        self.architecture == 6
    }

    /// Bytes of an address on the stack.
    pub const fn address_bytes(&self) -> u16 {
        if self.is_far() { 3 } else { 2 }
    }

    /// The name of interrupt vector `number`.
    pub fn vector_name(&self, number: u8) -> &'static str {
        let name = self.vectors.get(usize::from(number));
        name.copied().unwrap_or("?")
    }

    /// The operation as this model runs it: those through RAMPZ and EIND exist where these do.
    pub(crate) fn admit(&self, op: Op, word: u16) -> Op {
        let far = matches!(
            op.code,
            Code::Eijmp | Code::Eicall | Code::Elpm | Code::ElpmInc
        );
        if far && !self.is_far() {
            return Op {
                code: Code::Illegal,
                a: 0,
                b: word,
            };
        }
        op
    }

    /// How to compile for it.
    pub fn advice(&self) -> String {
        format!(
            "in the Arduino IDE choose Tools > Board > {} (-mmcu={})",
            self.boards, self.name
        )
    }

    /// The model of this name.
    pub fn named(name: &str) -> Option<&'static Model> {
        MODELS.into_iter().find(|model| model.name == name)
    }
}

/// The Mega's.
impl Default for &'static Model {
    fn default() -> Self {
        &ATMEGA2560
    }
}

impl PartialEq for Model {
    fn eq(&self, other: &Model) -> bool {
        self.name == other.name
    }
}

impl Eq for Model {}

impl fmt::Debug for Model {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        out.write_str(self.name)
    }
}

/// A pin of a table; one that does not exist does not compile.
const fn pin(letter: char, bit: u8) -> Pin {
    match Pin::new(letter, bit) {
        Some(pin) => pin,
        None => unreachable!(),
    }
}

/// The first `N` pins of a port.
const fn pins_of<const N: usize>(letter: char) -> [Option<Pin>; N] {
    let mut pins = [None; N];
    let mut bit = 0;
    while bit < N {
        pins[bit] = Some(pin(letter, bit as u8));
        bit += 1;
    }
    pins
}

#[cfg(test)]
mod tests;
