//! CSVs as spreadsheets write them: semicolons or tabulators between the columns, commas in the numbers, quoted cells, a
//! first line that names the separator, UTF-16, a byte-order mark, lines ended as on an old Macintosh.

use std::borrow::Cow;
use thiserror::Error;

/// Bytes that are no text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("is no text; give a CSV")]
pub struct NoText;

/// The text of a CSV of numbers with commas between the columns and points in the numbers, whatever stood there. Lines
/// stay lines, but for a first one that only names the separator (`sep=;`), which a spreadsheet does not count either.
///
/// # Errors
/// Bytes that are no text.
pub fn plain(bytes: &[u8]) -> Result<Cow<'_, str>, NoText> {
    let mut whole = text_of(bytes)?;
    if whole.contains('\r') && !whole.contains('\n') {
        whole = Cow::Owned(whole.replace('\r', "\n"));
    }
    let (first, rest) = whole.split_once('\n').unwrap_or((&whole, ""));
    let named = named_separator(first);
    let text = if named.is_some() { rest } else { &whole };
    let between = named.unwrap_or_else(|| separator(text.lines().next().unwrap_or_default()));
    if named.is_none() && between == ',' && !text.contains('"') {
        return Ok(whole);
    }
    Ok(Cow::Owned(in_points(text, between)))
}

/// The separator that a first line such as `sep=;` names.
fn named_separator(line: &str) -> Option<char> {
    let name = line.trim_matches(|c: char| c == '"' || c == '\r');
    let (key, separator) = name.split_at_checked(4)?;
    let mut separator = separator.chars();
    let only = separator.next().filter(|_| separator.next().is_none());
    only.filter(|_| key.eq_ignore_ascii_case("sep="))
}

/// What parts the cells of a line.
fn separator(line: &str) -> char {
    let count = |wanted: char| {
        let mut quoted = false;
        let counts = |&c: &char| {
            quoted ^= c == '"';
            c == wanted && !quoted
        };
        line.chars().filter(counts).count()
    };
    // A row of numbers has at most one comma in each.
    let parts = |mark: &char| count(*mark) > 0 && count(',') <= count(*mark) + 1;
    [';', '\t'].into_iter().find(parts).unwrap_or(',')
}

fn in_points(text: &str, between: char) -> String {
    let mut plain = String::with_capacity(text.len());
    for line in text.split_inclusive('\n') {
        let cells = line.trim_end_matches(['\r', '\n']);
        for (number, cell) in Cells(Some(cells), between).enumerate() {
            if number > 0 {
                plain.push(',');
            }
            match cell {
                Cell::Plain(cell) if between == ',' => plain += cell,
                Cell::Plain(cell) => plain += &cell.replace(',', "."),
                Cell::Quoted(cell) => plain += &unquoted(cell),
            }
        }
        plain += &line[cells.len()..];
    }
    plain
}

/// A quoted cell's comma is that of its number; a whole row between quotes stays one.
fn unquoted(cell: &str) -> String {
    let number = cell.replacen(',', ".", 1);
    match number.trim().parse::<f64>() {
        Ok(_) => number,
        Err(_) => cell.to_owned(),
    }
}

enum Cell<'a> {
    Plain(&'a str),
    Quoted(&'a str),
}

/// The cells of a line. A quotation mark counts only around a whole cell.
struct Cells<'a>(Option<&'a str>, char);

impl<'a> Iterator for Cells<'a> {
    type Item = Cell<'a>;

    fn next(&mut self) -> Option<Cell<'a>> {
        let Self(line, between) = self;
        let left = (*line)?;
        let quoted = left.strip_prefix('"').and_then(|left| {
            let (cell, after) = left.split_once('"')?;
            let after = match after.strip_prefix(*between) {
                Some(after) => Some(after),
                None if after.is_empty() => None,
                None => return None,
            };
            Some((cell, after))
        });
        if let Some((cell, after)) = quoted {
            *line = after;
            return Some(Cell::Quoted(cell));
        }
        let (cell, after) = match left.split_once(*between) {
            Some((cell, after)) => (cell, Some(after)),
            None => (left, None),
        };
        *line = after;
        Some(Cell::Plain(cell))
    }
}

fn text_of(bytes: &[u8]) -> Result<Cow<'_, str>, NoText> {
    let wide = |unit: fn([u8; 2]) -> u16| {
        let units = bytes.chunks_exact(2).skip(1);
        let units = units.map(|pair| unit([pair[0], pair[1]]));
        let text = char::decode_utf16(units).collect::<Result<String, _>>();
        text.map(Cow::Owned).map_err(|_| NoText)
    };
    match bytes {
        [0xff, 0xfe, ..] => wide(u16::from_le_bytes),
        [0xfe, 0xff, ..] => wide(u16::from_be_bytes),
        [0xef, 0xbb, 0xbf, text @ ..] | text => narrow(text).ok_or(NoText),
    }
}

/// Text with some damaged bytes is text; what is mostly others, or holds zeros, is none.
fn narrow(bytes: &[u8]) -> Option<Cow<'_, str>> {
    let text = String::from_utf8_lossy(bytes);
    let (mut damaged, mut all) = (0, 0);
    for letter in text.chars() {
        all += 1;
        damaged += usize::from(letter == char::REPLACEMENT_CHARACTER || letter == '\0');
    }
    (16 * damaged <= all).then_some(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLAIN: &str = "dt_ms,left_cm\r\n60,1.5\r\n";

    #[test]
    fn what_a_spanish_spreadsheet_writes_is_read_as_what_it_was() {
        let semicolons = PLAIN.replace(',', ";").replace('.', ",");
        let tabs = semicolons.replace(';', "\t");
        let wide: Vec<u8> = [0xfeff]
            .into_iter()
            .chain(tabs.encode_utf16())
            .flat_map(u16::to_le_bytes)
            .collect();
        let marked = ["\u{feff}", PLAIN].concat();
        for bytes in [
            PLAIN.as_bytes(),
            semicolons.as_bytes(),
            tabs.as_bytes(),
            &wide,
            marked.as_bytes(),
        ] {
            assert_eq!(plain(bytes).unwrap(), PLAIN);
        }
    }

    #[test]
    fn lines_that_end_as_on_an_old_macintosh_are_lines() {
        assert_eq!(plain(b"a;b\r1,5;2\r").unwrap(), "a,b\n1.5,2\n");
        assert_eq!(plain(b"a,b\r1.5,2\r").unwrap(), "a,b\n1.5,2\n");
    }

    #[test]
    fn points_in_the_numbers_may_stay_where_semicolons_part_them() {
        assert_eq!(plain(b"a;b\n1.5;2\n").unwrap(), "a,b\n1.5,2\n");
        assert_eq!(plain(b"1;50,5;3\n").unwrap(), "1,50.5,3\n");
    }

    #[test]
    fn quoted_cells_and_a_line_that_names_the_separator_are_read_as_what_they_mean() {
        for text in [
            "sep=;\r\ndt_ms;left_cm\r\n60;1,5\r\n",
            "\"sep=;\"\r\n\"dt_ms\";\"left_cm\"\r\n\"60\";\"1,5\"\r\n",
            "SEP=|\r\ndt_ms|left_cm\r\n60|1.5\r\n",
            "\"dt_ms\",\"left_cm\"\r\n60,\"1,5\"\r\n",
            "\"dt_ms\",\"left_cm\"\r\n\"60\",\"1.5\"\r\n",
            // A capture in a spreadsheet's first column.
            "\"dt_ms,left_cm\"\r\n\"60,1.5\"\r\n",
        ] {
            assert_eq!(plain(text.as_bytes()).unwrap(), PLAIN, "{text}");
        }
        // A quotation mark within a cell, or one that is left open, is no quotation.
        for text in ["title = \"t\"\n", "\"60,1\n", "60,\"1\"5\n"] {
            assert_eq!(plain(text.as_bytes()).unwrap(), text);
        }
    }

    #[test]
    fn a_damaged_byte_damages_its_line_only() {
        let text = plain(b"dt_ms,left_cm\n60,1.5\n6\xff,1.5\n60,1.5\n").unwrap();
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!((lines[1], lines[3]), ("60,1.5", "60,1.5"));
    }

    #[test]
    fn what_is_no_text_is_refused() {
        assert_eq!(plain(&[0x7f, b'E', 0xff, 0x00]), Err(NoText));
        assert_eq!(plain(&[0xff, 0xfe, 0x00, 0xd8]), Err(NoText));
    }
}
