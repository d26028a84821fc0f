//! USARTs clocked by XCK, and as masters of SPI, with exact cycles of their edges (2549Q, sections 22.3.4 and 23).
#![cfg(test)]

use crate::common;
use common::*;
use rumbo_emulator::chip::Chip;
use rumbo_emulator::devices::ports::{Drive, Pin};
use rumbo_emulator::devices::{Event, Input, Output};

const DDRE: u16 = 0x2D;
const UCSR0A: u16 = 0xC0;
const UCSR0B: u16 = 0xC1;
const UCSR0C: u16 = 0xC2;
const UBRR0L: u16 = 0xC4;
const UDR0: u16 = 0xC6;

const RXC: u8 = 0x80;
const UDRE: u8 = 0x20;
const RECEIVE: u8 = 0x10;
const SEND: u8 = 0x08;
/// Synchronous, 8N1.
const SYNCHRONOUS: u8 = 0x46;
const UCPOL: u8 = 0x01;

fn clock() -> Pin {
    pin('E', 2)
}

/// Edges of a pin, bytes sent, each with its cycle.
type Seen = (Vec<(u64, bool)>, Vec<(u64, u16)>);

fn seen(chip: &mut Chip, wanted: Pin) -> Seen {
    let mut seen = (Vec::new(), Vec::new());
    for Output { cycle, event } in chip.take_outputs() {
        match event {
            Event::Pin(at, drive @ (Drive::High | Drive::Low)) if at == wanted => {
                seen.0.push((cycle, drive == Drive::High));
            }
            Event::Byte { byte, .. } => seen.1.push((cycle, byte)),
            _ => {}
        }
    }
    seen
}

/// USART0 with its clock on XCK, UBRR 15: 32 cycles a bit. With the cycle in which its clock starts.
fn master(control_c: u8, control_b: u8) -> (Chip, u64) {
    set_up(&[
        (DDRE, 0x04),
        (UCSR0C, control_c),
        (UCSR0B, control_b),
        (UBRR0L, 15),
    ])
}

#[test]
fn a_synchronous_master_s_clock_runs_at_half_the_generator_s_rate() {
    for (polarity, rises_first) in [(0, true), (UCPOL, false)] {
        let (mut chip, origin) = master(SYNCHRONOUS | polarity, SEND);
        chip.run_until(origin + 200);
        let (edges, _) = seen(&mut chip, clock());
        let from = edges.iter().filter(|(cycle, _)| *cycle > origin + 16);
        let expected: Vec<_> = (2..=12)
            .map(|half| (origin + 16 * half, (half % 2 == 0) == rises_first))
            .collect();
        assert_eq!(from.copied().collect::<Vec<_>>(), expected);
    }
}

#[test]
fn data_change_where_the_clock_rises_and_are_taken_where_it_falls() {
    let (mut chip, origin) = master(SYNCHRONOUS, SEND | RECEIVE);
    chip.run_until(origin + 10);
    chip.take_outputs();
    write(&mut chip, UDR0, 0x01);
    write(&mut chip, UDR0, 0xFF);
    // A byte 0x5A that comes in: its bits change where those that go out do.
    let start = origin + 32;
    for (bit, level) in (0..10).zip([
        false, false, true, false, true, true, false, true, false, true,
    ]) {
        let input = Input::Pin(pin('E', 0), Some(level));
        chip.input(start + 32 * bit + 8, input);
    }
    chip.run_until(start + 20 * 32 + 10);
    let (edges, bytes) = seen(&mut chip, pin('E', 1));
    let expected = [
        (0, false),
        (1, true),
        (2, false),
        (9, true),
        (10, false),
        (11, true),
    ];
    assert_eq!(
        edges,
        expected.map(|(bit, level)| (start + 32 * bit, level))
    );
    assert_eq!(bytes, [(start + 320, 0x01), (start + 640, 0xFF)]);
    assert_eq!(read(&mut chip, UDR0), 0x5A);
}

#[test]
fn a_byte_is_there_with_the_edge_that_takes_its_stop_bit() {
    let (mut chip, origin) = master(SYNCHRONOUS, RECEIVE);
    chip.input(origin + 40, Input::Pin(pin('E', 0), Some(false)));
    chip.input(origin + 40 + 32, Input::Pin(pin('E', 0), Some(true)));
    // The start bit is taken half a bit after origin + 32.
    let taken = origin + 48 + 9 * 32;
    assert_eq!(read_at(&mut chip, UCSR0A, taken - 1) & RXC, 0);
    assert_eq!(read_at(&mut chip, UCSR0A, taken) & RXC, RXC);
    assert_eq!(read(&mut chip, UDR0), 0xFF);
}

#[test]
fn with_xck_as_an_input_nothing_moves_without_edges_on_it() {
    for polarity in [0, UCPOL] {
        let (mut chip, _) = set_up(&[(UCSR0C, SYNCHRONOUS | polarity), (UCSR0B, SEND | RECEIVE)]);
        let idle = polarity != 0;
        chip.input(0, Input::Pin(clock(), Some(idle)));
        chip.run_until(100);
        write(&mut chip, UDR0, 0x42);
        write(&mut chip, UDR0, 0x43);
        chip.run_until(100_000);
        assert_eq!(read(&mut chip, UCSR0A) & UDRE, 0, "the buffer is full");
        chip.take_outputs();
        // Eleven periods of 100 cycles, and 0xA5 on RXD, set up before each second edge.
        let bits = 0b101_0100_1010_u32;
        for bit in 0..11u64 {
            let start = 100_000 + 100 * bit;
            let level = bits >> bit & 1 != 0;
            chip.input(start, Input::Pin(clock(), Some(!idle)));
            chip.input(start + 20, Input::Pin(pin('E', 0), Some(level)));
            chip.input(start + 50, Input::Pin(clock(), Some(idle)));
        }
        chip.run_until(102_000);
        let (edges, bytes) = seen(&mut chip, pin('E', 1));
        let levels = [
            (0, false),
            (2, true),
            (3, false),
            (7, true),
            (8, false),
            (9, true),
            (10, false),
        ];
        let expected = levels.map(|(bit, level)| (100_000 + 100 * bit, level));
        assert_eq!(edges, expected, "0x42, then the start bit of 0x43");
        assert_eq!(bytes, [(101_000, 0x42)]);
        assert_eq!(read(&mut chip, UDR0), 0xA5);
    }
}

#[test]
fn as_a_master_of_spi_a_byte_comes_in_for_each_that_goes_out() {
    // UBRR 3: eight cycles a bit. MISO is high, then nobody drives it.
    let (mut chip, origin) = set_up(&[
        (DDRE, 0x04),
        (UCSR0C, 0xC0),
        (UCSR0B, RECEIVE | SEND),
        (UBRR0L, 3),
    ]);
    chip.input(0, Input::Pin(pin('E', 0), Some(true)));
    chip.run_until(100);
    let start = origin + (100 - origin).div_ceil(8) * 8;
    write(&mut chip, UDR0, 0x35);
    write(&mut chip, UDR0, 0x36);
    chip.input(start + 68, Input::Pin(pin('E', 0), Some(false)));
    chip.run_until(400);
    let (_, bytes) = seen(&mut chip, clock());
    assert_eq!(bytes, [(start + 64, 0x35), (start + 128, 0x36)]);
    for byte in [0xFF, 0x00] {
        assert_eq!(read(&mut chip, UCSR0A) & RXC, RXC);
        assert_eq!(read(&mut chip, UDR0), byte);
    }
    assert_eq!(read(&mut chip, UCSR0A) & RXC, 0);
}

#[test]
fn all_four_modes_of_spi_have_their_clock() {
    const UCPHA: u8 = 0x02;
    const UDORD: u8 = 0x04;
    for (mode, idle, leads_at) in [
        (0, false, 4),
        (UCPHA, false, 0),
        (UCPOL, true, 4),
        (UCPHA | UCPOL, true, 0),
    ] {
        for order in [0, UDORD] {
            let (mut chip, origin) = set_up(&[
                (DDRE, 0x04),
                (UCSR0C, 0xC0 | mode | order),
                (UCSR0B, RECEIVE | SEND),
                (UBRR0L, 3),
            ]);
            chip.run_until(100);
            assert_eq!(chip.devices().level(clock()), idle);
            chip.take_outputs();
            let start = origin + (100 - origin).div_ceil(8) * 8;
            write(&mut chip, UDR0, 0xC4);
            let mut snapshot = chip.clone();
            chip.run_until(400);
            let clocks = (0..8).flat_map(|bit| {
                let leading = start + 8 * bit + leads_at;
                [(leading, !idle), (leading + 4, idle)]
            });
            assert_eq!(seen(&mut chip, clock()).0, clocks.collect::<Vec<_>>());
            snapshot.run_until(400);
            let bits = [true, true, false, false, false, true, false, false];
            let sent = |bit: usize| bits[if order == 0 { bit } else { 7 - bit }];
            let changes = (0..8)
                .filter(|bit| match bit {
                    0 => !sent(0),
                    bit => sent(*bit) != sent(bit - 1),
                })
                .map(|bit| (start + 8 * bit as u64, sent(bit)));
            assert_eq!(
                seen(&mut snapshot, pin('E', 1)).0,
                changes.collect::<Vec<_>>()
            );
        }
    }
}

#[test]
fn each_usart_has_its_clock_pin() {
    for (base, letter, bit, direction) in [
        (0xC0, 'E', 2, DDRE),
        (0xC8, 'D', 5, 0x2A),
        (0xD0, 'H', 2, 0x101),
        (0x130, 'J', 2, 0x104),
    ] {
        let (mut chip, _) = set_up(&[
            (direction, 1 << bit),
            (base + 2, 0xC0),
            (base + 1, SEND),
            (base + 6, 0x55),
        ]);
        chip.run_until(100);
        let edges = seen(&mut chip, pin(letter, bit)).0;
        // One from the input that it was, and sixteen of the byte.
        assert_eq!(edges.len(), 17, "{base:#x}");
    }
}
