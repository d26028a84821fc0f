//! Sleep modes, power reduction and the clock's registers of the whole chip, with exact cycles (2549Q, sections 10 and 11).
#![cfg(test)]

use crate::common;
use common::*;
use rumbo_emulator::chip::Chip;
use rumbo_emulator::devices::{Event, Input};

const SMCR: u8 = 0x33;
const TCNT1L: u16 = 0x84;
/// Crystals need 16,384 cycles to start.
const CRYSTAL: u64 = 16_384;

/// A program that counts in timer 1 and sleeps in a mode for ever; INT0 (rising) and INT5 (rising) toggle PB7, the watchdog toggles PB6.
/// The timer starts in cycle `TIMER`.
fn sleeper(mode: u8) -> Chip {
    let mut words = vec![NOP; 0x90];
    words[..2].copy_from_slice(&[0x940C, 0x90]);
    for (vector, bit) in [(1, 7), (6, 7), (12, 6)] {
        let routine = 0x60 + 2 * vector;
        words[2 * vector..2 * vector + 2].copy_from_slice(&[0x940C, routine as u16]);
        words[routine..routine + 2].copy_from_slice(&[sbi(0x03, bit), RETI]);
    }
    words.extend([ldi(16, 0xC0), out(0x04, 16), ldi(16, 0x21), out(0x1D, 16)]);
    for (address, value) in [(0x69, 0x03), (0x6A, 0x0C), (0x81, 0x01)] {
        words.push(ldi(16, value));
        words.extend(sts(address, 16));
    }
    words.extend([ldi(16, mode << 1 | 1), out(SMCR, 16), SEI]);
    // SLEEP; RJMP to it.
    words.extend([SLEEP, 0xCFFE]);
    chip_of(&words)
}

/// JMP 3, four of 1, and the third STS acts in its second cycle.
const TIMER: u64 = 3 + 4 + 9 - 1;
/// LDI, OUT, SEI, and SLEEP's one.
const ASLEEP: u64 = TIMER + 1 + 3 + 1;

fn times(chip: &mut Chip, bit: u8) -> Vec<u64> {
    let edges = edges(chip, pin('B', bit));
    edges.into_iter().map(|(cycle, _)| cycle).skip(1).collect()
}

#[test]
fn each_mode_wakes_after_its_time() {
    for (mode, start) in [(0, 0), (1, 0), (2, CRYSTAL), (3, CRYSTAL), (6, 6), (7, 6)] {
        let mut chip = sleeper(mode);
        chip.input(5_000, Input::Pin(pin('D', 0), Some(true)));
        chip.run_until(40_000);
        assert_eq!(
            times(&mut chip, 7),
            [5_000 + start + 5 + 5 + 3 + 1],
            "mode {mode}"
        );
        assert!(chip.cpu().is_sleeping());
    }
}

#[test]
fn timers_stand_still_where_their_clock_does() {
    for (mode, runs) in [
        (0, true),
        (1, false),
        (2, false),
        (3, false),
        (6, false),
        (7, false),
    ] {
        let mut chip = sleeper(mode);
        chip.run_until(10_000);
        let expected = if runs {
            10_000 - TIMER
        } else {
            ASLEEP - 1 - TIMER
        };
        assert_eq!(
            u64::from(count_of(&mut chip, TCNT1L)),
            expected,
            "mode {mode}"
        );
        // Awake, it continues from there: entry, jump, SBI, RETI, RJMP and SLEEP again.
        chip.input(10_000, Input::Pin(pin('D', 0), Some(true)));
        chip.run_until(40_000);
        let awake = 5 + 5 + 3 + 2 + 5 + 2 + 1;
        let expected = if runs {
            40_000 - TIMER
        } else {
            expected + awake - 1
        };
        let count = u64::from(count_of(&mut chip, TCNT1L));
        assert!(
            count.abs_diff(expected) <= 1,
            "mode {mode}: {count} {expected}"
        );
    }
}

#[test]
fn edges_of_int4_to_int7_need_a_clock() {
    for (mode, seen) in [(0, 1), (1, 0), (2, 0)] {
        let mut chip = sleeper(mode);
        chip.input(5_000, Input::Pin(pin('E', 5), Some(true)));
        chip.run_until(40_000);
        assert_eq!(times(&mut chip, 7).len(), seen, "mode {mode}");
    }
}

#[test]
fn the_watchdog_wakes_from_power_down() {
    let mut chip = sleeper(2);
    chip.run_until(1_000);
    let now = chip.cpu().cycle();
    write(&mut chip, 0x60, 0x40);
    chip.run_until(400_000);
    assert_eq!(
        times(&mut chip, 6),
        [now + 256_000 + CRYSTAL + 5 + 5 + 3 + 1]
    );
}

#[test]
fn a_byte_on_its_way_waits_for_the_clock() {
    let mut chip = sleeper(6);
    chip.input(2_000, Input::Pin(pin('D', 0), Some(true)));
    // TXEN, then a byte at UBRR 0: 160 cycles, before the program sleeps.
    chip.run_until(TIMER + 1);
    write(&mut chip, 0xC1, 0x08);
    write(&mut chip, 0xC6, 0x55);
    chip.run_until(1_000);
    let sent = |chip: &mut Chip| {
        let outputs = chip.take_outputs().into_iter();
        outputs
            .filter(|output| matches!(output.event, Event::Byte { .. }))
            .count()
    };
    assert_eq!(sent(&mut chip), 0);
    chip.run_until(3_000);
    assert_eq!(sent(&mut chip), 0, "awake for 27 cycles only");
    for cycle in (4_000..12_000).step_by(1_000) {
        chip.input(cycle, Input::Pin(pin('D', 0), Some(false)));
        chip.input(cycle + 500, Input::Pin(pin('D', 0), Some(true)));
    }
    chip.run_until(13_000);
    assert_eq!(sent(&mut chip), 1);
}

#[test]
fn the_converter_goes_on_in_its_quiet_mode() {
    let mut chip = sleeper(1);
    chip.run_until(TIMER + 1);
    write(&mut chip, 0x7A, 0x84);
    chip.run_until(2_000);
    assert_eq!(
        read(&mut chip, 0x7A),
        0x94,
        "a conversion by falling asleep"
    );
}

#[test]
fn a_peripheral_without_its_clock_stands() {
    // PRTIM1.
    let (mut chip, start) = set_up(&[(0x81, 0x01)]);
    chip.run_until(1_001);
    let stopped = chip.cpu().cycle();
    write(&mut chip, 0x64, 0x08);
    chip.run_until(5_001);
    let again = chip.cpu().cycle();
    write(&mut chip, 0x64, 0);
    chip.run_until(6_001);
    let expected = stopped - start + chip.cpu().cycle() - again;
    assert_eq!(u64::from(count_of(&mut chip, TCNT1L)), expected);
}

#[test]
fn the_clock_s_prescaler_changes_in_its_timed_sequence_only() {
    let (mut chip, _) = set_up(&[(0x81, 0x01)]);
    chip.run_until(100);
    write(&mut chip, 0x61, 0x03);
    assert_eq!(read(&mut chip, 0x61), 0x00);
    write(&mut chip, 0x61, 0x80);
    assert_eq!(read(&mut chip, 0x61), 0x80);
    write(&mut chip, 0x61, 0x03);
    assert_eq!(read(&mut chip, 0x61), 0x03);
}

#[test]
fn a_divided_clock_slows_the_chip_and_not_what_is_around_it() {
    // CLKPR: over 8, in the second of two STS, cycle 5; then timer 1 on, OC1A toggling at each count of 100, a byte, and the watchdog.
    let mut words = vec![ldi(16, 0x80), ldi(17, 0x03)];
    words.extend(sts(0x61, 16));
    words.extend(sts(0x61, 17));
    for (address, value) in [
        (0x24, 0x20),
        (0x88, 99),
        (0x80, 0x40),
        (0x81, 0x09),
        (0xC1, 0x18),
        (0xC6, 0x55),
        (0x60, 0x08),
    ] {
        words.push(ldi(16, value));
        words.extend(sts(address, 16));
    }
    words.push(0xCFFF);
    let mut chip = chip_of(&words);
    // UBRR 0 over 16: 128 cycles of the crystal a bit.
    let serial = Input::Serial {
        usart: 0,
        byte: 0x69,
        baud: 125_000,
    };
    chip.input(20_000, serial);
    chip.run_until(60_000);
    assert!(chip.cycle().abs_diff(60_000) <= 16, "{}", chip.cycle());
    assert!(chip.cpu().cycle().abs_diff(60_000 / 8) <= 8);
    assert_eq!(read(&mut chip, 0xC6), 0x69);
    let mut snapshot = chip.clone();
    let outputs = snapshot.take_outputs();
    let sent = outputs.iter().find_map(|output| match output.event {
        Event::Byte { byte, baud, .. } => Some((byte, baud)),
        _ => None,
    });
    assert_eq!(sent, Some((0x55, 125_000.0)));
    let toggles = edges(&mut chip, pin('B', 5));
    assert!(
        toggles
            .windows(2)
            .skip(1)
            .all(|two| two[1].0 - two[0].0 == 800),
        "{toggles:?}"
    );
    // The watchdog was set in cycle 5 + 7 of 3 each, the one and the other of the CPU's.
    chip.run_until(300_000);
    let reset = chip
        .take_outputs()
        .into_iter()
        .find(|output| matches!(output.event, Event::Reset(_)));
    let started = 5 + 8 * 21;
    assert!(reset.unwrap().cycle.abs_diff(started + 256_000) <= 8);
    chip.run_until(1_400_000);
    assert_eq!(read(&mut chip, 0x61), 0x03, "set again by the program");
}

#[test]
fn a_line_that_falls_while_the_crystal_starts_does_not_stop_the_chip() {
    let mut chip = sleeper(2);
    write(&mut chip, 0xC1, 0x10);
    // Awake for longer than a frame of the fastest rate, in all.
    for round in 0..20 {
        for (after, level) in [(0, true), (50_000, false)] {
            let at = 1_000 + 100_000 * round + after;
            chip.input(at, Input::Pin(pin('D', 0), Some(level)));
        }
    }
    let last = 1_000 + 100_000 * 19;
    let (usart, byte, baud) = (0, 0x55, 1_000_000);
    chip.input(last + 5_000, Input::Serial { usart, byte, baud });
    chip.run_until(last + 90_000);
    assert!(chip.cpu().is_sleeping());
    assert!(chip.cycle() < last + 110_000);
}

#[test]
fn a_conversion_that_is_triggered_while_the_crystal_starts_waits_for_it() {
    let mut chip = sleeper(2);
    // The watchdog's interrupt after 2,048 of its cycles; the converter on INT0.
    for (address, value) in [(0x60, 0x40), (0x7B, 0x02), (0x7A, 0xA7)] {
        write(&mut chip, address, value);
    }
    let wake = 2_048 * 125;
    chip.input(wake + 5_000, Input::Pin(pin('D', 0), Some(true)));
    chip.run_until(wake + CRYSTAL + 10);
    assert_eq!(read(&mut chip, 0x7A) & 0x50, 0x40, "on its way");
}
