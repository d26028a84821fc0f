//! The two-wire interface with the edges on its pins, with exact cycles (2549Q, section 24).
#![cfg(test)]

use crate::common;
use common::*;
use rumbo_emulator::chip::Chip;
use rumbo_emulator::devices::ports::{Drive, Pin};
use rumbo_emulator::devices::{Event, Input, Output, Reply, Transfer};

const TWBR: u16 = 0xB8;
const TWSR: u16 = 0xB9;
const TWAR: u16 = 0xBA;
const TWDR: u16 = 0xBB;
const TWCR: u16 = 0xBC;
const TWINT: u8 = 0x80;
const TWEA: u8 = 0x40;
const TWSTA: u8 = 0x20;
const TWSTO: u8 = 0x10;
const TWEN: u8 = 0x04;
/// Half a bit at 100 kHz, as the Arduino library sets it.
const HALF: u64 = 80;

fn scl() -> Pin {
    pin('D', 0)
}

fn sda() -> Pin {
    pin('D', 1)
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
fn a_program_that_wants_to_be_a_slave_is_reported() {
    let (mut chip, done) = set_up(&[(TWBR, 72), (TWAR, 0x10)]);
    chip.run_until(done + 1);
    let strange: Vec<u16> = chip
        .unmodelled()
        .iter()
        .map(|access| access.address)
        .collect();
    assert_eq!(strange, [TWAR]);
}

#[test]
fn nobody_answers_on_the_bus() {
    // 100 kHz as the Arduino library sets it: 160 cycles a bit.
    let (mut chip, _) = set_up(&[(TWBR, 72), (TWCR, TWEN)]);
    chip.run_until(100);
    assert_eq!(read(&mut chip, TWSR), 0xF8);
    assert_eq!(on_bus(&mut chip, 0x20), (160, 0x08));
    write(&mut chip, TWDR, 0x42);
    assert_eq!(on_bus(&mut chip, 0), (9 * 160, 0x20));
    assert_eq!(on_bus(&mut chip, 0), (9 * 160, 0x30));
    assert_eq!(on_bus(&mut chip, 0x20), (240, 0x10), "a repeated start");
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

/// When a line is pulled down or released, in half bits after `start`.
fn halves(chip: &Chip, line: Pin, start: u64) -> Vec<(u64, bool)> {
    let outputs = chip.clone().take_outputs().into_iter();
    outputs
        .filter_map(|Output { cycle, event }| match event {
            Event::Pin(at, drive) if at == line && cycle >= start => {
                assert_eq!((cycle - start) % HALF, 0);
                Some(((cycle - start) / HALF, drive != Drive::Low))
            }
            _ => None,
        })
        .collect()
}

fn at_100_khz() -> Chip {
    let (mut chip, _) = set_up(&[(TWBR, 72), (TWCR, TWEN)]);
    chip.run_until(100);
    chip
}

#[test]
fn start_address_and_stop_are_on_the_lines() {
    let mut chip = at_100_khz();
    let start = chip.cycle();
    write(&mut chip, TWCR, TWINT | TWEN | TWSTA);
    chip.run_until(start + 2 * HALF + 10);
    let after = chip.cycle();
    assert_eq!(halves(&chip, sda(), start), [(1, false)]);
    assert_eq!(halves(&chip, scl(), start), [(2, false)]);
    chip.run_until(after + 1_000);
    assert_eq!(
        halves(&chip, scl(), start).len(),
        1,
        "held low while TWINT is up"
    );
    chip.take_outputs();
    let start = chip.cycle();
    write(&mut chip, TWDR, 0x42);
    write(&mut chip, TWCR, TWINT | TWEN);
    chip.run_until(start + 18 * HALF + 10);
    let clocks: Vec<_> = (1..=18).map(|half| (half, half % 2 != 0)).collect();
    assert_eq!(halves(&chip, scl(), start), clocks);
    // 0100 0010, released for the acknowledgement.
    let bits = [(2, true), (4, false), (12, true), (14, false), (16, true)];
    assert_eq!(halves(&chip, sda(), start), bits);
    assert_eq!(read(&mut chip, TWSR), 0x20);
    chip.take_outputs();
    let start = chip.cycle();
    write(&mut chip, TWCR, TWINT | TWEN | TWSTO);
    chip.run_until(start + 10 * HALF);
    assert_eq!(halves(&chip, scl(), start), [(1, true)]);
    assert_eq!(halves(&chip, sda(), start), [(0, false), (2, true)]);
    assert_eq!(read(&mut chip, TWCR), TWEN);
}

#[test]
fn switched_off_in_the_middle_of_a_byte_it_lets_the_lines_go() {
    let mut chip = at_100_khz();
    on_bus(&mut chip, TWSTA);
    write(&mut chip, TWDR, 0x42);
    write(&mut chip, TWCR, TWINT | TWEN);
    let end = chip.cycle() + 500;
    chip.run_until(end);
    write(&mut chip, TWCR, 0);
    chip.run_until(end + 5_000);
    assert_eq!([read(&mut chip, TWCR), read(&mut chip, TWSR)], [0, 0xF8]);
    for line in [scl(), sda()] {
        assert_eq!(chip.devices().drive(line), Drive::Floating);
    }
}

#[test]
fn a_repeated_start_lets_both_lines_go_first() {
    let mut chip = at_100_khz();
    on_bus(&mut chip, TWSTA);
    chip.take_outputs();
    let start = chip.cycle();
    write(&mut chip, TWCR, TWINT | TWEN | TWSTA);
    chip.run_until(start + 10 * HALF);
    assert_eq!(halves(&chip, sda(), start), [(0, true), (2, false)]);
    assert_eq!(halves(&chip, scl(), start), [(1, true), (3, false)]);
    assert_eq!(read(&mut chip, TWSR), 0x10);
}

#[test]
fn a_bus_that_is_held_low_is_waited_for() {
    for line in [scl(), sda()] {
        let mut chip = at_100_khz();
        chip.input(150, Input::Pin(line, Some(false)));
        chip.run_until(200);
        write(&mut chip, TWCR, TWINT | TWEN | TWSTA);
        assert_eq!(read_at(&mut chip, TWCR, 100_000) & TWINT, 0);
        let free = chip.cycle() + 100;
        chip.input(free, Input::Pin(line, None));
        assert_eq!(read_at(&mut chip, TWCR, free + 2 * HALF - 1) & TWINT, 0);
        assert_eq!(read_at(&mut chip, TWCR, free + 2 * HALF) & TWINT, TWINT);
        assert_eq!(read(&mut chip, TWSR), 0x08);
    }
}

#[test]
fn a_clock_that_is_held_low_stretches_the_bit() {
    let mut chip = at_100_khz();
    on_bus(&mut chip, TWSTA);
    let start = chip.cycle();
    write(&mut chip, TWDR, 0x42);
    write(&mut chip, TWCR, TWINT | TWEN);
    // Held from the low half of the third bit, for 1000 cycles.
    chip.input(start + 4 * HALF + 10, Input::Pin(scl(), Some(false)));
    chip.input(start + 5 * HALF + 1_000, Input::Pin(scl(), None));
    let end = start + 18 * HALF + 1_000;
    assert_eq!(read_at(&mut chip, TWCR, end - 1) & TWINT, 0);
    assert_eq!(read_at(&mut chip, TWCR, end) & TWINT, TWINT);
}

/// SDA as another one drives it, by half bits after `start`.
fn answer(chip: &mut Chip, start: u64, levels: &[(u64, Option<bool>)]) {
    for (half, level) in levels {
        chip.input(start + half * HALF + 10, Input::Pin(sda(), *level));
    }
}

#[test]
fn somebody_who_acknowledges_can_be_written_to_and_read() {
    let mut chip = at_100_khz();
    on_bus(&mut chip, TWSTA);
    let ack = [(16, Some(false)), (18, None)];
    for (byte, status) in [(0x42, 0x18), (0x99, 0x28)] {
        let start = chip.cycle();
        write(&mut chip, TWDR, byte);
        answer(&mut chip, start, &ack);
        assert_eq!(on_bus(&mut chip, 0), (18 * HALF, status));
        chip.run_until(start + 19 * HALF);
    }
    assert_eq!(on_bus(&mut chip, TWSTA), (3 * HALF, 0x10));
    let start = chip.cycle();
    write(&mut chip, TWDR, 0x43);
    answer(&mut chip, start, &ack);
    assert_eq!(on_bus(&mut chip, 0), (18 * HALF, 0x40));
    chip.run_until(start + 19 * HALF);
    for (command, status, acknowledged) in [(TWEA, 0x50, true), (0, 0x58, false)] {
        // 0xA7, with the last bit released.
        let start = chip.cycle();
        let bits = [
            (0, None),
            (2, Some(false)),
            (4, None),
            (6, Some(false)),
            (10, None),
        ];
        answer(&mut chip, start, &bits);
        chip.take_outputs();
        assert_eq!(on_bus(&mut chip, command), (18 * HALF, status));
        assert_eq!(read(&mut chip, TWDR), 0xA7);
        // The acknowledgement, which is released with the next byte.
        let expected = if acknowledged { (16, false) } else { (0, true) };
        assert_eq!(halves(&chip, sda(), start), [expected]);
    }
}

#[test]
fn whoever_sends_a_zero_against_a_one_has_the_bus() {
    let mut chip = at_100_khz();
    on_bus(&mut chip, TWSTA);
    let start = chip.cycle();
    write(&mut chip, TWDR, 0x42);
    answer(&mut chip, start, &[(2, Some(false))]);
    // The second bit is a one: it is lost where SCL is released.
    assert_eq!(on_bus(&mut chip, 0), (3 * HALF, 0x38));
    assert_eq!(chip.devices().drive(sda()), Drive::Floating);
    assert_eq!(chip.devices().drive(scl()), Drive::Floating);
}

#[test]
fn a_device_is_told_of_each_byte_and_its_reply_is_on_the_lines() {
    let mut chip = at_100_khz();
    chip.watch_two_wire(true);
    let told = |chip: &mut Chip| {
        let outputs = chip.take_outputs().into_iter();
        let told = outputs.filter_map(|Output { event, .. }| match event {
            Event::TwoWire(transfer) => Some(transfer),
            _ => None,
        });
        told.collect::<Vec<_>>()
    };
    // What is written, what the device is told, what it replies, and the status.
    let ack = Some(Reply::Acknowledge);
    let bytes = [
        (0x42, Transfer::Address(0x42), ack, 0x18),
        (0x99, Transfer::Write(0x99), ack, 0x28),
        (0x98, Transfer::Write(0x98), None, 0x30),
    ];
    on_bus(&mut chip, TWSTA);
    for (byte, transfer, reply, status) in bytes {
        told(&mut chip);
        write(&mut chip, TWDR, byte);
        let start = chip.cpu().cycle();
        write(&mut chip, TWCR, TWINT | TWEN);
        assert_eq!(told(&mut chip), [transfer]);
        if let Some(reply) = reply {
            chip.input(start, Input::TwoWire(reply));
        }
        chip.record_levels();
        assert_eq!(read_at(&mut chip, TWCR, start + 18 * HALF) & TWINT, TWINT);
        assert_eq!(read(&mut chip, TWSR), status);
        let low = |at: u64| {
            let levels = chip.clone().take_levels().into_iter();
            let before =
                levels.filter(|level| level.pin == sda() && level.cycle <= start + at * HALF);
            before
                .max_by_key(|level| level.cycle)
                .is_some_and(|level| !level.high)
        };
        assert_eq!(low(17), reply.is_some());
        assert!(!low(19));
    }
    on_bus(&mut chip, TWSTA);
    write(&mut chip, TWDR, 0x43);
    write(&mut chip, TWCR, TWINT | TWEN);
    let start = chip.cycle();
    chip.input(start, Input::TwoWire(Reply::Acknowledge));
    read_at(&mut chip, TWCR, start + 20 * HALF);
    assert_eq!(read(&mut chip, TWSR), 0x40);
    told(&mut chip);
    for (reply, data, command, status) in [
        (Reply::Byte(0x35), 0x35, TWEA, 0x50),
        (Reply::Byte(0x80), 0x80, 0, 0x58),
    ] {
        write(&mut chip, TWCR, TWINT | TWEN | command);
        assert_eq!(told(&mut chip), [Transfer::Read]);
        let start = chip.cycle();
        chip.input(start, Input::TwoWire(reply));
        read_at(&mut chip, TWCR, start + 20 * HALF);
        assert_eq!(
            [read(&mut chip, TWDR), read(&mut chip, TWSR)],
            [data, status]
        );
    }
    assert!(chip.devices().level(sda()), "the device has let it go");
}
