//! CSVs as spreadsheets write them: semicolons or tabulators between the columns, commas in the numbers, UTF-16, a byte-order mark.

use std::borrow::Cow;

/// The text of a CSV of numbers with commas between the columns and points in the numbers, whatever stood there. Lines stay lines.
///
/// # Errors
/// Bytes that are no text.
pub fn plain(bytes: &[u8]) -> Result<Cow<'_, str>, String> {
    let text = text_of(bytes)?;
    let count = |mark| {
        text.lines()
            .next()
            .unwrap_or_default()
            .matches(mark)
            .count()
    };
    // A row of numbers has at most one comma in each.
    let parts = |mark: &char| count(*mark) > 0 && count(',') <= count(*mark) + 1;
    let Some(between) = [';', '\t'].into_iter().find(parts) else {
        return Ok(text);
    };
    let mark = |mark| match mark {
        ',' => '.',
        _ if mark == between => ',',
        _ => mark,
    };
    Ok(text.chars().map(mark).collect())
}

fn text_of(bytes: &[u8]) -> Result<Cow<'_, str>, String> {
    let wide = |unit: fn([u8; 2]) -> u16| {
        let units = bytes.chunks_exact(2).skip(1);
        let units = units.map(|pair| unit([pair[0], pair[1]]));
        char::decode_utf16(units).collect::<Result<String, _>>()
    };
    let none = || "is no text; give a CSV".to_owned();
    match bytes {
        [0xff, 0xfe, ..] => wide(u16::from_le_bytes).map(Cow::Owned).map_err(|_| none()),
        [0xfe, 0xff, ..] => wide(u16::from_be_bytes).map(Cow::Owned).map_err(|_| none()),
        [0xef, 0xbb, 0xbf, text @ ..] => std::str::from_utf8(text)
            .map(Cow::Borrowed)
            .map_err(|_| none()),
        text => std::str::from_utf8(text)
            .map(Cow::Borrowed)
            .map_err(|_| none()),
    }
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
    fn points_in_the_numbers_may_stay_where_semicolons_part_them() {
        assert_eq!(plain(b"a;b\n1.5;2\n").unwrap(), "a,b\n1.5,2\n");
        assert_eq!(plain(b"1;50,5;3\n").unwrap(), "1,50.5,3\n");
    }

    #[test]
    fn what_is_no_text_is_refused() {
        assert!(plain(&[0x7f, b'E', 0xff, 0x00]).is_err());
        assert!(plain(&[0xff, 0xfe, 0x00, 0xd8]).is_err());
    }
}
