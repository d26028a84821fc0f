//! The watchdog and resets of the whole chip, with exact cycles (2549Q, section 12).
#![cfg(test)]

use crate::common;
use common::*;
use rumbo_emulator::chip::Chip;
use rumbo_emulator::devices::ports::Drive;
use rumbo_emulator::devices::{Cause, Event, Input};

const WDTCSR: u16 = 0x60;
const MCUSR: u16 = 0x54;
const WDE: u8 = 0x08;
const WDIE: u8 = 0x40;
const WDCE: u8 = 0x10;
const WDIF: u8 = 0x80;

/// 2,048 cycles of 128 kHz.
const SHORTEST: u64 = 2_048 * 125;
/// From a reset to the first instruction.
const START: u64 = 14 + 65 * 16_000;

/// The causes of resets, with their cycles.
fn resets(chip: &mut Chip) -> Vec<(u64, Cause)> {
    let outputs = chip.take_outputs().into_iter();
    outputs
        .filter_map(|output| match output.event {
            Event::Reset(cause) => Some((output.cycle, cause)),
            _ => None,
        })
        .collect()
}

/// The timed sequence that sets WDTCSR to `value`, then waits; the second write acts in the cycle that is returned too.
fn with_watchdog(value: u8) -> (Chip, u64) {
    let mut words = vec![ldi(16, WDCE | WDE), ldi(17, value)];
    words.extend(sts(WDTCSR, 16));
    words.extend(sts(WDTCSR, 17));
    words.push(0xCFFF);
    (chip_of(&words), 5)
}

#[test]
fn each_prescaler_has_its_time() {
    for select in 0..10u8 {
        let value = WDE | select & 7 | (select & 8) << 2;
        // The first write of the sequence starts it.
        let (mut chip, second) = with_watchdog(value);
        let end = second - 2 + (SHORTEST << select);
        chip.run_until(end - 1);
        assert_eq!(resets(&mut chip), [], "{select}");
        chip.run_until(end + 10);
        assert_eq!(resets(&mut chip), [(end, Cause::Watchdog)], "{select}");
    }
}

#[test]
fn without_the_timed_sequence_it_is_neither_slowed_nor_stopped() {
    let (mut chip, _) = with_watchdog(WDE);
    chip.run_until(100);
    write(&mut chip, WDTCSR, 0x07);
    assert_eq!(read(&mut chip, WDTCSR), WDE);
    write(&mut chip, WDTCSR, WDCE | WDE);
    chip.run_until(110);
    write(&mut chip, WDTCSR, 0x07);
    assert_eq!(read(&mut chip, WDTCSR), WDE, "too late");
    write(&mut chip, WDTCSR, WDCE | WDE);
    write(&mut chip, WDTCSR, 0);
    assert_eq!(read(&mut chip, WDTCSR), 0);
    chip.run_until(1_000_000);
    assert_eq!(resets(&mut chip), []);
}

#[test]
fn the_timed_sequence_is_open_for_four_cycles() {
    let slowest = WDE | 0x21;
    for (nops, written) in [(0, slowest), (2, slowest), (3, WDE)] {
        let mut words = vec![ldi(16, WDCE | WDE), ldi(17, slowest)];
        words.extend(sts(WDTCSR, 16));
        words.extend(vec![0; nops]);
        words.extend(sts(WDTCSR, 17));
        words.push(0xCFFF);
        let mut chip = chip_of(&words);
        chip.run_until(100);
        assert_eq!(read(&mut chip, WDTCSR), written, "{nops}");
    }
}

#[test]
fn a_program_that_calls_wdr_goes_on() {
    let mut words = vec![ldi(16, WDE)];
    words.extend(sts(WDTCSR, 16));
    // WDR; RJMP back to it.
    words.extend([0x95A8, 0xCFFE]);
    let mut chip = chip_of(&words);
    chip.run_until(2_000_000);
    assert_eq!(resets(&mut chip), []);
}

#[test]
fn after_its_reset_everything_starts_over_but_memory_and_the_watchdog_stays_on() {
    // PB7 high, timer 1 on, a byte of SRAM; then the watchdog. A second start ends at once in a loop.
    let mut words = Vec::new();
    for (address, value) in [
        (0x24, 0x80),
        (0x25, 0x80),
        (0x81, 1),
        (0x300, 0x42),
        (WDTCSR, WDE),
    ] {
        words.push(ldi(16, value));
        words.extend(sts(address, 16));
    }
    words.push(0xCFFF);
    let mut chip = chip_of(&words);
    let end = 14 + SHORTEST;
    chip.run_until(end + 2);
    assert_eq!(resets(&mut chip), [(end, Cause::Watchdog)]);
    assert_eq!(chip.devices().drive(pin('B', 7)), Drive::Floating);
    assert_eq!(read_at(&mut chip, 0x81, end + START), 0);
    assert_eq!(read(&mut chip, MCUSR), 0x09, "power-on and watchdog");
    assert_eq!(read(&mut chip, WDTCSR), WDE, "held by WDRF");
    assert_eq!(chip.cpu().sram()[0x100], 0x42);
    assert!(chip.cpu().program_counter() < 3);
    write(&mut chip, WDTCSR, WDCE | WDE);
    write(&mut chip, WDTCSR, 0);
    assert_eq!(read(&mut chip, WDTCSR), WDE);
    write(&mut chip, MCUSR, 0);
    write(&mut chip, WDTCSR, WDCE | WDE);
    write(&mut chip, WDTCSR, 0);
    assert_eq!(read(&mut chip, WDTCSR), 0);
}

/// Vector 12 counts in r20; the watchdog in the mode `value`.
fn with_routine(value: u8) -> Chip {
    let mut words = vec![NOP; 0x90];
    words[..2].copy_from_slice(&[0x940C, 0x90]);
    words[24..26].copy_from_slice(&[0x940C, 0x80]);
    words[0x80..0x82].copy_from_slice(&[0x9543, RETI]);
    words.push(ldi(16, value));
    words.extend(sts(WDTCSR, 16));
    words.extend([SEI, 0xCFFF]);
    chip_of(&words)
}

#[test]
fn in_interrupt_mode_it_interrupts_for_ever() {
    let mut chip = with_routine(WDIE);
    chip.run_until(5 * SHORTEST + 100);
    assert_eq!(chip.cpu().registers()[20], 5);
    assert_eq!(resets(&mut chip), []);
    assert_eq!(read(&mut chip, WDTCSR), WDIE);
}

#[test]
fn in_both_modes_the_second_time_is_a_reset() {
    let mut chip = with_routine(WDIE | WDE);
    chip.run_until(SHORTEST + 100);
    assert_eq!(chip.cpu().registers()[20], 1);
    assert_eq!(read(&mut chip, WDTCSR), WDE);
    chip.run_until(2 * SHORTEST + 100);
    assert_eq!(resets(&mut chip).len(), 1);
}

#[test]
fn an_interrupt_that_is_not_served_is_followed_by_the_reset() {
    let (mut chip, _) = with_watchdog(WDIE | WDE);
    chip.run_until(SHORTEST + 100);
    assert_eq!(read(&mut chip, WDTCSR), WDIF | WDIE | WDE);
    chip.run_until(2 * SHORTEST + 100);
    assert_eq!(resets(&mut chip).len(), 1);
}

#[test]
fn causes_of_resets_add_up_until_the_power_goes() {
    let (mut chip, _) = with_watchdog(0);
    for (cycle, cause, flags) in [
        (1_000, Cause::External, 0x03),
        (5_000_000, Cause::BrownOut, 0x07),
        (10_000_000, Cause::PowerOn, 0x01),
    ] {
        chip.input(cycle, Input::Reset(cause));
        chip.run_until(cycle + 10);
        assert_eq!(resets(&mut chip), [(cycle, cause)]);
        assert_eq!(read_at(&mut chip, MCUSR, cycle + START + 100), flags);
    }
}
