//! How a program gets at timers: 16 bits behind a bus of 8 (section 17.3), and the prescalers' common register GTCCR (section 18).
#![cfg(test)]

use crate::common;
use common::*;
use rumbo_emulator::chip::Chip;

/// TCCRnA of the 16-bit timers; TCNT is 4 further, ICR 6, OCRA, OCRB and OCRC 8, 10 and 12.
const WIDE: [u16; 4] = [0x80, 0x90, 0xA0, 0x120];
const GTCCR: u16 = 0x43;
const TSM: u8 = 0x80;
const PSRASY: u8 = 0x02;
const PSRSYNC: u8 = 0x01;

fn write_word(chip: &mut Chip, address: u16, value: u16) {
    let [low, high] = value.to_le_bytes();
    write(chip, address + 1, high);
    write(chip, address, low);
}

#[test]
fn a_count_written_at_a_standstill_blocks_the_match_of_the_first_tick() {
    // OCR1A and TCNT1 are both 5, or TCNT1 is one before; then the CPU's clock.
    for (count, flag) in [(5, 0), (4, 0x02)] {
        let (mut chip, done) = set_up(&[(0x88, 5), (0x84, count), (0x81, 1)]);
        chip.run_until(done + 10);
        assert_eq!(read(&mut chip, 0x36) & 0x02, flag, "from {count}");
    }
}

/// A chip that has run past its set-up, with a timer at rest.
fn at_rest(writes: &[(u16, u8)]) -> Chip {
    let (mut chip, _) = set_up(writes);
    chip.run_until(200);
    chip
}

#[test]
fn every_16_bit_register_is_written_high_byte_first() {
    for base in WIDE {
        // Mode 14, where ICR is the top and can be written; no clock.
        let mut chip = at_rest(&[(base, 0x02), (base + 1, 0x18)]);
        for (offset, value) in [
            (4, 0x1234),
            (6, 0xFEDC),
            (8, 0xABCD),
            (10, 0x55AA),
            (12, 0x0FF0),
        ] {
            write_word(&mut chip, base + offset, value);
        }
        for (offset, value) in [
            (4, 0x1234),
            (6, 0xFEDC),
            (8, 0xABCD),
            (10, 0x55AA),
            (12, 0x0FF0),
        ] {
            assert_eq!(
                count_of(&mut chip, base + offset),
                value,
                "{base:#x} + {offset}"
            );
        }
    }
}

#[test]
fn a_high_byte_alone_changes_nothing_and_a_low_byte_takes_what_was_written_last() {
    for base in WIDE {
        let mut chip = at_rest(&[(base, 0x00), (base + 1, 0x00)]);
        write_word(&mut chip, base + 4, 0x1122);
        write_word(&mut chip, base + 8, 0x3344);
        write(&mut chip, base + 5, 0x99);
        // Through TEMP the high byte of TCNT has not arrived, and OCRA is read without it.
        assert_eq!(count_of(&mut chip, base + 8), 0x3344);
        // The same TEMP for all: the next low byte takes 0x99 along, whatever register it is of.
        write(&mut chip, base + 10, 0x01);
        assert_eq!(count_of(&mut chip, base + 10), 0x9901);
        assert_eq!(count_of(&mut chip, base + 4), 0x1122);
        // Reading TCNT has put its high byte there.
        write(&mut chip, base + 8, 0x02);
        assert_eq!(count_of(&mut chip, base + 8), 0x1102);
    }
}

#[test]
fn reading_a_compare_register_leaves_what_was_latched() {
    for base in WIDE {
        let mut chip = at_rest(&[(base, 0x00), (base + 1, 0x00)]);
        write_word(&mut chip, base + 4, 0x1122);
        write_word(&mut chip, base + 8, 0x3344);
        assert_eq!(read(&mut chip, base + 4), 0x22);
        assert_eq!(read(&mut chip, base + 8), 0x44);
        assert_eq!(read(&mut chip, base + 9), 0x33);
        assert_eq!(read(&mut chip, base + 5), 0x11, "TCNT's high byte waits");
        // A write in between is what an interrupt routine does to a program that has not locked it out.
        assert_eq!(read(&mut chip, base + 4), 0x22);
        write_word(&mut chip, base + 8, 0x7788);
        assert_eq!(read(&mut chip, base + 5), 0x77);
    }
}

#[test]
fn a_running_counter_is_latched_at_its_low_byte() {
    for base in WIDE {
        let (mut chip, last) = set_up(&[(base + 1, 0x01)]);
        let cycle = last + 0x12FF;
        assert_eq!(read_at(&mut chip, base + 4, cycle), 0xFF);
        // A cycle on it is 0x1300.
        assert_eq!(read_at(&mut chip, base + 5, cycle + 1), 0x12);
        assert_eq!(read_at(&mut chip, base + 4, cycle + 1), 0x00);
    }
}

#[test]
fn the_timers_of_one_chip_have_a_temp_each() {
    let mut chip = at_rest(&[(0x80, 0)]);
    write(&mut chip, WIDE[0] + 5, 0x12);
    write(&mut chip, WIDE[1] + 5, 0x34);
    write(&mut chip, WIDE[0] + 4, 0x56);
    write(&mut chip, WIDE[1] + 4, 0x78);
    assert_eq!(count_of(&mut chip, WIDE[0] + 4), 0x1256);
    assert_eq!(count_of(&mut chip, WIDE[1] + 4), 0x3478);
}

/// Timers 0, 1 and 5 over 64, timer 2 over 32, all from 0 on: what they count after `cycles`, with what is done meanwhile.
fn counts(mut act: impl FnMut(&mut Chip, u64), cycles: u64) -> [u16; 4] {
    let mut chip = at_rest(&[(GTCCR, TSM | PSRSYNC | PSRASY)]);
    for (address, value) in [(0x45, 0x03), (0x81, 0x03), (0x121, 0x03), (0xB1, 0x03)] {
        write(&mut chip, address, value);
    }
    write(&mut chip, GTCCR, 0);
    let start = chip.cycle();
    act(&mut chip, start);
    let now = start + cycles;
    [
        u16::from(read_at(&mut chip, 0x46, now)),
        u16::from(read_at(&mut chip, 0x84, now)),
        u16::from(read_at(&mut chip, 0x124, now)),
        u16::from(read_at(&mut chip, 0xB2, now)),
    ]
}

fn run_to(chip: &mut Chip, cycle: u64) {
    chip.run_until(cycle);
    assert!(chip.cycle() < cycle + 2);
}

#[test]
fn released_together_the_timers_count_from_the_same_cycle() {
    let nothing = |_: &mut Chip, _: u64| {};
    assert_eq!(counts(nothing, 63), [0, 0, 0, 1]);
    assert_eq!(counts(nothing, 64), [1, 1, 1, 2]);
    assert_eq!(counts(nothing, 64 * 10 - 1), [9, 9, 9, 19]);
}

#[test]
fn each_reset_bit_is_its_own_prescaler_s() {
    for (bits, counted) in [
        // Both run on: 1,000 cycles are 15 ticks of 64 and 31 of 32.
        (0, [15, 15, 15, 31]),
        // 250 cycles, then from 0 again: 3 and 11 (750 / 64) ticks; 7 and 23 (750 / 32).
        (PSRSYNC, [14, 14, 14, 31]),
        (PSRASY, [15, 15, 15, 30]),
        (PSRSYNC | PSRASY, [14, 14, 14, 30]),
    ] {
        let reset = |chip: &mut Chip, start: u64| {
            run_to(chip, start + 250);
            write(chip, GTCCR, bits);
            assert_eq!(read(chip, GTCCR), 0, "the bits clear themselves");
        };
        assert_eq!(counts(reset, 1_000), counted, "{bits:#x}");
    }
}

#[test]
fn tsm_holds_the_prescalers_whose_bit_is_set_until_it_is_cleared() {
    for (bits, counted) in [
        (PSRSYNC, [3 + 6, 3 + 6, 3 + 6, 31]),
        (PSRASY, [15, 15, 15, 7 + 13]),
        (PSRSYNC | PSRASY, [9, 9, 9, 20]),
        // TSM alone holds nothing.
        (0, [15, 15, 15, 31]),
    ] {
        let hold = |chip: &mut Chip, start: u64| {
            run_to(chip, start + 250);
            write(chip, GTCCR, TSM | bits);
            let held = if bits == 0 { 0 } else { TSM | bits };
            assert_eq!(read(chip, GTCCR), held);
            run_to(chip, start + 570);
            write(chip, GTCCR, 0);
        };
        // 250 cycles counted, 320 held, 430 counted from 0 on.
        assert_eq!(counts(hold, 1_000), counted, "{bits:#x}");
    }
}

#[test]
fn a_timer_without_a_prescaler_stands_as_long_as_it_is_held() {
    let (mut chip, last) = set_up(&[(0x81, 0x01)]);
    chip.run_until(200);
    let held = chip.cycle();
    write(&mut chip, GTCCR, TSM | PSRSYNC);
    let count = held - last;
    for later in [1, 10, 500] {
        let now = held + later;
        let low = read_at(&mut chip, 0x84, now);
        assert_eq!(u64::from(low), count & 0xFF, "{later}");
    }
}
