//! SPI with the edges on its pins, with exact cycles (2549Q, section 21; SPCR on page 197).
#![cfg(test)]

use crate::common;
use common::*;
use rumbo_emulator::chip::Chip;
use rumbo_emulator::devices::Input;
use rumbo_emulator::devices::ports::Drive;

const DDRB: u16 = 0x24;
const SPCR: u16 = 0x4C;
const SPSR: u16 = 0x4D;
const SPDR: u16 = 0x4E;
const SPIF: u8 = 0x80;
const WCOL: u8 = 0x40;
const DORD: u8 = 0x20;
const CPOL: u8 = 0x08;
const CPHA: u8 = 0x04;

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

/// The bits of a byte in the order in which they cross the line.
fn bits(byte: u8, control: u8) -> [bool; 8] {
    let byte = if control & DORD != 0 {
        byte
    } else {
        byte.reverse_bits()
    };
    std::array::from_fn(|bit| byte >> bit & 1 != 0)
}

#[test]
fn a_master_s_edges_are_those_of_its_mode() {
    for mode in [0, CPHA, CPOL, CPOL | CPHA, DORD, DORD | CPHA] {
        for (rate, double, half) in [(0, 1, 1), (0, 0, 2), (1, 0, 8), (3, 0, 64)] {
            let (mut chip, _) = set_up(&[(DDRB, 0x07), (SPCR, 0x50 | mode | rate), (SPSR, double)]);
            chip.run_until(100);
            chip.take_outputs();
            let idle = mode & CPOL != 0;
            assert_eq!(chip.devices().level(pin('B', 1)), idle);
            let start = chip.cycle();
            // The line rests low: each bit's level is an edge or none.
            write(&mut chip, SPDR, 0x69);
            let mut other = chip.clone();
            chip.run_until(start + 17 * half + 2);
            let clock: Vec<_> = (1..=16)
                .map(|step| (start + step * half, (step % 2 != 0) != idle))
                .collect();
            assert_eq!(edges(&mut chip, pin('B', 1)), clock, "{mode:#x}");
            other.run_until(start + 17 * half + 2);
            let mut level = false;
            let mut data = Vec::new();
            for (bit, high) in (0u64..).zip(bits(0x69, mode)) {
                if high != level {
                    let shift = if mode & CPHA != 0 { half } else { 0 };
                    data.push((start + 2 * bit * half + shift, high));
                    level = high;
                }
            }
            assert_eq!(edges(&mut other, pin('B', 2)), data, "{mode:#x}");
        }
    }
}

#[test]
fn a_master_reads_the_level_of_miso_bit_by_bit() {
    for mode in [0, CPHA, DORD] {
        let (mut chip, _) = set_up(&[(DDRB, 0x07), (SPCR, 0x51 | mode)]);
        chip.run_until(100);
        let start = chip.cycle();
        write(&mut chip, SPDR, 0);
        for (bit, high) in (0u64..).zip(bits(0xB2, mode)) {
            let taken = start + 16 * bit + if mode & CPHA != 0 { 16 } else { 8 };
            chip.input(taken - 2, Input::Pin(pin('B', 3), Some(high)));
            chip.input(taken + 2, Input::Pin(pin('B', 3), Some(!high)));
        }
        chip.run_until(start + 140);
        assert_eq!(read(&mut chip, SPDR), 0xB2);
    }
}

/// A slave and the cycles at which its master moves: SS low at 1000, an edge every 10 from 1020 on.
fn slave(mode: u8, edges: u64) -> Chip {
    let (mut chip, _) = set_up(&[(DDRB, 0x08), (SPCR, 0x40 | mode), (SPDR, 0xC5)]);
    let idle = mode & CPOL != 0;
    for (bit, level) in [(0, true), (1, idle), (2, false)] {
        chip.input(0, Input::Pin(pin('B', bit), Some(level)));
    }
    chip.input(1_000, Input::Pin(pin('B', 0), Some(false)));
    let sent = bits(0x3A, mode);
    for edge in 0..edges {
        let at = 1_020 + 10 * edge;
        let bit = (edge % 16) as usize / 2;
        chip.input(at - 5, Input::Pin(pin('B', 2), Some(sent[bit])));
        chip.input(at, Input::Pin(pin('B', 1), Some((edge % 2 == 0) != idle)));
    }
    chip
}

#[test]
fn a_slave_exchanges_a_byte_with_the_master_that_clocks_it() {
    for mode in [0, CPOL, CPHA, CPOL | CPHA, DORD] {
        let mut chip = slave(mode, 32);
        chip.run_until(990);
        assert_eq!(
            chip.devices().drive(pin('B', 3)),
            Drive::Floating,
            "not selected"
        );
        // What the master takes: without CPHA at the first edge of a bit, else at the second.
        let taken = |chip: &mut Chip, byte: u64| -> Vec<bool> {
            (0..8)
                .map(|bit| {
                    let edge = 16 * byte + 2 * bit + u64::from(mode & CPHA != 0);
                    chip.run_until(1_020 + 10 * edge - 1);
                    chip.devices().level(pin('B', 3))
                })
                .collect()
        };
        assert_eq!(taken(&mut chip, 0), bits(0xC5, mode), "{mode:#x}");
        chip.run_until(1_169);
        assert_eq!(read(&mut chip, SPSR) & SPIF, 0);
        // A slave that is given nothing sends back what it got.
        assert_eq!(taken(&mut chip, 1), bits(0x3A, mode), "{mode:#x}");
        assert_eq!(read(&mut chip, SPSR) & SPIF, SPIF);
        assert_eq!(read(&mut chip, SPDR), 0x3A);
    }
}

#[test]
fn a_slave_that_is_no_longer_selected_drops_what_it_has() {
    let mut chip = slave(0, 8);
    chip.run_until(1_050);
    write(&mut chip, SPDR, 0x11);
    assert_eq!(read(&mut chip, SPSR), WCOL, "in the middle of a byte");
    chip.input(1_200, Input::Pin(pin('B', 0), Some(true)));
    chip.input(1_300, Input::Pin(pin('B', 0), Some(false)));
    for edge in 0..16 {
        let level = edge % 2 == 0;
        chip.input(1_310 + 10 * edge, Input::Pin(pin('B', 1), Some(level)));
    }
    chip.run_until(1_455);
    assert_eq!(read(&mut chip, SPSR) & SPIF, 0);
    chip.run_until(1_465);
    assert_eq!(
        read(&mut chip, SPSR) & SPIF,
        SPIF,
        "eight bits after it was selected"
    );
}
