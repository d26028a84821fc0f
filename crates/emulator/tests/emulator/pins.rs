//! Pins, external interrupts and sleep of the whole chip, with exact cycles.
#![cfg(test)]

use crate::common;
use common::*;
use rumbo_emulator::chip::Chip;
use rumbo_emulator::cpu::Stopped;
use rumbo_emulator::devices::Input;

/// A chip with this program: INT0's routine toggles PB7 and returns; `main` starts at word 0x80.
fn chip(main: &[u16]) -> Chip {
    let mut words = vec![NOP; 0x80];
    words[..2].copy_from_slice(&[0x940C, 0x80]);
    words[2..4].copy_from_slice(&[0x940C, 0x40]);
    words[0x40..0x42].copy_from_slice(&[sbi(0x03, 7), RETI]);
    words.extend(main);
    chip_of(&words)
}

/// Rising edges on INT0, PB7 an output; then `rest`. The first instruction of `rest` runs in cycle 14.
fn with_int0(rest: &[u16]) -> Chip {
    let mut main = vec![ldi(16, 3)];
    main.extend(sts(0x69, 16));
    main.extend([ldi(16, 1), out(0x1D, 16), ldi(16, 0x80), out(0x04, 16)]);
    // JMP 3, LDI 1, STS 2, and four of 1: 10. Four more up to 14.
    main.extend([NOP; 3]);
    main.extend([SEI]);
    main.extend(rest);
    chip(&main)
}

/// The cycles in which PB7 went high or low, after it became an output.
fn toggles(chip: &mut Chip) -> Vec<u64> {
    let edges = edges(chip, pin('B', 7));
    edges.into_iter().map(|(cycle, _)| cycle).skip(1).collect()
}

const D0: char = 'D';

#[test]
fn an_edge_enters_its_routine_five_cycles_after_the_instruction_it_met() {
    let mut chip = with_int0(&[NOP; 200]);
    for cycle in [50, 100] {
        chip.input(cycle, Input::Pin(pin(D0, 0), Some(true)));
        chip.input(cycle + 20, Input::Pin(pin(D0, 0), Some(false)));
    }
    assert_eq!(chip.run_until(160), Stopped::Reached);
    // Entry 5, the jump in the table 3, and SBI acts in its second cycle.
    assert_eq!(toggles(&mut chip), [50 + 5 + 3 + 1, 100 + 5 + 3 + 1]);
    assert_eq!(chip.unmodelled(), []);
}

#[test]
fn a_flag_raised_while_disabled_is_served_when_it_is_enabled() {
    let mut main = vec![ldi(16, 3)];
    main.extend(sts(0x69, 16));
    main.extend([ldi(16, 0x80), out(0x04, 16), SEI]);
    main.extend([NOP; 50]);
    main.extend([ldi(16, 1), out(0x1D, 16)]);
    main.extend([NOP; 50]);
    let mut chip = chip(&main);
    chip.input(30, Input::Pin(pin(D0, 0), Some(true)));
    chip.run_until(120);
    // OUT EIMSK runs in cycle 3 + 1 + 2 + 3 + 50 + 1 = 60.
    assert_eq!(toggles(&mut chip), [61 + 5 + 3 + 1]);
}

#[test]
fn the_instruction_after_sei_runs_before_any_interrupt() {
    let mut main = vec![ldi(16, 3)];
    main.extend(sts(0x69, 16));
    main.extend([ldi(16, 1), out(0x1D, 16), ldi(16, 0x80), out(0x04, 16)]);
    main.extend([NOP; 20]);
    // Cycles 30 and 31 to 32: SBI PINB, 6 runs before the routine.
    main.extend([SEI, sbi(0x03, 7)]);
    main.extend([NOP; 50]);
    let mut chip = chip(&main);
    chip.input(15, Input::Pin(pin(D0, 0), Some(true)));
    chip.run_until(100);
    assert_eq!(toggles(&mut chip), [32, 33 + 5 + 3 + 1]);
}

#[test]
fn an_edge_wakes_from_sleep_in_five_cycles_more() {
    // SMCR: idle, enabled.
    let mut chip = with_int0(&[ldi(16, 1), out(0x33, 16), SLEEP, NOP, NOP, NOP, NOP]);
    chip.input(1_000, Input::Pin(pin(D0, 0), Some(true)));
    chip.run_until(500);
    assert!(chip.cpu().is_sleeping());
    assert_eq!(chip.cpu().cycle(), 500);
    chip.run_until(1_020);
    assert_eq!(toggles(&mut chip), [1_000 + 5 + 5 + 3 + 1]);
    assert!(!chip.cpu().is_sleeping());
}

#[test]
fn a_snapshot_goes_on_exactly_as_the_original() {
    let mut chip = with_int0(&[NOP; 400]);
    for n in 0..10 {
        chip.input(40 + 33 * n, Input::Pin(pin(D0, 0), Some(n % 2 == 0)));
    }
    chip.run_until(120);
    let mut snapshot = chip.clone();
    chip.run_until(400);
    for cycle in 121..=400 {
        snapshot.run_until(cycle);
    }
    assert_eq!(chip.take_outputs(), snapshot.take_outputs());
    assert_eq!(chip.cpu().registers(), snapshot.cpu().registers());
    assert_eq!(chip.cpu().cycle(), snapshot.cpu().cycle());
}

#[test]
fn a_run_pauses_after_the_instruction_that_drives_a_watched_pin() {
    let mut main = vec![ldi(16, 0x80), out(0x04, 16)];
    main.extend([NOP; 10]);
    main.extend([sbi(0x03, 6), sbi(0x03, 7), NOP, NOP, NOP]);
    let mut chip = chip(&main);
    chip.watch(&[pin('B', 7)]);
    // JMP 3, LDI 1; OUT makes it an output.
    assert_eq!(chip.run_until(100), Stopped::Output);
    assert_eq!(chip.cpu().cycle(), 5);
    // PB6 is no output and not watched; SBI PINB, 7 ends in cycle 5 + 10 + 2 + 2.
    assert_eq!(chip.run_until(100), Stopped::Output);
    assert_eq!(chip.cpu().cycle(), 19);
    assert_eq!(chip.run_until(21), Stopped::Reached);
}

#[test]
fn an_access_that_is_not_modelled_is_reported_once_with_its_location() {
    let mut main = Vec::from(sts(0x62, 16));
    main.extend(sts(0x62, 17));
    main.extend([NOP; 4]);
    let mut chip = chip(&main);
    chip.run_until(9);
    let [only] = chip.unmodelled() else {
        panic!("{:?}", chip.unmodelled())
    };
    assert_eq!(
        (only.address, only.program_counter, only.written),
        (0x62, 0x80, true)
    );
}
