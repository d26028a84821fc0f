//! Numbers that a program prints, as the Arduino IDE's Serial Plotter reads them: a row of numbers, or of `name:value`,
//! separated by commas, blanks, tabs or semicolons. A row of names before the first row of as many numbers names them.
//!
//! Whatever is printed, however fast: a port makes at most [`MOST_SIGNALS`] signals and a reading every [`PERIOD_MS`].

use rumbo_log::{Names, Reading, ReadingSource};
use std::collections::{BTreeMap, BTreeSet};

/// Signals of one port.
const MOST_SIGNALS: usize = 16;
/// Readings of one port are at least so far apart \[ms\].
const PERIOD_MS: i64 = 10;
/// Longest line with numbers, and longest name.
const LONGEST_LINE: usize = 512;
const LONGEST_NAME: usize = 32;

/// What one port prints.
#[derive(Debug, Default)]
pub(crate) struct Printed {
    line: Vec<u8>,
    /// The last line, if it was one of names.
    header: Option<Vec<String>>,
    /// Names of the numbers in a row of so many.
    columns: BTreeMap<usize, Vec<String>>,
    signals: BTreeSet<String>,
    names: Names,
    last_ms: Option<i64>,
}

impl Printed {
    /// Takes what port `usart` has printed; returns the newest row in it, if there is one and it is due.
    pub(crate) fn take(&mut self, usart: u8, bytes: &[u8], now_ms: i64) -> Option<Reading> {
        let mut newest = None;
        for byte in bytes {
            match byte {
                b'\n' => {
                    let line = std::mem::take(&mut self.line);
                    let row = str::from_utf8(&line).ok().and_then(|line| self.row(line));
                    newest = row.or(newest);
                }
                // One more than the longest: it is not read.
                _ if self.line.len() <= LONGEST_LINE => self.line.push(*byte),
                _ => {}
            }
        }
        if self.last_ms.is_some_and(|last| now_ms < last + PERIOD_MS) {
            return None;
        }
        let row = newest?;
        self.last_ms = Some(now_ms);
        Some(self.names.reading(now_ms, ReadingSource::Usart(usart), row))
    }

    /// The signals of a line, as far as there is room for them.
    fn row(&mut self, line: &str) -> Option<Vec<(String, f64)>> {
        let header = self.header.take();
        if line.len() > LONGEST_LINE {
            return None;
        }
        let Some(cells) = plotter_row(line) else {
            self.header = names(line);
            return None;
        };
        let numbers = cells.iter().filter(|(name, _)| name.is_none()).count();
        let columns = self.columns.len();
        let unnamed = match self.columns.get(&numbers) {
            Some(known) => known.clone(),
            None => {
                let header = header.filter(|names| names.len() == numbers);
                let made = header
                    .unwrap_or_else(|| (1..=numbers).map(|at| format!("value_{at}")).collect());
                if columns < MOST_SIGNALS {
                    self.columns.insert(numbers, made.clone());
                }
                made
            }
        };
        let mut unnamed = unnamed.into_iter();
        let mut row: Vec<(String, f64)> = Vec::new();
        for (name, value) in cells {
            let name = name.map(str::to_owned).or_else(|| unnamed.next())?;
            let is_new = !self.signals.contains(&name);
            let is_twice = row.iter().any(|(other, _)| *other == name);
            if is_twice || (is_new && self.signals.len() == MOST_SIGNALS) {
                continue;
            }
            self.signals.insert(name.clone());
            row.push((name, value));
        }
        (!row.is_empty()).then_some(row)
    }
}

/// The numbers of a line, each with its name if it has one, as the Serial Plotter reads it; `None` if it is no row.
#[must_use]
pub fn plotter_row(line: &str) -> Option<Vec<(Option<&str>, f64)>> {
    let cells: Option<Vec<Cell<'_>>> = words(line).map(Cell::of).collect();
    cells.and_then(joined)
}

/// A word of a line.
enum Cell<'a> {
    Number(f64),
    Named(&'a str, f64),
    /// A name with a colon: the number is the next word.
    Name(&'a str),
}

impl<'a> Cell<'a> {
    fn of(word: &'a str) -> Option<Self> {
        match word.rsplit_once(':') {
            None => number(word).map(Self::Number),
            Some((name, _)) if !is_name(name) => None,
            Some((name, "")) => Some(Self::Name(name)),
            Some((name, value)) => Some(Self::Named(name, number(value)?)),
        }
    }
}

fn joined(cells: Vec<Cell<'_>>) -> Option<Vec<(Option<&str>, f64)>> {
    let mut row = Vec::new();
    let mut cells = cells.into_iter();
    while let Some(cell) = cells.next() {
        row.push(match cell {
            Cell::Number(value) => (None, value),
            Cell::Named(name, value) => (Some(name), value),
            Cell::Name(name) => match cells.next()? {
                Cell::Number(value) => (Some(name), value),
                Cell::Named(..) | Cell::Name(_) => return None,
            },
        });
    }
    (!row.is_empty()).then_some(row)
}

fn words(line: &str) -> impl Iterator<Item = &str> {
    let words = line.split(|c: char| c.is_ascii_whitespace() || c == ',' || c == ';');
    words.filter(|word| !word.is_empty())
}

/// A number as Arduino's `print` writes it; what it cannot write is not known.
fn number(word: &str) -> Option<f64> {
    if matches!(word, "nan" | "inf" | "-inf" | "ovf" | "-ovf") {
        return Some(f64::NAN);
    }
    let plain = |byte: u8| byte.is_ascii_digit() || b"+-.eE".contains(&byte);
    let value: f64 = word.parse().ok().filter(|_| word.bytes().all(plain))?;
    // Larger ones do not fit into a signal.
    (value.abs() < f64::from(f32::MAX)).then_some(value)
}

fn is_name(word: &str) -> bool {
    let inner = |byte: u8| byte.is_ascii_graphic() && byte != b'"' && byte != b'\\';
    word.len() <= LONGEST_NAME
        && word.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
        && word.bytes().all(inner)
}

/// The names in a line that has nothing else.
fn names(line: &str) -> Option<Vec<String>> {
    let names: Vec<&str> = words(line).collect();
    let all = !names.is_empty()
        && names
            .iter()
            .all(|name| is_name(name) && !name.contains(':'));
    all.then(|| names.into_iter().map(str::to_owned).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The last row of a text, with all its names and values.
    fn last(printed: &mut Printed, text: &str, now_ms: i64) -> Vec<(String, Option<f64>)> {
        let reading = printed.take(0, text.as_bytes(), now_ms);
        let reading = reading.iter().flat_map(|reading| {
            let names = reading.names.iter();
            names.map(|name| (name.clone(), reading.signal(name)))
        });
        reading.collect()
    }

    fn row(text: &str) -> String {
        let row = last(&mut Printed::default(), text, 0);
        let cells = row.iter().map(|(name, value)| match value {
            Some(value) => format!("{name}={value}"),
            None => format!("{name}=?"),
        });
        cells.collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn rows_are_read_as_the_serial_plotter_reads_them() {
        for (text, read) in [
            ("12.5\r\n", "value_1=12.5"),
            (
                "1, -2\t3;4e2\n",
                "value_1=1 value_2=-2 value_3=3 value_4=400",
            ),
            ("left:1.5,right:-2\n", "left=1.5 right=-2"),
            ("left: 1.5 right: 2\n", "left=1.5 right=2"),
            ("cm error\n3 4\n", "cm=3 error=4"),
            ("cm error\n3 4 5\n", "value_1=3 value_2=4 value_3=5"),
            ("kp:1 7\n", "kp=1 value_1=7"),
            ("nan,2\n", "value_1=? value_2=2"),
            ("1 2\nhello, robot\n", "value_1=1 value_2=2"),
        ] {
            assert_eq!(row(text), read, "{text:?}");
        }
    }

    #[test]
    fn what_is_no_row_makes_no_signal() {
        for text in [
            "\n",
            "wall at 30 cm\n",
            "12",
            "a:b\n",
            "a:\n",
            "1e999\n",
            "12:30\n",
            "0x1f\n",
            "x:1 y:\n",
            "\u{fffd}1\n",
            "infinity\n",
        ] {
            assert_eq!(row(text), "", "{text:?}");
        }
        assert_eq!(row(&format!("{}\n", "1 ".repeat(400))), "");
    }

    #[test]
    fn a_row_in_pieces_is_one_row_and_names_stay_as_they_were_given_first() {
        let mut printed = Printed::default();
        assert!(last(&mut printed, "cm err", 0).is_empty());
        assert!(last(&mut printed, "or\n1 ", 10).is_empty());
        let expected = [
            ("cm".to_owned(), Some(1.0)),
            ("error".to_owned(), Some(2.0)),
        ];
        assert_eq!(last(&mut printed, "2\n", 20), expected);
        let later = last(&mut printed, "hello world\n1 2\n", 30);
        assert_eq!(later, expected);
    }

    #[test]
    fn a_flood_makes_a_bounded_number_of_signals_and_readings() {
        let mut printed = Printed::default();
        let mut seen = BTreeSet::new();
        let mut readings = 0;
        for t_ms in 0..1_000 {
            let flood: String = (0..50).map(|each| format!("n{t_ms}_{each}:1\n")).collect();
            let wide = format!("{}\n", "1,".repeat(t_ms as usize % 100));
            let row = last(&mut printed, &(flood + &wide), t_ms);
            readings += usize::from(!row.is_empty());
            seen.extend(row.into_iter().map(|(name, _)| name));
        }
        assert!(
            seen.len() <= MOST_SIGNALS && readings <= 100,
            "{} {readings}",
            seen.len()
        );
        assert!(printed.columns.len() <= MOST_SIGNALS && printed.line.len() <= LONGEST_LINE + 1);
    }
}
