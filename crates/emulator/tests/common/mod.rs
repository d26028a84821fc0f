//! A few instructions, and a chip that runs them.
#![allow(dead_code, reason = "each test file uses some of it")]

use rumbo_emulator::chip::Chip;
use rumbo_emulator::devices::ports::{Drive, Pin};
use rumbo_emulator::devices::{Event, Output};
use rumbo_emulator::image::Image;
use rumbo_emulator::io::{Access, Io};
use rumbo_emulator::model::{ATMEGA2560, Model};

pub(crate) const NOP: u16 = 0x0000;
pub(crate) const SEI: u16 = 0x9478;
pub(crate) const RETI: u16 = 0x9518;
pub(crate) const SLEEP: u16 = 0x9588;

pub(crate) fn ldi(register: u8, value: u8) -> u16 {
    let (d, k) = (u16::from(register & 0xF), u16::from(value));
    0xE000 | (k & 0xF0) << 4 | d << 4 | k & 0xF
}

pub(crate) fn out(address: u8, register: u8) -> u16 {
    let a = u16::from(address);
    0xB800 | (a & 0x30) << 5 | u16::from(register) << 4 | a & 0xF
}

pub(crate) fn sbi(address: u8, bit: u8) -> u16 {
    0x9A00 | u16::from(address) << 3 | u16::from(bit)
}

pub(crate) fn sts(address: u16, register: u8) -> [u16; 2] {
    [0x9200 | u16::from(register) << 4, address]
}

/// A chip with these words in its flash.
pub(crate) fn chip_of(words: &[u16]) -> Chip {
    chip_on(&ATMEGA2560, words)
}

/// The same of another model.
pub(crate) fn chip_on(model: &'static Model, words: &[u16]) -> Chip {
    let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
    Chip::new(&Image::of_flash(&bytes).on(model).unwrap())
}

pub(crate) fn pin(letter: char, bit: u8) -> Pin {
    Pin::new(letter, bit).unwrap()
}

/// When the chip drove a pin to another level, and to which.
pub(crate) fn edges(chip: &mut Chip, wanted: Pin) -> Vec<(u64, bool)> {
    chip.take_outputs()
        .into_iter()
        .filter_map(|Output { cycle, event }| match event {
            Event::Pin(at, drive @ (Drive::High | Drive::Low)) if at == wanted => {
                Some((cycle, drive == Drive::High))
            }
            _ => None,
        })
        .collect()
}

/// Writes to registers, in this order, then waits for ever: the chip, and the cycle in which the last write acts.
pub(crate) fn set_up(writes: &[(u16, u8)]) -> (Chip, u64) {
    set_up_on(&ATMEGA2560, writes)
}

/// The same of another model.
pub(crate) fn set_up_on(model: &'static Model, writes: &[(u16, u8)]) -> (Chip, u64) {
    let mut words = Vec::new();
    for (address, value) in writes {
        words.push(ldi(16, *value));
        words.extend(sts(*address, 16));
    }
    // RJMP to itself.
    words.push(0xCFFF);
    (chip_on(model, &words), 3 * writes.len() as u64 - 1)
}

/// A 16-bit register, read as a program would.
pub(crate) fn count_of(chip: &mut Chip, address: u16) -> u16 {
    let low = read(chip, address);
    let high = read(chip, address + 1);
    u16::from_le_bytes([low, high])
}

/// A register now.
pub(crate) fn read(chip: &mut Chip, address: u16) -> u8 {
    let cycle = chip.cpu().cycle();
    read_at(chip, address, cycle)
}

/// A register at a cycle; the program has run up to one or two before it at the most.
pub(crate) fn read_at(chip: &mut Chip, address: u16, cycle: u64) -> u8 {
    chip.run_until(cycle.saturating_sub(2));
    let at = Access {
        cycle,
        program_counter: 0,
    };
    chip.devices_mut().read(address, at)
}

/// Writes a register now, as a program would.
pub(crate) fn write(chip: &mut Chip, address: u16, value: u8) {
    let at = Access {
        cycle: chip.cpu().cycle(),
        program_counter: 0,
    };
    chip.devices_mut().write(address, value, at);
}
