//! A display with an SSD1306 (Solomon Systech, revision 1.1) on a glass of 128 by 64 or by 32 dots.
//!
//! A control byte says whether commands or dots follow, one or all up to the end. The glass is mounted as the common
//! modules are: upright where columns are remapped (A1) and rows scanned downward (C8). Its dots are lit while the display and
//! the charge pump are on. What the chip scrolls by itself is not modelled.

use super::hex;

const COLUMNS: usize = 128;
const PAGES: usize = 8;
/// Bits of a control byte: only one byte follows; it is dots.
const ONE: u8 = 0x80;
const DOTS: u8 = 0x40;

/// How the address moves on (command 20).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Order {
    Across,
    Down,
    Page,
}

/// What comes next in a transmission.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Next {
    Control,
    /// Dots or commands: one, or all.
    Bytes {
        dots: bool,
        one: bool,
    },
}

/// The display.
#[derive(Clone, Debug)]
pub(super) struct Pixels {
    height: u8,
    /// By page and segment.
    memory: Box<[[u8; COLUMNS]; PAGES]>,
    next: Next,
    /// A command whose parameters are awaited.
    command: Vec<u8>,
    order: Order,
    columns: [u8; 2],
    pages: [u8; 2],
    column: u8,
    page: u8,
    on: bool,
    pump: bool,
    all: bool,
    inverse: bool,
    /// Columns are remapped, rows scanned downward, rows wired alternately.
    remapped: bool,
    downward: bool,
    alternate: bool,
    start: u8,
    offset: u8,
    multiplex: u8,
    changed: bool,
}

/// Parameters of a command.
fn parameters(command: u8) -> usize {
    match command {
        0x20 | 0x23 | 0x81 | 0x8D | 0xA8 | 0xD3 | 0xD5 | 0xD6 | 0xD9 | 0xDA | 0xDB => 1,
        0x21 | 0x22 | 0xA3 => 2,
        0x26 | 0x27 => 6,
        0x29 | 0x2A => 5,
        _ => 0,
    }
}

impl Pixels {
    /// After power-on.
    pub(super) fn new(height: u8) -> Self {
        Self {
            height,
            memory: Box::new([[0; COLUMNS]; PAGES]),
            next: Next::Control,
            command: Vec::new(),
            order: Order::Page,
            columns: [0, 127],
            pages: [0, 7],
            column: 0,
            page: 0,
            on: false,
            pump: false,
            all: false,
            inverse: false,
            remapped: false,
            downward: false,
            alternate: true,
            start: 0,
            offset: 0,
            multiplex: 64,
            changed: false,
        }
    }

    /// A transmission begins.
    pub(super) fn address(&mut self) {
        self.next = Next::Control;
    }

    /// The status: bit 6 while the display is off.
    pub(super) fn read(&self) -> u8 {
        if self.on { 0 } else { 0x40 }
    }

    pub(super) fn write(&mut self, byte: u8) {
        let Next::Bytes { dots, one } = self.next else {
            self.next = Next::Bytes {
                dots: byte & DOTS != 0,
                one: byte & ONE != 0,
            };
            return;
        };
        if one {
            self.next = Next::Control;
        }
        self.changed = true;
        if dots {
            self.put(byte);
            return;
        }
        self.command.push(byte);
        if self.command.len() > parameters(self.command[0]) {
            let command = std::mem::take(&mut self.command);
            self.obey(command[0], command.get(1).copied().unwrap_or(0), &command);
        }
    }

    fn put(&mut self, dots: u8) {
        let segment = match self.remapped {
            true => COLUMNS as u8 - 1 - self.column,
            false => self.column,
        };
        self.memory[usize::from(self.page)][usize::from(segment)] = dots;
        let pass = |at: &mut u8, [first, last]: [u8; 2], end: u8| {
            let over = *at == last || *at >= end;
            *at = if over { first } else { *at + 1 };
            over
        };
        match self.order {
            Order::Page => {
                pass(&mut self.column, [0, 127], 127);
            }
            Order::Across => {
                if pass(&mut self.column, self.columns, 127) {
                    pass(&mut self.page, self.pages, 7);
                }
            }
            Order::Down => {
                if pass(&mut self.page, self.pages, 7) {
                    pass(&mut self.column, self.columns, 127);
                }
            }
        }
    }

    fn obey(&mut self, command: u8, first: u8, all: &[u8]) {
        let second = all.get(2).copied().unwrap_or(0);
        match command {
            0x00..=0x0F => self.column = self.column & 0x70 | command & 0x0F,
            0x10..=0x1F => self.column = self.column & 0x0F | (command & 7) << 4,
            0x20 => {
                self.order = match first & 3 {
                    0 => Order::Across,
                    1 => Order::Down,
                    _ => Order::Page,
                }
            }
            0x21 => {
                self.columns = [first & 127, second & 127];
                self.column = first & 127;
            }
            0x22 => {
                self.pages = [first & 7, second & 7];
                self.page = first & 7;
            }
            0x40..=0x7F => self.start = command & 63,
            0x8D => self.pump = first & 4 != 0,
            0xA0 | 0xA1 => self.remapped = command & 1 != 0,
            0xA4 | 0xA5 => self.all = command & 1 != 0,
            0xA6 | 0xA7 => self.inverse = command & 1 != 0,
            0xA8 => self.multiplex = (first & 63).max(15) + 1,
            0xAE | 0xAF => self.on = command & 1 != 0,
            0xB0..=0xB7 => self.page = command & 7,
            0xC0..=0xCF => self.downward = command & 8 != 0,
            0xD3 => self.offset = first & 63,
            0xDA => self.alternate = first & 0x10 != 0,
            // Contrast and the timing of the drivers change no dot; nor does what scrolls.
            _ => {}
        }
    }

    pub(super) fn take_changed(&mut self) -> bool {
        std::mem::take(&mut self.changed)
    }

    /// The row of the memory that a row of the glass shows, if any.
    fn row_of(&self, row: u8) -> Option<u8> {
        // The output that this row of the glass is wired to, from below.
        let line = self.height - 1 - row;
        let output = match self.height {
            64 => line / 2 + 32 * (line % 2),
            _ => line,
        };
        // The line that the chip gives to that output.
        let line = match self.alternate {
            true => 2 * (output % 32) + output / 32,
            false => output,
        };
        let row = match self.downward {
            true => self.multiplex.checked_sub(line + 1)?,
            false => line,
        };
        let row = (row + self.offset) % 64;
        (line < self.multiplex && row < self.multiplex).then(|| (row + self.start) % 64)
    }

    /// Whether each dot is lit, row by row, eight in a byte, the left one highest.
    fn lit(&self) -> Vec<u8> {
        let mut lit = Vec::with_capacity(usize::from(self.height) * COLUMNS / 8);
        for row in 0..self.height {
            let from = self.row_of(row).filter(|_| self.on && self.pump);
            for byte in 0..COLUMNS / 8 {
                let dots = (0..8).map(|bit| {
                    let segment = COLUMNS - 1 - (8 * byte + bit);
                    let dot =
                        |row: u8| self.memory[usize::from(row / 8)][segment] >> (row % 8) & 1 != 0;
                    from.is_some_and(|row| self.all || dot(row) != self.inverse)
                });
                lit.push(dots.fold(0, |byte, dot| byte << 1 | u8::from(dot)));
            }
        }
        lit
    }

    /// What it shows, as JSON: how many `columns`, and the `dots`, row by row, in hexadecimal.
    pub(super) fn content(&self) -> String {
        format!(
            "{{\"columns\":{COLUMNS},\"dots\":\"{}\"}}",
            hex(&self.lit())
        )
    }

    /// What it shows, for a terminal, in Braille; nothing where it is dark.
    pub(super) fn drawn(&self) -> Option<String> {
        let lit = self.lit();
        let dot = |x: usize, y: usize| lit[y * COLUMNS / 8 + x / 8] >> (7 - x % 8) & 1;
        // The bits of a Braille pattern, by column and row.
        let bits = [[0, 1, 2, 6], [3, 4, 5, 7]];
        let cell = |x: usize, y: usize| {
            let places = (0..2).flat_map(|right| (0..4).map(move |down| (right, down)));
            let pattern = places.fold(0, |pattern, (right, down)| {
                pattern | u32::from(dot(x + right, y + down)) << bits[right][down]
            });
            char::from_u32(0x2800 + pattern).unwrap_or(' ')
        };
        let line = |y: usize| (0..COLUMNS).step_by(2).map(|x| cell(x, y)).collect();
        let lines: Vec<String> = (0..usize::from(self.height)).step_by(4).map(line).collect();
        lit.iter().any(|dots| *dots != 0).then(|| lines.join("\n"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As the libraries begin, with this multiplex and wiring of the rows.
    fn begun(height: u8, more: &[u8]) -> Pixels {
        let mut pixels = Pixels::new(height);
        pixels.address();
        let rows = if height == 64 { 0x12 } else { 0x02 };
        let begin = [
            0,
            0xA8,
            height - 1,
            0xDA,
            rows,
            0x8D,
            0x14,
            0x20,
            0,
            0xA1,
            0xC8,
            0xAF,
        ];
        begin
            .iter()
            .chain(more)
            .for_each(|byte| pixels.write(*byte));
        pixels
    }

    fn draw(pixels: &mut Pixels, dots: &[u8]) {
        pixels.address();
        pixels.write(DOTS);
        dots.iter().for_each(|byte| pixels.write(*byte));
    }

    fn lit(pixels: &Pixels) -> Vec<(usize, usize)> {
        let lit = pixels.lit();
        let dots = (0..lit.len() * 8).filter(|dot| lit[dot / 8] >> (7 - dot % 8) & 1 != 0);
        dots.map(|dot| (dot % COLUMNS, dot / COLUMNS)).collect()
    }

    #[test]
    fn the_first_dot_is_up_left_on_both_glasses_and_elsewhere_when_turned() {
        for height in [64, 32] {
            let mut pixels = begun(height, &[]);
            draw(&mut pixels, &[0x03]);
            assert_eq!(lit(&pixels), [(0, 0), (0, 1)]);
            let last = usize::from(height) - 1;
            let mut pixels = begun(height, &[0xA0, 0xC0]);
            draw(&mut pixels, &[0x03]);
            assert_eq!(lit(&pixels), [(127, last - 1), (127, last)]);
        }
    }

    #[test]
    fn a_window_is_filled_across_and_down_and_a_page_stays_in_itself() {
        let window = [0x21, 10, 11, 0x22, 1, 2];
        let mut pixels = begun(64, &window);
        draw(&mut pixels, &[1, 0, 0, 1, 0x80]);
        assert_eq!(lit(&pixels), [(10, 15), (11, 16)]);
        let mut pixels = begun(64, &[&window[..], &[0x20, 1]].concat());
        draw(&mut pixels, &[1, 0, 0, 1]);
        assert_eq!(lit(&pixels), [(10, 8), (11, 16)]);
        let mut pixels = begun(64, &[0x20, 2, 0xB3, 0x0F, 0x17]);
        draw(&mut pixels, &[1, 1]);
        assert_eq!(lit(&pixels), [(0, 24), (127, 24)]);
    }

    #[test]
    fn it_is_dark_without_its_charge_pump_and_lit_all_over_when_inverted() {
        let mut pixels = begun(64, &[0x8D, 0x10]);
        draw(&mut pixels, &[1]);
        assert_eq!(pixels.drawn(), None);
        assert_eq!(lit(&begun(32, &[0xA7])).len(), 128 * 32);
        assert_eq!(lit(&begun(32, &[0xA5])).len(), 128 * 32);
        assert_eq!(lit(&begun(32, &[0xA7, 0xAE])).len(), 0);
    }

    #[test]
    fn rows_move_with_the_start_line_and_the_offset() {
        for (moved, row) in [([0x41, 0xE3, 0xE3], 7), ([0xD3, 63, 0xE3], 9)] {
            let mut pixels = begun(64, &moved);
            draw(&mut pixels, &[&[0; 128][..], &[1]].concat());
            assert_eq!(lit(&pixels), [(0, row)]);
        }
    }

    #[test]
    fn a_glass_of_32_rows_set_up_as_one_of_64_shows_every_other_row() {
        let mut pixels = begun(32, &[0xA8, 63, 0xDA, 0x12]);
        draw(&mut pixels, &[0xFF]);
        let rows: Vec<usize> = lit(&pixels).into_iter().map(|(_, row)| row).collect();
        assert_eq!(rows, [0, 1, 2, 3]);
    }
}
