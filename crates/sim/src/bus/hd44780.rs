//! A character display with an HD44780 (Hitachi's data sheet, ADE-207-272) whose lines a PCF8574 drives, as the common
//! boards wire it: P0 RS, P1 R/W, P2 E, P3 the light, P4 to P7 D4 to D7. Or the pins of the board drive RS, E and D4 to D7.
//!
//! A falling E takes a nibble. Until 4 bits are selected each is a whole instruction. An instruction that comes while the
//! one before is at work is lost.

use super::kind::Place;
use super::{hex, quoted};

const RS: u8 = 0x01;
const RW: u8 = 0x02;
const E: u8 = 0x04;
const LIGHT: u8 = 0x08;
/// Cycles of the board's crystal in a microsecond.
const US: u64 = 16;
/// Table 6: how long an instruction takes, and clear and home.
const SHORT: u64 = 37 * US;
const LONG: u64 = 1_520 * US;
/// Cells of the memory, and of half of it.
const CELLS: usize = 80;
const HALF: u8 = 40;
/// The first of the characters that a program may draw, in the private use area of Unicode.
const OWN: u32 = 0xE000;
/// Codes from 0xE0 on, of the ROM A00.
const UPPER: [char; 32] = [
    'α', 'ä', 'β', 'ε', 'μ', 'σ', 'ρ', 'g', '√', '⁻', 'j', 'ˣ', '¢', '£', 'ñ', 'ö', //
    'p', 'q', 'θ', '∞', 'Ω', 'ü', 'Σ', 'π', 'x', 'y', '千', '万', '円', '÷', ' ', '█',
];

/// The display.
#[derive(Clone, Debug)]
pub(super) struct Text {
    columns: u8,
    rows: u8,
    cells: [u8; CELLS],
    drawn: [u8; 64],
    /// Where the next byte goes, and whether among the characters that a program draws.
    address: u8,
    into_drawn: bool,
    forward: bool,
    /// The text moves with each character.
    moves: bool,
    on: bool,
    /// How far the text has been moved to the left.
    shift: u8,
    two_lines: bool,
    four_bits: bool,
    /// The upper half of a byte, while the lower one is awaited.
    upper: Option<u8>,
    /// The lower half is read next.
    read_lower: bool,
    /// What the PCF8574 drives.
    lines: u8,
    busy_until: u64,
    lost: u32,
    changed: bool,
}

impl Text {
    /// Just switched on, with its lines at a PCF8574, or at pins, and its light then at the supply.
    pub(super) fn new(columns: u8, rows: u8, place: Place) -> Self {
        Self {
            columns,
            rows,
            cells: [b' '; CELLS],
            drawn: [0; 64],
            address: 0,
            into_drawn: false,
            forward: true,
            moves: false,
            on: false,
            shift: 0,
            two_lines: false,
            four_bits: false,
            upper: None,
            read_lower: false,
            lines: place.address().map_or(LIGHT, |_| 0xFF),
            busy_until: 0,
            lost: 0,
            changed: false,
        }
    }

    /// One of the lines that are at pins, in the order of [`Place::Lines`], has this level.
    pub(super) fn set(&mut self, line: usize, high: bool, cycle: u64) {
        let bit = [RS, E, 0x10, 0x20, 0x40, 0x80][line];
        let others = self.lines & !bit;
        self.write(if high { others | bit } else { others }, cycle);
    }

    /// The PCF8574 gets a byte: its lines.
    pub(super) fn write(&mut self, lines: u8, cycle: u64) {
        let before = std::mem::replace(&mut self.lines, lines);
        self.changed |= (before ^ lines) & LIGHT != 0;
        if before & E == 0 || lines & E != 0 {
            return;
        }
        let (rs, nibble) = (before & RS != 0, before >> 4);
        if before & RW != 0 {
            self.end_read(rs, cycle);
            return;
        }
        let byte = match (self.four_bits, self.upper.take()) {
            (false, _) => nibble << 4,
            (true, Some(upper)) => upper << 4 | nibble,
            (true, None) => {
                self.upper = Some(nibble);
                return;
            }
        };
        if cycle < self.busy_until {
            self.lost += 1;
            return;
        }
        self.busy_until = cycle + SHORT;
        self.changed = true;
        if rs {
            self.put(byte);
        } else {
            self.instruct(byte, cycle);
        }
    }

    /// The PCF8574 is read: its lines, of which the display drives the upper four while E and R/W are high.
    pub(super) fn read(&self, cycle: u64) -> u8 {
        if self.lines & (E | RW) != E | RW {
            return self.lines;
        }
        let byte = match self.lines & RS != 0 {
            true => *self.cell(),
            false => self.address & 0x7F | if cycle < self.busy_until { 0x80 } else { 0 },
        };
        let nibble = if self.read_lower { byte << 4 } else { byte };
        // A line that the PCF8574 itself holds low stays low.
        (nibble & 0xF0 | 0x0F) & self.lines
    }

    /// The falling E after a half that was read.
    fn end_read(&mut self, rs: bool, cycle: u64) {
        self.read_lower = self.four_bits && !self.read_lower;
        if rs && !self.read_lower {
            self.busy_until = cycle + SHORT;
            self.step(self.forward);
        }
    }

    fn cell(&self) -> &u8 {
        if self.into_drawn {
            return &self.drawn[usize::from(self.address % 64)];
        }
        &self.cells[self.place(self.address)]
    }

    /// The cell of an address.
    fn place(&self, address: u8) -> usize {
        let second = self.two_lines && address >= 0x40;
        let place = if second {
            HALF + (address - 0x40) % HALF
        } else {
            address
        };
        usize::from(place) % CELLS
    }

    fn put(&mut self, byte: u8) {
        if self.into_drawn {
            self.drawn[usize::from(self.address % 64)] = byte;
        } else {
            self.cells[self.place(self.address)] = byte;
        }
        self.step(self.forward);
        if self.moves && !self.into_drawn {
            self.slide(self.forward);
        }
    }

    /// The address goes on by one, to the other line behind the end of one.
    fn step(&mut self, forward: bool) {
        if self.into_drawn {
            let next = if forward { 1 } else { 63 };
            self.address = (self.address + next) % 64;
            return;
        }
        let last = CELLS as u8 - 1;
        self.address = match (self.two_lines, self.address, forward) {
            (true, 0x27, true) => 0x40,
            (true, 0x67, true) => 0,
            (true, 0, false) => 0x67,
            (true, 0x40, false) => 0x27,
            (false, address, true) if address >= last => 0,
            (false, 0, false) => last,
            (_, address, true) => (address + 1) & 0x7F,
            (_, address, false) => address - 1,
        };
    }

    fn slide(&mut self, left: bool) {
        self.shift = (self.shift + if left { 1 } else { HALF - 1 }) % HALF;
    }

    fn instruct(&mut self, byte: u8, cycle: u64) {
        let has = |bit: u8| byte & bit != 0;
        match byte.leading_zeros() {
            0 => (self.into_drawn, self.address) = (false, byte & 0x7F),
            1 => (self.into_drawn, self.address) = (true, byte & 0x3F),
            2 => {
                self.four_bits = !has(0x10);
                self.two_lines = has(0x08);
            }
            3 if has(0x08) => self.slide(!has(0x04)),
            3 => self.step(has(0x04)),
            4 => self.on = has(0x04),
            5 => (self.forward, self.moves) = (has(0x02), has(0x01)),
            6 | 7 => {
                if byte == 1 {
                    self.cells = [b' '; CELLS];
                    self.forward = true;
                }
                (self.into_drawn, self.address, self.shift) = (false, 0, 0);
                self.busy_until = cycle + LONG;
            }
            _ => {}
        }
    }

    /// What a program did that it did not take.
    pub(super) fn oddity(&self) -> Option<String> {
        (self.lost > 0).then(|| {
            format!(
                "{} bytes came while the display was busy and are lost; wait 2 ms after clear and home",
                self.lost
            )
        })
    }

    pub(super) fn take_changed(&mut self) -> bool {
        std::mem::take(&mut self.changed)
    }

    /// Its rows, as people read them.
    fn rows(&self) -> Vec<String> {
        let row = |row: u8| {
            let cells = (0..self.columns).map(move |column| {
                let second = !row.is_multiple_of(2);
                if !self.on || second && !self.two_lines {
                    return ' ';
                }
                let from = if row < 2 { 0 } else { self.columns };
                let place = (from + column + self.shift) % HALF;
                let place = if second { place + HALF } else { place };
                letter(self.cells[usize::from(place)])
            });
            cells.collect::<String>()
        };
        (0..self.rows).map(row).collect()
    }

    /// What it shows, as JSON: `rows`, `drawn` (the characters of the program's own, each row of five dots a byte, by their
    /// letters) and whether it has `light`.
    pub(super) fn content(&self) -> String {
        let rows = self.rows();
        let own = (0..8_u8).filter_map(|number| {
            let letter = char::from_u32(OWN + u32::from(number))?;
            let used = rows.iter().any(|row| row.contains(letter));
            let from = usize::from(number) * 8;
            used.then(|| format!("\"{number}\":\"{}\"", hex(&self.drawn[from..from + 8])))
        });
        let own = own.collect::<Vec<_>>().join(",");
        let rows: Vec<_> = rows.iter().map(|row| quoted(row)).collect();
        let light = self.lines & LIGHT != 0;
        format!(
            "{{\"rows\":[{}],\"drawn\":{{{own}}},\"light\":{light}}}",
            rows.join(",")
        )
    }

    /// What it shows, for a terminal; nothing where that is nothing.
    pub(super) fn drawn(&self) -> Option<String> {
        let rows = self.rows();
        let shows = rows.iter().any(|row| !row.trim().is_empty());
        let visible = |letter: char| match u32::from(letter) {
            OWN.. if u32::from(letter) < OWN + 8 => '▯',
            _ => letter,
        };
        let line = |row: &String| format!("|{}|", row.chars().map(visible).collect::<String>());
        shows.then(|| rows.iter().map(line).collect::<Vec<_>>().join("\n"))
    }
}

/// A code as a character, by the ROM A00.
fn letter(code: u8) -> char {
    let from = |first: u32, code: u8| char::from_u32(first + u32::from(code)).unwrap_or(' ');
    match code {
        0..=15 => from(OWN, code % 8),
        b'\\' => '¥',
        0x7E => '→',
        0x7F => '←',
        b' '..=0x7D => char::from(code),
        // Used as a degree sign.
        0xDF => '°',
        0xA1..=0xDE => from(0xFF61, code - 0xA1),
        0xE0.. => UPPER[usize::from(code - 0xE0)],
        _ => ' ',
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sends a byte in two halves, each with a pulse of E, a tenth of a millisecond apart.
    fn send(text: &mut Text, now: &mut u64, byte: u8, rs: u8) {
        for half in [byte & 0xF0, byte << 4] {
            strobe(text, now, half | rs);
        }
    }

    fn strobe(text: &mut Text, now: &mut u64, lines: u8) {
        for lines in [lines | LIGHT | E, lines | LIGHT] {
            *now += 100 * US;
            text.write(lines, *now);
        }
    }

    fn begun(columns: u8, rows: u8) -> (Text, u64) {
        let (mut text, mut now) = (Text::new(columns, rows, Place::Address(0x27)), 0);
        for nibble in [0x30, 0x30, 0x30, 0x20] {
            strobe(&mut text, &mut now, nibble);
        }
        for instruction in [0x28, 0x0C, 0x06, 0x01] {
            send(&mut text, &mut now, instruction, 0);
        }
        now += LONG;
        (text, now)
    }

    #[test]
    fn four_rows_lie_in_two_lines_of_the_memory() {
        let (mut text, mut now) = begun(20, 4);
        for (address, letter) in [(0x00, b'a'), (0x40, b'b'), (0x14, b'c'), (0x54, b'd')] {
            send(&mut text, &mut now, 0x80 | address, 0);
            send(&mut text, &mut now, letter, RS);
        }
        let rows = text.rows();
        let first: String = rows.iter().filter_map(|row| row.chars().next()).collect();
        assert_eq!(first, "abcd");
        assert!(rows.iter().all(|row| row.chars().count() == 20));
    }

    #[test]
    fn a_character_that_the_program_draws_is_shown_with_its_dots() {
        let (mut text, mut now) = begun(16, 2);
        send(&mut text, &mut now, 0x48, 0);
        for row in [0x0E, 0x1F, 0x1F, 0x0E, 0, 0, 0, 0x15] {
            send(&mut text, &mut now, row, RS);
        }
        send(&mut text, &mut now, 0xC0, 0);
        for code in [1, b'4', 0xDF] {
            send(&mut text, &mut now, code, RS);
        }
        assert_eq!(
            text.content(),
            "{\"rows\":[\"                \",\"\\ue0014\\u00b0             \"],\"drawn\":{\"1\":\"0e1f1f0e00000015\"},\
             \"light\":true}"
        );
    }

    #[test]
    fn what_comes_right_after_clear_is_lost() {
        let (mut text, mut now) = begun(16, 2);
        send(&mut text, &mut now, 0x01, 0);
        send(&mut text, &mut now, b'a', RS);
        now += LONG;
        send(&mut text, &mut now, b'b', RS);
        assert_eq!((text.rows()[0].trim(), text.lost), ("b", 1));
    }

    #[test]
    fn the_text_moves_and_busy_and_address_can_be_read() {
        let (mut text, mut now) = begun(16, 2);
        for letter in *b"xyz" {
            send(&mut text, &mut now, letter, RS);
        }
        send(&mut text, &mut now, 0x18, 0);
        assert_eq!(text.rows()[0].trim_end(), "yz");
        let mut read = |now| {
            text.write(0xF0 | RW | E, now);
            let upper = text.read(now) & 0xF0;
            text.write(0xF0 | RW, now);
            text.write(0xF0 | RW | E, now);
            let lower = text.read(now) >> 4;
            text.write(0xF0 | RW, now);
            upper | lower
        };
        assert_eq!(read(now + 10 * US), 0x83);
        assert_eq!(read(now + 40 * US), 0x03);
    }
}
