//! Serial lines: by the USARTs, and by software on any pins.

use super::board::Board;
use rumbo_emulator::devices::Input;

const TEXT: &str = "El veloz murcielago hindu comia feliz cardillo y kiwi; 0123456789.\n";
/// Cycles of a bit at 9600 baud.
const BIT: u64 = 1_667;

#[test]
fn a_greeting_leaves_byte_by_byte_at_the_rate_of_its_line() {
    let Some(mut board) = Board::with("serial_echo") else {
        return;
    };
    board.run_us(30_000);
    // Ten bits of 8 cycles each, times the divisor: 17 for 115,200 baud, 208 for 9600.
    for (usart, text, cycles) in [
        (0, "Hello, 115200\r\n", 10 * 8 * 17),
        (2, "Hello, 9600\r\n", 10 * 8 * 208),
    ] {
        let bytes = board.sent(usart);
        let said: String = bytes.iter().map(|(_, byte)| char::from(*byte)).collect();
        assert_eq!(said, text);
        for two in bytes.windows(2) {
            assert_eq!(two[1].0 - two[0].0, cycles, "USART {usart}");
        }
    }
}

#[test]
fn what_comes_in_on_two_lines_goes_back_on_both() {
    let Some(mut board) = Board::with("serial_echo") else {
        return;
    };
    board.run_us(30_000);
    board.forget();
    let text = TEXT.repeat(4);
    let start = board.cycle();
    for (usart, baud) in [(0, 115_200), (2, 9_600)] {
        for byte in text.bytes() {
            board.chip.input(start, Input::Serial { usart, byte, baud });
        }
    }
    board.run_us(text.len() as u64 * 1_050);
    for usart in [0, 2] {
        let echoed: Vec<u8> = board.sent(usart).iter().map(|(_, byte)| *byte).collect();
        assert_eq!(String::from_utf8_lossy(&echoed), text, "USART {usart}");
    }
}

#[test]
fn a_software_serial_line_receives_and_replies() {
    let Some(mut board) = Board::with("soft_serial") else {
        return;
    };
    board.set(0, 10, true);
    board.run_us(5_000);
    // It replies between the letters: it cannot receive while it sends.
    for (index, letter) in "rumbo, 90".bytes().enumerate() {
        board.forget();
        let start = board.cycle() + 37 * index as u64;
        // Start bit, the letter, stop bit.
        let frame = u16::from(letter) << 1 | 1 << 9;
        for bit in 0..10 {
            board.set(start + bit * BIT, 10, frame >> bit & 1 != 0);
        }
        board.run_us(3_000);
        assert_eq!(decoded(&board.edges(11)), Some(letter.to_ascii_uppercase()));
    }
}

/// The byte that a line's edges make at 9600 baud, sampled in the middle of its bits.
fn decoded(edges: &[(u64, bool)]) -> Option<u8> {
    let start = edges.iter().find(|edge| !edge.1)?.0;
    let level = |cycle: u64| {
        let before = edges.iter().rev().find(|edge| edge.0 <= cycle);
        before.is_none_or(|edge| edge.1)
    };
    let bit = |index: u64| level(start + index * BIT + BIT / 2);
    let byte = (0..8).fold(0, |byte, index| byte | u8::from(bit(index + 1)) << index);
    (!bit(0) && bit(9)).then_some(byte)
}
