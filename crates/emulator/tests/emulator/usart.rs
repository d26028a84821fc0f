//! USARTs of the whole chip, with exact cycles (2549Q, section 22; the start of page 206, formats of page 221).
#![cfg(test)]

use crate::common;
use common::*;
use rumbo_emulator::chip::Chip;
use rumbo_emulator::devices::ports::Drive;
use rumbo_emulator::devices::{Event, Input, Output};

const UCSR0A: u16 = 0xC0;
const UCSR0B: u16 = 0xC1;
const UCSR0C: u16 = 0xC2;
const UBRR0L: u16 = 0xC4;
const UBRR0H: u16 = 0xC5;
const UDR0: u16 = 0xC6;

const RXC: u8 = 0x80;
const TXC: u8 = 0x40;
const UDRE: u8 = 0x20;
const FE: u8 = 0x10;
const DOR: u8 = 0x08;
const UPE: u8 = 0x04;
const U2X: u8 = 0x02;
const RECEIVE: u8 = 0x10;
const SEND: u8 = 0x08;

/// Bytes sent: when each ended, and what it was.
fn sent(chip: &mut Chip) -> Vec<(u64, u16, f64)> {
    chip.take_outputs()
        .into_iter()
        .filter_map(|Output { cycle, event }| match event {
            Event::Byte { byte, baud, .. } => Some((cycle, byte, baud)),
            _ => None,
        })
        .collect()
}

/// USART0 at double speed over 208, that is 9600 baud within 0.2 %; with the cycle in which its clock starts.
fn at_9600(control_b: u8) -> (Chip, u64) {
    let (chip, last) = set_up(&[(UCSR0A, U2X), (UCSR0B, control_b), (UBRR0L, 207)]);
    (chip, last)
}

fn serial(chip: &mut Chip, cycle: u64, byte: u8) {
    let input = Input::Serial {
        usart: 0,
        byte,
        baud: 9_600,
    };
    chip.input(cycle, input);
}

#[test]
fn a_byte_at_9600_baud_takes_16640_cycles() {
    let (mut chip, origin) = at_9600(SEND);
    chip.run_until(1_000);
    write(&mut chip, UDR0, b'A');
    assert_eq!(
        read(&mut chip, UCSR0A) & UDRE,
        UDRE,
        "on to the shift register"
    );
    write(&mut chip, UDR0, b'B');
    assert_eq!(read(&mut chip, UCSR0A) & UDRE, 0);
    chip.run_until(60_000);
    // The start bit begins with the next bit of the free-running clock.
    let first = origin + 1_664;
    let baud = 16e6 / 1_664.0;
    assert_eq!(
        sent(&mut chip),
        [(first + 16_640, 65, baud), (first + 2 * 16_640, 66, baud)]
    );
}

#[test]
fn every_frame_format_has_its_length() {
    // Data bits from 5 to 8, parity none, even, odd, one and two stop bits, normal and double speed; UBRR 1.
    for (size, parity, stop, double) in (0..4u8).flat_map(|size| {
        [0u8, 2, 3].into_iter().flat_map(move |parity| {
            [0u8, 1]
                .into_iter()
                .flat_map(move |stop| [0u8, U2X].map(|double| (size, parity, stop, double)))
        })
    }) {
        let format = parity << 4 | stop << 3 | size << 1;
        let (mut chip, _) = set_up(&[
            (UCSR0A, double),
            (UCSR0B, SEND),
            (UCSR0C, format),
            (UBRR0L, 1),
        ]);
        chip.run_until(100);
        write(&mut chip, UDR0, 0xFF);
        write(&mut chip, UDR0, 0x35);
        chip.run_until(2_000);
        let bits = 1 + 5 + u64::from(size) + u64::from(parity > 0) + 1 + u64::from(stop);
        let bit = if double != 0 { 16 } else { 32 };
        let times = sent(&mut chip);
        assert_eq!(times[1].0 - times[0].0, bits * bit, "format {format:#x}");
        assert_eq!(times[1].1, 0x35 & ((1 << (5 + size)) - 1));
    }
}

#[test]
fn a_frame_s_levels_are_on_the_pin() {
    // 8E2 over 16 and 1: 0x53 has an even number of ones.
    let (mut chip, _) = set_up(&[(UCSR0B, SEND), (UCSR0C, 0x2E), (UBRR0L, 0)]);
    chip.run_until(100);
    chip.take_outputs();
    write(&mut chip, UDR0, 0x53);
    chip.run_until(500);
    let edges = edges(&mut chip, pin('E', 1));
    let start = edges[0].0;
    // Start 0, then 1 1 0 0 1 0 1 0, parity 0, stop.
    let expected = [
        (0, false),
        (1, true),
        (3, false),
        (5, true),
        (6, false),
        (7, true),
        (8, false),
        (10, true),
    ];
    let expected: Vec<_> = expected.map(|(bit, high)| (start + 16 * bit, high)).into();
    assert_eq!(edges, expected);
}

#[test]
fn the_ninth_bit_is_taken_along() {
    let (mut chip, _) = set_up(&[(UCSR0B, SEND | 4), (UCSR0C, 0x06), (UBRR0L, 0)]);
    chip.run_until(100);
    write(&mut chip, UCSR0B, SEND | 4 | 1);
    write(&mut chip, UDR0, 0x42);
    write(&mut chip, UCSR0B, SEND | 4);
    write(&mut chip, UDR0, 0x43);
    chip.run_until(1_000);
    let bytes: Vec<u16> = sent(&mut chip).iter().map(|sent| sent.1).collect();
    assert_eq!(bytes, [0x142, 0x43]);
}

#[test]
fn a_byte_is_received_at_the_majority_of_its_stop_bit() {
    for (settings, divisor, per_bit, decided) in [(U2X, 207, 8, 6), (0, 103, 16, 10)] {
        let (mut chip, origin) =
            set_up(&[(UCSR0A, settings), (UCSR0B, RECEIVE), (UBRR0L, divisor)]);
        let tick = u64::from(divisor) + 1;
        serial(&mut chip, 10_000, 0xA5);
        let first = origin + (10_000 - origin).div_ceil(tick) * tick;
        let complete = first + (9 * per_bit + decided - 1) * tick;
        assert_eq!(read_at(&mut chip, UCSR0A, complete - 1) & RXC, 0);
        assert_eq!(read_at(&mut chip, UCSR0A, complete), RXC | UDRE | settings);
        assert_eq!(read(&mut chip, UDR0), 0xA5);
        assert_eq!(read(&mut chip, UCSR0A), UDRE | settings);
    }
}

#[test]
fn bytes_in_a_row_are_received_and_so_are_frames_of_other_formats() {
    let (mut chip, _) = at_9600(RECEIVE);
    for byte in 0..=255 {
        serial(&mut chip, 1_000, byte);
    }
    for byte in 0..=255u64 {
        chip.run_until(1_000 + (byte + 1) * 16_667);
        assert_eq!(u64::from(read(&mut chip, UDR0)), byte);
    }
    // 7E1: 0x45 has three ones.
    let (mut chip, _) = at_9600(RECEIVE);
    write(&mut chip, UCSR0C, 0x24);
    for (cycle, parity) in [(1_000, 1), (30_000, 0)] {
        let bits = 0x45 | parity << 7 | 1 << 8;
        chip.input(
            cycle,
            Input::Frame {
                usart: 0,
                bits,
                count: 9,
                baud: 9_600,
            },
        );
    }
    for (cycle, flags) in [(20_000, RXC), (50_000, RXC | UPE)] {
        assert_eq!(read_at(&mut chip, UCSR0A, cycle), flags | UDRE | U2X);
        assert_eq!(read(&mut chip, UDR0), 0x45);
    }
}

#[test]
fn a_low_stop_bit_is_a_frame_error_and_the_line_must_rise_before_the_next_frame() {
    let (mut chip, _) = at_9600(RECEIVE);
    // A break of 13 bits, then a byte.
    chip.input(
        1_000,
        Input::Frame {
            usart: 0,
            bits: 0,
            count: 12,
            baud: 9_600,
        },
    );
    serial(&mut chip, 40_000, 0x31);
    chip.run_until(80_000);
    assert_eq!(read(&mut chip, UCSR0A) & (RXC | FE | DOR), RXC | FE);
    assert_eq!(read(&mut chip, UDR0), 0);
    assert_eq!(read(&mut chip, UCSR0A) & (RXC | FE | DOR), RXC);
    assert_eq!(read(&mut chip, UDR0), 0x31);
    assert_eq!(read(&mut chip, UCSR0A) & RXC, 0);
}

#[test]
fn two_bytes_and_the_shift_register_hold_before_anything_is_lost() {
    let (mut chip, _) = at_9600(RECEIVE);
    (1..=3).for_each(|byte| serial(&mut chip, 1_000, byte));
    chip.run_until(60_000);
    for byte in 1..=3 {
        assert_eq!(read(&mut chip, UCSR0A) & (RXC | DOR), RXC);
        assert_eq!(read(&mut chip, UDR0), byte);
    }
    // The start bit of the fourth overwrites the third; the overrun is flagged before the next byte.
    (1..=4).for_each(|byte| serial(&mut chip, 60_000, byte));
    chip.run_until(140_000);
    for (byte, flags) in [(1, RXC), (2, RXC), (4, RXC | DOR)] {
        assert_eq!(read(&mut chip, UCSR0A) & (RXC | DOR), flags, "byte {byte}");
        assert_eq!(read(&mut chip, UDR0), byte);
    }
    assert_eq!(read(&mut chip, UCSR0A) & (RXC | DOR), 0);
}

#[test]
fn a_sender_within_the_tolerance_is_understood_and_one_beyond_is_not() {
    // Table 22-2: 95.36 to 104.58 % at normal speed with 8 bits; 96.00 to 103.90 % at double speed.
    for (settings, divisor, percent, understood) in [
        (0, 103, 95.5, true),
        (0, 103, 104.4, true),
        (0, 103, 94.5, false),
        (0, 103, 106.0, false),
        (U2X, 207, 96.2, true),
        (U2X, 207, 103.8, true),
        (U2X, 207, 94.5, false),
        (U2X, 207, 106.0, false),
    ] {
        let (mut chip, _) = set_up(&[(UCSR0A, settings), (UCSR0B, RECEIVE), (UBRR0L, divisor)]);
        let baud = (16e6 / 1_664.0 * percent / 100.0) as u32;
        let mut right = true;
        for phase in 0..20 {
            // The last data bit differs from both its neighbours.
            let start = 50_000 * (phase + 1) + 11 * phase;
            chip.input(
                start,
                Input::Serial {
                    usart: 0,
                    byte: 0x40,
                    baud,
                },
            );
            chip.run_until(start + 40_000);
            let flags = read(&mut chip, UCSR0A);
            right &= flags & (RXC | FE) == RXC && read(&mut chip, UDR0) == 0x40;
            // Whatever else came of it.
            (0..3).for_each(|_| {
                read(&mut chip, UDR0);
            });
        }
        assert_eq!(right, understood, "{percent} % at {settings}");
    }
}

#[test]
fn half_the_rate_is_a_frame_error() {
    let (mut chip, _) = at_9600(RECEIVE);
    chip.input(
        1_000,
        Input::Serial {
            usart: 0,
            byte: 0,
            baud: 4_800,
        },
    );
    chip.run_until(60_000);
    assert_eq!(read(&mut chip, UCSR0A) & (RXC | FE), RXC | FE);
}

#[test]
fn a_spike_is_no_start_bit() {
    let (mut chip, _) = at_9600(RECEIVE);
    chip.input(10, Input::Pin(pin('E', 0), Some(true)));
    chip.input(5_000, Input::Pin(pin('E', 0), Some(false)));
    chip.input(5_700, Input::Pin(pin('E', 0), Some(true)));
    serial(&mut chip, 6_500, 0x77);
    chip.run_until(30_000);
    assert_eq!(read(&mut chip, UCSR0A) & (RXC | FE), RXC);
    assert_eq!(read(&mut chip, UDR0), 0x77);
    assert_eq!(read(&mut chip, UCSR0A) & RXC, 0);
}

#[test]
fn a_multiprocessor_receiver_takes_addresses_only() {
    // 9 bits: MPCM is on.
    let (mut chip, _) = set_up(&[(UCSR0A, U2X | 1), (UCSR0B, RECEIVE | 4), (UBRR0L, 207)]);
    for bits in [0x211u16, 0x312, 0x213] {
        chip.input(
            1_000,
            Input::Frame {
                usart: 0,
                bits,
                count: 10,
                baud: 9_600,
            },
        );
    }
    chip.run_until(70_000);
    assert_eq!(read(&mut chip, UCSR0B) & 2, 2, "RXB8");
    assert_eq!(read(&mut chip, UDR0), 0x12);
    assert_eq!(read(&mut chip, UCSR0A) & RXC, 0);
}

#[test]
fn the_transmission_is_complete_when_nothing_follows() {
    let (mut chip, origin) = at_9600(SEND);
    chip.run_until(100);
    write(&mut chip, UDR0, 1);
    write(&mut chip, UDR0, 2);
    let end = origin + 1_664 + 2 * 16_640;
    assert_eq!(
        read_at(&mut chip, UCSR0A, end - 16_640) & (TXC | UDRE),
        UDRE
    );
    assert_eq!(read_at(&mut chip, UCSR0A, end - 1) & TXC, 0);
    assert_eq!(read_at(&mut chip, UCSR0A, end) & TXC, TXC);
    write(&mut chip, UCSR0A, TXC | U2X);
    assert_eq!(read(&mut chip, UCSR0A) & TXC, 0, "a one clears it");
}

#[test]
fn the_receiver_s_interrupt_lasts_until_the_byte_is_read() {
    // Vector 25 counts in r20, up to 3, then reads UDR0.
    let mut words = vec![NOP; 0x90];
    words[..2].copy_from_slice(&[0x940C, 0x90]);
    words[50..52].copy_from_slice(&[0x940C, 0x80]);
    // INC r20; CPI r20, 3; BRNE 2 on; LDS r21, UDR0; RETI.
    words[0x80..0x86].copy_from_slice(&[0x9543, 0x3043, 0xF411, 0x9150, UDR0, RETI]);
    for (address, value) in [(UCSR0A, U2X), (UBRR0L, 207), (UCSR0B, 0x90)] {
        words.push(ldi(16, value));
        words.extend(sts(address, 16));
    }
    words.extend([SEI, 0xCFFF]);
    let mut chip = chip_of(&words);
    serial(&mut chip, 1_000, 0x99);
    chip.run_until(40_000);
    let registers = chip.cpu().registers();
    assert_eq!((registers[20], registers[21]), (3, 0x99));
}

#[test]
fn an_empty_buffer_asks_for_the_next_byte_until_it_has_one() {
    // Vector 26 writes r20 to UDR0 and counts it up; after two bytes it disables itself.
    let mut words = vec![NOP; 0x90];
    words[..2].copy_from_slice(&[0x940C, 0x90]);
    words[52..54].copy_from_slice(&[0x940C, 0x80]);
    let [store, data] = sts(UDR0, 20);
    let [control, address] = sts(UCSR0B, 18);
    words[0x80..0x88]
        .copy_from_slice(&[store, data, 0x9543, 0x3042, 0xF411, control, address, RETI]);
    for (address, value) in [(UCSR0A, U2X), (UBRR0L, 207), (UCSR0B, 0x28)] {
        words.push(ldi(16, value));
        words.extend(sts(address, 16));
    }
    words.extend([ldi(18, SEND), SEI, 0xCFFF]);
    let mut chip = chip_of(&words);
    chip.run_until(60_000);
    let bytes: Vec<u16> = sent(&mut chip).iter().map(|sent| sent.1).collect();
    assert_eq!(bytes, [0, 1]);
}

#[test]
fn transmitter_and_receiver_take_their_pins_over() {
    // PE0 and PE1 are outputs, low; then both are enabled, then the transmitter is disabled in the middle of a byte.
    let (mut chip, _) = set_up(&[(0x2D, 0x03), (UCSR0A, U2X), (UBRR0L, 207)]);
    chip.run_until(100);
    let [receive, transmit] = [pin('E', 0), pin('E', 1)];
    write(&mut chip, UCSR0B, SEND | RECEIVE);
    assert_eq!(chip.devices().drive(transmit), Drive::High);
    assert_eq!(chip.devices().drive(receive), Drive::Floating);
    write(&mut chip, UDR0, 0);
    chip.run_until(5_000);
    write(&mut chip, UCSR0B, 0);
    chip.run_until(17_000);
    assert_eq!(sent(&mut chip), []);
    chip.run_until(20_000);
    assert_eq!(sent(&mut chip).len(), 1, "what was begun is finished");
    assert_eq!(chip.devices().drive(transmit), Drive::Low);
}

#[test]
fn a_new_rate_counts_from_its_writing() {
    let (mut chip, _) = at_9600(SEND);
    chip.run_until(100);
    write(&mut chip, UDR0, 0x55);
    chip.run_until(40_000);
    write(&mut chip, UBRR0H, 3);
    write(&mut chip, UBRR0L, 0x40);
    let written = chip.cpu().cycle();
    write(&mut chip, UDR0, 0x55);
    chip.run_until(140_000);
    let bit = 8 * (0x340 + 1);
    assert_eq!(
        sent(&mut chip)[1..],
        [(written + 11 * bit, 0x55, 16e6 / bit as f64)]
    );
}

#[test]
fn all_four_have_their_registers_pins_and_vectors() {
    for (usart, base, vector, port, bit) in [
        (0, 0xC0, 25, 'E', 0),
        (1, 0xC8, 36, 'D', 2),
        (2, 0xD0, 51, 'H', 0),
        (3, 0x130, 54, 'J', 0),
    ] {
        // The vector's routine reads UDR to r21.
        let mut words = vec![NOP; 0x90];
        words[..2].copy_from_slice(&[0x940C, 0x90]);
        words[2 * vector..2 * vector + 2].copy_from_slice(&[0x940C, 0x80]);
        words[0x80..0x83].copy_from_slice(&[0x9150, base + 6, RETI]);
        for (address, value) in [
            (base, U2X),
            (base + 4, 16),
            (base + 1, 0x98),
            (base + 6, 0x5A),
        ] {
            words.push(ldi(16, value));
            words.extend(sts(address, 16));
        }
        words.extend([SEI, 0xCFFF]);
        let mut chip = chip_of(&words);
        chip.input(
            500,
            Input::Serial {
                usart,
                byte: 0xC3,
                baud: 115_200,
            },
        );
        chip.run_until(3_000);
        assert_eq!(chip.cpu().registers()[21], 0xC3, "USART {usart}");
        let outputs = chip.take_outputs();
        let byte = |output: &Output| matches!(output.event, Event::Byte { usart: which, byte: 0x5A, .. } if which == usart);
        assert!(outputs.iter().any(byte), "{outputs:?}");
        let moved = |output: &Output| matches!(output.event, Event::Pin(at, Drive::Low) if at == pin(port, bit + 1));
        assert!(outputs.iter().any(moved), "{outputs:?}");
    }
}

#[test]
fn a_snapshot_in_the_middle_of_frames_goes_on_as_the_original() {
    let (mut chip, _) = at_9600(SEND | RECEIVE);
    (0..20).for_each(|byte| serial(&mut chip, 3_000, byte * 7));
    chip.run_until(1_000);
    write(&mut chip, UDR0, 0x3C);
    chip.run_until(9_999);
    let mut snapshot = chip.clone();
    chip.run_until(200_000);
    for cycle in (10_000..200_000).step_by(777) {
        snapshot.run_until(cycle);
    }
    snapshot.run_until(200_000);
    assert_eq!(chip.take_outputs(), snapshot.take_outputs());
    assert_eq!(read(&mut chip, UDR0), read(&mut snapshot, UDR0));
}

#[test]
fn a_byte_written_while_the_transmitter_is_off_is_lost_and_noted() {
    let (mut chip, _) = set_up(&[(UDR0, 65), (UCSR0B, SEND), (UDR0, 66)]);
    chip.run_until(100_000);
    let bytes: Vec<u16> = sent(&mut chip)
        .into_iter()
        .map(|(_, byte, _)| byte)
        .collect();
    assert_eq!(bytes, [66]);
    // LDI, and the first STS.
    assert_eq!(chip.devices().unsent_at(0), Some(1));
    assert_eq!(chip.devices().unsent_at(1), None);
}
