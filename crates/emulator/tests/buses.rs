//! SPI and TWI with nothing connected, and what else has registers only, with exact cycles (DS40002549, sections 9, 21 and 24).
#![cfg(test)]

mod common;

use common::*;
use rumbo_emulator::chip::Chip;
use rumbo_emulator::devices::Input;
use rumbo_emulator::devices::ports::Drive;

const SPCR: u16 = 0x4C;
const SPSR: u16 = 0x4D;
const SPDR: u16 = 0x4E;
const SPIF: u8 = 0x80;
const WCOL: u8 = 0x40;

const TWBR: u16 = 0xB8;
const TWSR: u16 = 0xB9;
const TWDR: u16 = 0xBB;
const TWCR: u16 = 0xBC;
const TWINT: u8 = 0x80;
const TWEN: u8 = 0x04;

#[test]
fn a_transfer_takes_eight_periods_of_its_clock() {
    for (control, double, divisor) in [
        (0x50, 0, 4),
        (0x51, 0, 16),
        (0x52, 0, 64),
        (0x53, 0, 128),
        (0x50, 1, 2),
        (0x53, 1, 64),
    ] {
        let (mut chip, _) = set_up(&[(0x24, 0x07), (SPCR, control), (SPSR, double)]);
        chip.input(0, Input::Pin(pin('B', 3), Some(divisor != 16)));
        chip.run_until(100);
        let start = chip.cpu().cycle();
        write(&mut chip, SPDR, 0xA5);
        let end = start + 8 * divisor;
        assert_eq!(read_at(&mut chip, SPSR, end - 1) & SPIF, 0);
        assert_eq!(read_at(&mut chip, SPSR, end), SPIF | double);
        // MISO's level; and SPSR followed by SPDR clears the flag.
        assert_eq!(read(&mut chip, SPDR), if divisor == 16 { 0 } else { 0xFF });
        assert_eq!(read(&mut chip, SPSR), double);
    }
}

#[test]
fn a_byte_too_early_is_a_collision_and_a_routine_clears_the_flag() {
    // Vector 24 counts in r20.
    let mut words = vec![NOP; 0x90];
    words[..2].copy_from_slice(&[0x940C, 0x90]);
    words[48..50].copy_from_slice(&[0x940C, 0x80]);
    words[0x80..0x82].copy_from_slice(&[0x9543, RETI]);
    words.extend([
        ldi(16, 0xD0),
        out(0x2C, 16),
        out(0x2E, 16),
        out(0x2E, 16),
        SEI,
        0xCFFF,
    ]);
    let mut chip = chip_of(&words);
    chip.run_until(200);
    assert_eq!(chip.cpu().registers()[20], 1);
    assert_eq!(read(&mut chip, SPSR), WCOL);
}

#[test]
fn a_master_that_is_selected_becomes_a_slave() {
    let (mut chip, _) = set_up(&[(SPCR, 0x50)]);
    chip.run_until(50);
    assert_eq!(read(&mut chip, SPCR), 0x50, "nothing at SS");
    chip.input(100, Input::Pin(pin('B', 0), Some(true)));
    chip.input(200, Input::Pin(pin('B', 0), Some(false)));
    chip.run_until(150);
    assert_eq!(read(&mut chip, SPCR), 0x50);
    chip.run_until(250);
    assert_eq!([read(&mut chip, SPCR), read(&mut chip, SPSR)], [0x40, SPIF]);
}

/// Does something on the bus: how long it takes until TWINT, and the status.
fn on_bus(chip: &mut Chip, command: u8) -> (u64, u8) {
    let start = chip.cpu().cycle();
    write(chip, TWCR, TWINT | TWEN | command);
    for cycle in start..start + 10_000 {
        if read_at(chip, TWCR, cycle) & TWINT != 0 {
            return (cycle - start, read(chip, TWSR));
        }
    }
    panic!("no TWINT");
}

#[test]
fn nobody_answers_on_the_bus() {
    // 100 kHz as the Arduino library has it: 160 cycles a bit.
    let (mut chip, _) = set_up(&[(TWBR, 72), (TWCR, TWEN)]);
    chip.run_until(100);
    assert_eq!(read(&mut chip, TWSR), 0xF8);
    assert_eq!(on_bus(&mut chip, 0x20), (160, 0x08));
    write(&mut chip, TWDR, 0x42);
    assert_eq!(on_bus(&mut chip, 0), (9 * 160, 0x20));
    assert_eq!(on_bus(&mut chip, 0), (9 * 160, 0x30));
    assert_eq!(on_bus(&mut chip, 0x20), (160, 0x10), "a repeated start");
    write(&mut chip, TWDR, 0x43);
    assert_eq!(on_bus(&mut chip, 0), (9 * 160, 0x48));
    let stop = chip.cpu().cycle();
    write(&mut chip, TWCR, TWINT | TWEN | 0x10);
    assert_eq!(read_at(&mut chip, TWCR, stop + 159), TWEN | 0x10);
    assert_eq!(read_at(&mut chip, TWCR, stop + 160), TWEN);
    assert_eq!(read(&mut chip, TWSR), 0xF8);
    write(&mut chip, TWDR, 1);
    assert_eq!(read(&mut chip, TWCR), TWEN | 0x08, "TWWC: not now");
    assert_eq!(chip.devices().drive(pin('D', 1)), Drive::Floating);
}

#[test]
fn every_register_of_the_chip_is_one_and_nothing_else_is() {
    // Reserved addresses of the data space (section 34).
    let reserved = [
        0x49, 0x4F, 0x52, 0x56, 0x58, 0x59, 0x5A, 0x62, 0x63, 0x67, 0x76, 0x77, 0x83, 0x8E, 0x8F,
        0x93, 0x9E, 0x9F, 0xA3, 0xAE, 0xAF, 0xB5, 0xB7, 0xBE, 0xBF, 0xC3, 0xC7, 0xCB, 0xCF, 0xD3,
        0x123, 0x12E, 0x12F, 0x133,
    ];
    let ranges = [0xD7..=0xFF, 0x10C..=0x11F, 0x137..=0x1FF];
    let (mut chip, _) = set_up(&[(0x3E, 0)]);
    for address in 0x20..0x200u16 {
        // EIND, RAMPZ, the stack pointer and SREG are the CPU's own.
        if !matches!(address, 0x5B..=0x5F) {
            read(&mut chip, address);
        }
    }
    let told: Vec<u16> = chip
        .unmodelled()
        .iter()
        .map(|access| access.address)
        .collect();
    let mut expected: Vec<u16> = reserved.into();
    expected.extend(ranges.into_iter().flatten());
    expected.sort_unstable();
    assert_eq!(told, expected);
}

#[test]
fn memory_that_is_not_there_is_told() {
    let (mut chip, _) = set_up(&[(0x74, 0x80), (0x2200, 1)]);
    chip.run_until(50);
    let told: Vec<u16> = chip
        .unmodelled()
        .iter()
        .map(|access| access.address)
        .collect();
    assert_eq!(told, [0x74, 0x2200]);
}
