//! The EEPROM of the whole chip, with exact cycles (2549Q, section 8).
#![cfg(test)]

use crate::common;
use common::*;
use rumbo_emulator::chip::Chip;

const EECR: u16 = 0x3F;
const EEDR: u16 = 0x40;
const EEARL: u16 = 0x41;
const EEARH: u16 = 0x42;
const EEPE: u8 = 0x02;

/// IN r`register` from an address of the data space.
fn input(register: u8, address: u16) -> u16 {
    let a = address - 0x20;
    0xB000 | (a & 0x30) << 5 | u16::from(register) << 4 | a & 0xF
}

/// Writes `value` to byte 0x123 in a mode of EEPM after `gap` NOPs between EEMPE and EEPE; with the cycle in which EEPE is written.
fn writing(before: u8, mode: u8, value: u8, gap: usize) -> (Chip, u64) {
    let mut words = vec![ldi(16, 0x23), out(0x21, 16), ldi(16, 0x01), out(0x22, 16)];
    words.extend([ldi(16, value), out(0x20, 16), ldi(16, mode), out(0x1F, 16)]);
    words.push(sbi(0x1F, 2));
    words.extend(vec![NOP; gap]);
    words.push(sbi(0x1F, 1));
    let begun = 8 + 2 + gap as u64 + 1;
    words.extend([input(20, EECR), 0xCFFF]);
    let mut chip = chip_of(&words);
    chip.devices_mut().eeprom_mut()[0x123] = before;
    (chip, begun)
}

#[test]
fn a_byte_takes_its_time_to_be_written() {
    // Erase and write 3.4 ms, erase 1.8 ms, write 1.8 ms, which only clears bits.
    for (mode, cycles, after) in [
        (0x00, 54_400, 0x5A),
        (0x10, 28_800, 0xFF),
        (0x20, 28_800, 0x0A),
    ] {
        let (mut chip, begun) = writing(0x0F, mode, 0x5A, 0);
        assert_eq!(read_at(&mut chip, EECR, begun + cycles - 1) & EEPE, EEPE);
        assert_eq!(chip.devices().eeprom()[0x123], 0x0F);
        // The address is held.
        write(&mut chip, EEARL, 0x99);
        write(&mut chip, EEARH, 0x0);
        assert_eq!(read_at(&mut chip, EECR, begun + cycles), mode);
        assert_eq!(chip.devices().eeprom()[0x123], after, "mode {mode:#x}");
        assert_eq!([read(&mut chip, EEARL), read(&mut chip, EEARH)], [0x23, 1]);
    }
}

#[test]
fn the_write_must_follow_within_four_cycles() {
    // SBI acts in its second cycle: two NOPs between are four cycles.
    for (gap, written) in [(0, true), (2, true), (3, false)] {
        let (mut chip, begun) = writing(0xFF, 0, 0x5A, gap);
        assert_eq!(read_at(&mut chip, EECR, begun + 10) & EEPE != 0, written);
        chip.run_until(100_000);
        assert_eq!(chip.devices().eeprom()[0x123] == 0x5A, written);
    }
}

#[test]
fn the_cpu_stands_for_two_cycles_after_a_write_and_four_after_a_read() {
    let (mut chip, begun) = writing(0xFF, 0, 0x5A, 0);
    // IN follows SBI's second cycle after two more.
    chip.run_until(begun + 1);
    assert_eq!(chip.cpu().registers()[20], 0);
    chip.step();
    assert_eq!(chip.cpu().cycle(), begun + 1 + 2);
    chip.step();
    assert_eq!(
        (chip.cpu().registers()[20] & EEPE, chip.cpu().cycle()),
        (EEPE, begun + 4)
    );
    // LDI, OUT EEARL, SBI EERE, IN EEDR.
    let words = [
        ldi(16, 7),
        out(0x21, 16),
        sbi(0x1F, 0),
        input(20, EEDR),
        0xCFFF,
    ];
    let mut chip = chip_of(&words);
    chip.devices_mut().eeprom_mut()[7] = 0x77;
    chip.run_until(4 + 4);
    assert_eq!(chip.cpu().registers()[20], 0);
    chip.run_until(4 + 4 + 1);
    assert_eq!((chip.cpu().registers()[20], chip.cpu().cycle()), (0x77, 9));
}

#[test]
fn ready_interrupts_as_long_as_it_is() {
    // Vector 30 disables itself and counts in r20.
    let mut words = vec![NOP; 0x90];
    words[..2].copy_from_slice(&[0x940C, 0x90]);
    words[60..62].copy_from_slice(&[0x940C, 0x80]);
    words[0x80..0x83].copy_from_slice(&[0x9543, out(0x1F, 21), RETI]);
    words.extend([sbi(0x1F, 2), sbi(0x1F, 1), sbi(0x1F, 3), SEI, 0xCFFF]);
    let mut chip = chip_of(&words);
    let begun = 3 + 2 + 1;
    chip.run_until(begun + 54_400 - 1);
    assert_eq!(chip.cpu().registers()[20], 0);
    chip.run_until(begun + 54_400 + 20);
    assert_eq!(chip.cpu().registers()[20], 1);
}
