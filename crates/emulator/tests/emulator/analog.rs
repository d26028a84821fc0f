//! The analog-to-digital converter and the comparator of the whole chip, with exact cycles (2549Q, sections 25 and 26; ADCSRA on page 285, triggers on page 287).
#![cfg(test)]

use crate::common;
use common::*;
use rumbo_emulator::chip::Chip;
use rumbo_emulator::devices::Input;

const ACSR: u16 = 0x50;
const ADCL: u16 = 0x78;
const ADCH: u16 = 0x79;
const ADCSRA: u16 = 0x7A;
const ADCSRB: u16 = 0x7B;
const ADMUX: u16 = 0x7C;

/// ADEN, and the slowest clock.
const ON: u8 = 0x87;
const ADSC: u8 = 0x40;
const ADATE: u8 = 0x20;
const ADIF: u8 = 0x10;

/// Against AVCC, switched on; with the cycle in which that was, and some volts on three inputs.
fn switched_on(control: u8) -> (Chip, u64) {
    let (mut chip, on) = set_up(&[(ADMUX, 0x40), (ADCSRA, control)]);
    for (channel, volts) in [(0, 2.5), (1, 1.25), (9, 5.0)] {
        chip.input(0, Input::Volts { channel, volts });
    }
    (chip, on)
}

fn result(chip: &mut Chip) -> u16 {
    count_of(chip, ADCL)
}

#[test]
fn the_first_conversion_takes_25_cycles_of_its_clock_and_the_others_13() {
    for (select, divisor) in [(7, 128), (4, 16), (0, 2)] {
        let (mut chip, on) = switched_on(0x80 | select);
        chip.run_until(1_001);
        let mut cycle = chip.cpu().cycle();
        for cycles in [25, 13, 13] {
            write(&mut chip, ADCSRA, 0x80 | select | ADSC);
            let start = on + (cycle + 1 - on).div_ceil(divisor) * divisor;
            let end = start + cycles * divisor;
            assert_eq!(read_at(&mut chip, ADCSRA, end - 1) & (ADSC | ADIF), ADSC);
            assert_eq!(read_at(&mut chip, ADCSRA, end) & (ADSC | ADIF), ADIF);
            assert_eq!(result(&mut chip), 512);
            write(&mut chip, ADCSRA, 0x80 | select | ADIF);
            assert_eq!(read(&mut chip, ADCSRA) & ADIF, 0, "a one clears it");
            cycle = chip.cpu().cycle();
        }
    }
}

#[test]
fn the_input_is_what_it_was_at_the_sample() {
    let (mut chip, on) = switched_on(ON);
    chip.run_until(on + 10);
    write(&mut chip, ADCSRA, ON | ADSC);
    // The clock after next, 13.5 cycles.
    let sample = on + 128 + 27 * 64;
    for (cycle, volts) in [(sample - 1, 1.0), (sample + 1, 4.0)] {
        chip.input(cycle, Input::Volts { channel: 0, volts });
    }
    chip.run_until(on + 128 * 27);
    assert_eq!(result(&mut chip), 204);
}

#[test]
fn channels_are_taken_over_at_the_start_and_results_can_be_adjusted() {
    let (mut chip, _) = switched_on(ON);
    chip.run_until(100);
    write(&mut chip, ADCSRA, ON | ADSC);
    write(&mut chip, ADMUX, 0x41);
    chip.run_until(5_000);
    assert_eq!(result(&mut chip), 512);
    write(&mut chip, ADMUX, 0x61);
    write(&mut chip, ADCSRA, ON | ADSC);
    chip.run_until(10_000);
    assert_eq!(read(&mut chip, ADCH), 64, "left: the upper eight bits");
    write(&mut chip, ADMUX, 0x41);
    write(&mut chip, ADCSRB, 0x08);
    write(&mut chip, ADCSRA, ON | ADSC);
    chip.run_until(15_000);
    assert_eq!(result(&mut chip), 1023, "MUX5: ADC9");
}

#[test]
fn a_result_half_read_is_not_replaced() {
    let (mut chip, _) = switched_on(ON | ADSC);
    chip.run_until(5_000);
    assert_eq!(read(&mut chip, ADCL), 0);
    write(&mut chip, ADMUX, 0x41);
    write(&mut chip, ADCSRA, ON | ADSC);
    chip.run_until(10_000);
    assert_eq!(read(&mut chip, ADCH), 2);
    assert_eq!(result(&mut chip), 512, "the other is lost");
}

#[test]
fn running_freely_one_conversion_follows_the_other() {
    // Vector 29 counts in r20.
    let mut words = vec![NOP; 0x90];
    words[..2].copy_from_slice(&[0x940C, 0x90]);
    words[58..60].copy_from_slice(&[0x940C, 0x80]);
    words[0x80..0x82].copy_from_slice(&[0x9543, RETI]);
    words.push(ldi(16, 0xEC));
    words.extend(sts(ADCSRA, 16));
    words.extend([SEI, 0xCFFF]);
    let mut chip = chip_of(&words);
    // Over 16: the first after 26 of its cycles, then each after 13.
    let on = 3 + 1 + 1;
    chip.run_until(on + 16 * (26 + 13 * 9) + 30);
    assert_eq!(chip.cpu().registers()[20], 10);
}

#[test]
fn a_timer_s_flag_starts_a_conversion() {
    // Timer 0 in mode 2 up to 249 over 64: a compare match every 16,000 cycles.
    let (mut chip, on) = set_up(&[
        (ADMUX, 0x40),
        (ADCSRA, ON),
        (0x44, 0x02),
        (0x47, 249),
        (0x45, 0x03),
    ]);
    let _ = on;
    chip.run_until(100);
    // One by hand, which is the long one.
    write(&mut chip, ADCSRA, ON | ADSC);
    chip.run_until(5_000);
    write(&mut chip, ADCSRB, 0x03);
    write(&mut chip, ADCSRA, ON | ADATE | ADIF);
    let end = 16_000 + 3 + 13 * 128 + 64;
    assert_eq!(read_at(&mut chip, ADCSRA, end - 1) & ADIF, 0);
    assert_eq!(read_at(&mut chip, ADCSRA, end) & ADIF, ADIF);
    // Without clearing the timer's flag nothing follows.
    write(&mut chip, ADCSRA, ON | ADATE | ADIF);
    assert_eq!(read_at(&mut chip, ADCSRA, end + 32_000) & ADIF, 0);
    write(&mut chip, 0x35, 0x02);
    assert_eq!(read_at(&mut chip, ADCSRA, end + 48_000) & ADIF, ADIF);
}

#[test]
fn an_edge_on_int0_starts_a_conversion() {
    let (mut chip, _) = switched_on(ON | ADSC);
    chip.run_until(5_000);
    write(&mut chip, 0x69, 0x03);
    write(&mut chip, ADCSRB, 0x02);
    write(&mut chip, ADCSRA, ON | ADATE | ADIF);
    chip.input(6_000, Input::Pin(pin('D', 0), Some(true)));
    let end = 6_000 + 3 + 13 * 128 + 64;
    assert_eq!(read_at(&mut chip, ADCSRA, end - 1) & ADIF, 0);
    assert_eq!(read_at(&mut chip, ADCSRA, end) & ADIF, ADIF);
}

#[test]
fn the_comparator_compares_its_pins() {
    let (mut chip, _) = set_up(&[(ACSR, 0x03)]);
    chip.input(100, Input::Pin(pin('E', 2), Some(true)));
    assert_eq!(read_at(&mut chip, ACSR, 99), 0x03);
    assert_eq!(read_at(&mut chip, ACSR, 100), 0x33, "ACO and ACI on a rise");
    write(&mut chip, ACSR, 0x13);
    chip.input(200, Input::Pin(pin('E', 3), Some(true)));
    assert_eq!(read_at(&mut chip, ACSR, 200), 0x03, "and no fall");
    // The bandgap against ADC1.
    write(&mut chip, ADCSRB, 0x40);
    write(&mut chip, ADMUX, 1);
    write(&mut chip, ACSR, 0x43);
    assert_eq!(read(&mut chip, ACSR) & 0x20, 0x20);
    chip.input(
        300,
        Input::Volts {
            channel: 1,
            volts: 1.2,
        },
    );
    assert_eq!(read_at(&mut chip, ACSR, 300) & 0x20, 0);
}

#[test]
fn an_analog_pin_is_a_digital_one_too_unless_that_is_off() {
    let (mut chip, _) = switched_on(ON);
    chip.input(100, Input::Pin(pin('F', 2), Some(true)));
    chip.run_until(200);
    assert_eq!(read(&mut chip, 0x2F), 0x05, "PINF: 2.5 V count as high");
    write(&mut chip, ADMUX, 0x42);
    write(&mut chip, ADCSRA, ON | ADSC);
    write(&mut chip, 0x7E, 0x04);
    chip.run_until(5_000);
    assert_eq!(result(&mut chip), 1023);
    assert_eq!(read(&mut chip, 0x2F), 0x01);
}

const TCCR1B: u16 = 0x81;
const ICR1L: u16 = 0x86;
const TIFR1: u16 = 0x36;
const ICF: u8 = 0x20;

fn volts(chip: &mut Chip, cycle: u64, channel: u8, volts: f64) {
    chip.input(cycle, Input::Volts { channel, volts });
}

#[test]
fn the_comparator_captures_in_the_place_of_the_pin() {
    // Timer 1 over 1, on rising edges; ACIC.
    let (mut chip, _) = set_up(&[(ACSR, 0x04), (TCCR1B, 0x41)]);
    volts(&mut chip, 0, 18, 2.0);
    for (cycle, level) in [(100, 2.1), (200, 1.9), (300, 2.2)] {
        volts(&mut chip, cycle, 17, level);
    }
    // The pin itself is cut off.
    chip.input(250, Input::Pin(pin('D', 4), Some(true)));
    let started = 5;
    assert_eq!(read_at(&mut chip, TIFR1, 99) & ICF, 0);
    assert_eq!(read_at(&mut chip, TIFR1, 100) & ICF, ICF);
    assert_eq!(count_of(&mut chip, ICR1L), 100 - started);
    write(&mut chip, TIFR1, ICF);
    assert_eq!(read_at(&mut chip, TIFR1, 299) & ICF, 0, "not on the fall");
    assert_eq!(read_at(&mut chip, TIFR1, 300) & ICF, ICF);
    assert_eq!(count_of(&mut chip, ICR1L), 300 - started);
}

#[test]
fn the_noise_canceller_and_the_falling_edge_are_the_comparator_s_too() {
    let (mut chip, _) = set_up(&[(ACSR, 0x04), (TCCR1B, 0x81)]);
    volts(&mut chip, 0, 18, 2.0);
    volts(&mut chip, 50, 17, 3.0);
    for (cycle, level) in [(100, 1.0), (103, 3.0), (200, 1.0)] {
        volts(&mut chip, cycle, 17, level);
    }
    assert_eq!(
        read_at(&mut chip, TIFR1, 203) & ICF,
        0,
        "a dip of three cycles"
    );
    assert_eq!(read_at(&mut chip, TIFR1, 204) & ICF, ICF);
}

#[test]
fn the_bandgap_against_an_input_of_the_multiplexer_captures() {
    // ADC9 through MUX5; the comparator is high as long as it is below 1.1 V.
    let writes = [(ADCSRB, 0x48), (ADMUX, 0x01), (TCCR1B, 0x01), (ACSR, 0x44)];
    let (mut chip, last) = set_up(&writes);
    volts(&mut chip, 1_000, 9, 1.2);
    chip.run_until(500);
    // At the start the output was low: switching the source was a rise, which is not meant.
    assert_eq!(read(&mut chip, TIFR1) & ICF, 0);
    assert_eq!(read_at(&mut chip, TIFR1, 999) & ICF, 0);
    assert_eq!(read_at(&mut chip, TIFR1, 1_000) & ICF, ICF);
    assert_eq!(count_of(&mut chip, ICR1L), (1_000 - (last - 3)) as u16);
    // With the converter on, the multiplexer is its own: AIN1, at ground, is below the bandgap.
    write(&mut chip, ADCSRA, 0x80);
    assert_eq!(read(&mut chip, ACSR) & 0x20, 0x20);
}

#[test]
fn another_source_with_another_level_is_an_edge() {
    // The pin is high, the comparator low: on falling edges ACIC itself captures, and its end does not.
    let (mut chip, _) = set_up(&[(TCCR1B, 0x01)]);
    chip.input(0, Input::Pin(pin('D', 4), Some(true)));
    chip.run_until(50);
    write(&mut chip, ACSR, 0x04);
    assert_eq!(read(&mut chip, TIFR1) & ICF, ICF);
    write(&mut chip, TIFR1, ICF);
    write(&mut chip, ACSR, 0x00);
    assert_eq!(read(&mut chip, TIFR1) & ICF, 0);
}

#[test]
fn the_comparator_s_interrupt_has_its_senses() {
    // Toggle, falling, rising: vector 28 counts in r20 what six edges request.
    for (sense, expected) in [(0x08, 6), (0x0A, 3), (0x0B, 3)] {
        let mut words = vec![NOP; 0x90];
        words[..2].copy_from_slice(&[0x940C, 0x90]);
        words[56..58].copy_from_slice(&[0x940C, 0x80]);
        words[0x80..0x82].copy_from_slice(&[0x9543, RETI]);
        words.extend([ldi(16, sense), out(0x30, 16), SEI, 0xCFFF]);
        let mut chip = chip_of(&words);
        volts(&mut chip, 0, 18, 2.5);
        for edge in 0..6u64 {
            let level = if edge % 2 == 0 { 3.0 } else { 2.0 };
            volts(&mut chip, 100 + 50 * edge, 17, level);
        }
        chip.run_until(1_000);
        assert_eq!(chip.cpu().registers()[20], expected, "{sense:#x}");
    }
}

#[test]
fn the_comparator_sees_its_pins_also_where_their_digital_input_is_off() {
    let (mut chip, _) = set_up(&[(0x7F, 0x03)]);
    chip.input(0, Input::Pin(pin('E', 2), Some(true)));
    chip.run_until(100);
    assert_eq!(read(&mut chip, ACSR) & 0x20, 0x20);
    assert_eq!(read(&mut chip, 0x2C) & 0x04, 0, "PINE");
}

#[test]
fn a_pull_up_and_an_output_are_voltages_too() {
    let (mut chip, _) = switched_on(ON);
    chip.run_until(100);
    write(&mut chip, ADMUX, 0x43);
    let convert = |chip: &mut Chip| {
        write(chip, ADCSRA, ON | ADSC);
        let end = chip.cycle() + 5_000;
        chip.run_until(end);
        result(chip)
    };
    assert_eq!(convert(&mut chip), 0, "nothing connected");
    write(&mut chip, 0x31, 0x08);
    assert_eq!(convert(&mut chip), 1023, "PORTF: the pull-up");
    write(&mut chip, 0x30, 0x08);
    write(&mut chip, 0x31, 0x00);
    assert_eq!(convert(&mut chip), 0, "DDRF: a low output");
}
