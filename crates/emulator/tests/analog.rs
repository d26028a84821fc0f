//! The analog-to-digital converter and the comparator of the whole chip, with exact cycles (DS40002549, sections 25 and 26).
#![cfg(test)]

mod common;

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
