//! What the ATmega328P of an Uno has elsewhere than the ATmega2560, or not at all (DS40002061B).
#![cfg(test)]

use crate::common;
use common::*;
use rumbo_emulator::chip::Chip;
use rumbo_emulator::devices::Input;
use rumbo_emulator::io::Io;
use rumbo_emulator::model::{ATMEGA328P, ATMEGA2560};

const DDRB: u16 = 0x24;
const DDRD: u16 = 0x2A;

fn uno(writes: &[(u16, u8)]) -> Chip {
    let (mut chip, done) = set_up_on(&ATMEGA328P, writes);
    chip.run_until(done + 1);
    chip
}

#[test]
fn each_pwm_output_has_its_pin_frequency_and_share() {
    // Timer's control A and B, compare register and its value: analogWrite(pin, 128).
    for (output, direction, [a, b, compare], control) in [
        (pin('D', 6), (DDRD, 0x40), [0x44, 0x45, 0x47], (0x83, 3)),
        (pin('D', 5), (DDRD, 0x20), [0x44, 0x45, 0x48], (0x23, 3)),
        (pin('B', 1), (DDRB, 0x02), [0x80, 0x81, 0x88], (0x81, 3)),
        (pin('B', 2), (DDRB, 0x04), [0x80, 0x81, 0x8A], (0x21, 3)),
        (pin('B', 3), (DDRB, 0x08), [0xB0, 0xB1, 0xB3], (0x83, 4)),
        (pin('D', 3), (DDRD, 0x08), [0xB0, 0xB1, 0xB4], (0x23, 4)),
    ] {
        let mut chip = uno(&[direction, (compare, 128), (a, control.0), (b, control.1)]);
        chip.run_until(200_000);
        let edges = edges(&mut chip, output);
        let rises: Vec<u64> = edges
            .iter()
            .filter(|(_, high)| *high)
            .map(|(at, _)| *at)
            .collect();
        let [.., before, last] = rises[..] else {
            panic!("{output}: {edges:?}");
        };
        let fall = edges
            .iter()
            .find(|(at, high)| !high && *at > before)
            .unwrap()
            .0;
        // 976.6 Hz from the fast timers, 490.2 Hz from the phase-correct one.
        let (period, high) = if a == 0x80 {
            (510 * 64, 2 * 128 * 64)
        } else {
            (256 * 64, 129 * 64)
        };
        assert_eq!((last - before, fall - before), (period, high), "{output}");
    }
}

#[test]
fn timers_count_and_capture_edges_of_their_own_pins() {
    // Timer 0 by T0 on PD4, timer 1 by T1 on PD5: rising edges.
    for (control, count, clock) in [(0x45, 0x46, pin('D', 4)), (0x81, 0x84, pin('D', 5))] {
        let mut chip = uno(&[(control, 7)]);
        for edge in 0..6 {
            chip.input(100 + 50 * edge, Input::Pin(clock, Some(edge % 2 == 0)));
        }
        chip.run_until(1_000);
        assert_eq!(read(&mut chip, count), 3, "{clock}");
    }
    // ICP1 on PB0, rising, with the CPU's clock.
    let mut chip = uno(&[(0x81, 0x41)]);
    chip.input(500, Input::Pin(pin('B', 0), Some(true)));
    chip.run_until(1_000);
    assert_eq!(read(&mut chip, 0x36) & 0x20, 0x20);
    let (captured, now) = (count_of(&mut chip, 0x86), count_of(&mut chip, 0x84));
    let since = chip.cpu().cycle() - 500;
    assert_eq!(u64::from(now - captured), since);
}

#[test]
fn pins_request_their_interrupts() {
    for (writes, changes, name) in [
        ([(0x69, 0x03), (0x3D, 1)], pin('D', 2), "INT0"),
        ([(0x69, 0x0C), (0x3D, 2)], pin('D', 3), "INT1"),
        ([(0x68, 1), (0x6B, 0x20)], pin('B', 5), "PCINT0"),
        ([(0x68, 2), (0x6C, 0x20)], pin('C', 5), "PCINT1"),
        ([(0x68, 4), (0x6D, 0x80)], pin('D', 7), "PCINT2"),
    ] {
        let mut chip = uno(&writes);
        assert_eq!(chip.devices().pending(), None);
        chip.input(100, Input::Pin(changes, Some(true)));
        chip.run_until(200);
        let pending = chip.devices().pending().unwrap();
        assert_eq!(ATMEGA328P.vector_name(pending), name);
    }
    // There is no INT2.
    let mut chip = uno(&[(0x3D, 0xFF), (0x69, 0xFF)]);
    assert_eq!(read(&mut chip, 0x3D), 3);
}

#[test]
fn short_addresses_take_two_bytes_of_stack_and_a_cycle_less() {
    // RCALL over two words to RET: each way a cycle less than on a Mega; and an interrupt, of a low level on INT0.
    let calls = [0xD001, 0xCFFF, 0x9508];
    let level = [
        [ldi(16, 1), out(0x1D, 16), SEI, NOP, NOP].as_slice(),
        &[0xCFFF],
    ]
    .concat();
    for (model, bytes) in [(&ATMEGA2560, 3), (&ATMEGA328P, 2)] {
        let mut chip = chip_on(model, &calls);
        chip.step();
        assert_eq!(model.ram_end - chip.cpu().stack_pointer(), bytes);
        assert_eq!(chip.cycle(), u64::from(bytes) + 1);
        chip.step();
        assert_eq!(
            (chip.cycle(), chip.cpu().program_counter()),
            (2 * u64::from(bytes) + 3, 1)
        );
        let mut chip = chip_on(model, &level);
        for _ in 0..4 {
            chip.step();
        }
        // SEI's shadow is over; now the interrupt.
        let before = chip.cycle();
        chip.step();
        assert_eq!(model.ram_end - chip.cpu().stack_pointer(), bytes);
        assert_eq!(chip.cpu().program_counter(), 2);
        assert_eq!(chip.cycle() - before, u64::from(bytes) + 2);
    }
}

#[test]
fn the_program_counter_wraps_at_16_k_words() {
    // RJMP -2 from 0 leads to the last word, NOP, behind which is 0 again.
    let mut words = vec![0xCFFE];
    words.resize(0x3FFF, NOP);
    words.push(NOP);
    let mut chip = chip_on(&ATMEGA328P, &words);
    // Not in the boot section, which is not blank.
    chip.cpu_mut().set_program_counter(0);
    let mut places = Vec::new();
    for _ in 0..4 {
        chip.step();
        places.push(chip.cpu().program_counter());
    }
    assert_eq!(places, [0x3FFF, 0, 0x3FFF, 0]);
}

#[test]
fn what_only_the_larger_chip_has_is_not_there() {
    // PORTA, UCSR1A, TCCR3A, RAMPZ, and behind the SRAM's end.
    for address in [0x22, 0xC8, 0x90, 0x5B, 0x900] {
        let chip = uno(&[(address, 0xFF)]);
        let strange: Vec<u16> = chip
            .unmodelled()
            .iter()
            .map(|access| access.address)
            .collect();
        assert_eq!(strange, [address]);
    }
    assert!(uno(&[(0x100, 1), (0x8FF, 1)]).unmodelled().is_empty());
    // ELPM and EIJMP are no instructions.
    for word in [0x95D8, 0x9006, 0x9419, 0x9519] {
        let mut chip = chip_on(&ATMEGA328P, &[word]);
        chip.run_until(100);
        assert!(chip.cpu().verdict().is_some(), "{word:#x}");
    }
}

#[test]
fn the_eeprom_has_1_kb() {
    let mut chip = uno(&[(0x42, 0xFF), (0x41, 0xFE)]);
    assert_eq!(read(&mut chip, 0x42), 0x03);
    assert_eq!(chip.devices().eeprom().len(), 0x400);
}

#[test]
fn analog_inputs_are_on_port_c_and_one_is_the_temperature() {
    let convert = |admux: u8| {
        let mut chip = uno(&[(0x7C, admux), (0x7A, 0xC7)]);
        chip.input(
            0,
            Input::Volts {
                channel: 5,
                volts: 0.55,
            },
        );
        chip.run_until(10_000);
        count_of(&mut chip, 0x78)
    };
    // Against 1.1 V; against the supply; 1.1 V itself; ground; the sensor at 25 degrees.
    assert_eq!(convert(0xC5), 512);
    assert_eq!(convert(0x45), 112);
    assert_eq!(convert(0x4E), 225);
    assert_eq!(convert(0x4F), 0);
    assert_eq!(convert(0xC8), 292);
    let mut chip = uno(&[(0x7E, 0x20)]);
    chip.input(0, Input::Pin(pin('C', 5), Some(true)));
    chip.run_until(100);
    assert_eq!(read(&mut chip, 0x26) & 0x20, 0, "its digital input is off");
}

#[test]
fn the_buses_are_on_their_own_pins() {
    // SPI as master, a byte of ones and zeros: SCK on PB5, MOSI on PB3.
    let mut chip = uno(&[(DDRB, 0x2C), (0x4C, 0x50), (0x4E, 0xAA)]);
    chip.run_until(1_000);
    let clock = edges(&mut chip.clone(), pin('B', 5));
    assert_eq!(clock.iter().filter(|(_, high)| *high).count(), 8);
    assert!(edges(&mut chip, pin('B', 3)).len() >= 8);
    // TWI's start: SDA on PC4 goes down, then SCL on PC5.
    let mut chip = uno(&[(0xB8, 72), (0xBC, 0xA4)]);
    chip.run_until(1_000);
    let sda = edges(&mut chip.clone(), pin('C', 4));
    let scl = edges(&mut chip, pin('C', 5));
    assert!(sda[0].0 < scl[0].0 && !sda[0].1 && !scl[0].1);
}

#[test]
fn a_byte_comes_in_on_pd0_and_goes_out_on_pd1() {
    // 38,400 baud: UBRR 25.
    let mut chip = uno(&[(0xC4, 25), (0xC1, 0x18), (0xC6, 0x55)]);
    chip.input(
        100,
        Input::Serial {
            usart: 0,
            byte: 0xA7,
            baud: 38_400,
        },
    );
    chip.run_until(10_000);
    assert_eq!(read(&mut chip, 0xC6), 0xA7);
    assert!(edges(&mut chip, pin('D', 1)).len() >= 9);
}

#[test]
fn a_program_reads_its_signature() {
    // SIGRD and SPMEN into SPMCSR, LPM r17, Z at 0, 2 and 4; to SRAM.
    let mut words = vec![ldi(16, 0x21), ldi(31, 0)];
    for index in 0..3 {
        words.extend([ldi(30, 2 * index), out(0x37, 16), 0x9114]);
        words.extend(sts(0x100 + u16::from(index), 17));
    }
    words.push(0xCFFF);
    let mut chip = chip_on(&ATMEGA328P, &words);
    chip.run_until(200);
    assert_eq!(chip.cpu().sram()[..3], ATMEGA328P.signature);
}
