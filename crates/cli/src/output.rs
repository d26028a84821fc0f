//! Output to stdout and stderr: lines, JSON and aligned tables. A closed output ends the command quietly.
//!
//! Titles, names, contents of logs and texts from a robot are printed only here, so that none of them can control the
//! terminal or forge a line ([`visible`]).

use crate::failure::Failure;
use crate::interrupt;
use serde::Serialize;
use std::borrow::Cow;
use std::io::Write;
use std::path::Path;
use std::process::ExitCode;

/// Whether a terminal obeys a character instead of showing it: control characters, ends of lines, and what changes
/// the direction of writing.
fn is_control(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// A text with everything that a terminal or a spreadsheet would obey escaped: `\n`, `\u{1b}`.
pub(crate) fn visible(text: &str) -> Cow<'_, str> {
    if !text.contains(is_control) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len() + 8);
    for c in text.chars() {
        match is_control(c) {
            true => shown.extend(c.escape_default()),
            false => shown.push(c),
        }
    }
    Cow::Owned(shown)
}

/// Prints one line and flushes it, so that a program that reads us sees it at once.
pub(crate) fn line(text: &str) -> Result<(), Failure> {
    let mut stdout = std::io::stdout().lock();
    writeln!(stdout, "{}", visible(text))?;
    Ok(stdout.flush()?)
}

/// Prints a text of several lines.
pub(crate) fn lines(text: &str) -> Result<(), Failure> {
    text.lines().try_for_each(line)
}

/// Prints a line set off from what came before.
pub(crate) fn remark(text: &str) -> Result<(), Failure> {
    line("")?;
    line(text)
}

/// Prints one line to stderr, apart from results. Ignores a closed stderr.
pub(crate) fn aside(text: &str) {
    let _ = writeln!(std::io::stderr(), "{}", visible(text));
}

/// The same for a note beside the result.
pub(crate) fn note(text: &str) {
    aside(&format!("note: {text}"));
}

/// Prints a value as one line of JSON.
pub(crate) fn json(value: &impl Serialize) -> Result<(), Failure> {
    let text = serde_json::to_string(value).map_err(Failure::input)?;
    // What JSON itself leaves as it is stands in texts, where this is another way to write it.
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        match is_control(c) {
            true => shown += &format!("\\u{:04x}", u32::from(c)),
            false => shown.push(c),
        }
    }
    line(&shown)
}

/// A path as text, whatever bytes its name is made of.
pub(crate) fn shown(path: &Path) -> String {
    path.display().to_string()
}

/// A path as a shell takes it for one word, in a command to be copied.
pub(crate) fn quoted(path: &Path) -> String {
    let text = shown(path);
    let is_plain =
        |c: char| c.is_alphanumeric() || "_-./:+@,%".contains(c) || cfg!(windows) && c == '\\';
    match text.chars().all(is_plain) {
        true => text,
        false => format!("'{}'", text.replace('\'', "'\\''")),
    }
}

/// Prints rows with their columns aligned, each row indented by two spaces.
pub(crate) fn table(rows: &[Vec<String>]) -> Result<(), Failure> {
    let shown = |row: &Vec<String>| -> Vec<String> {
        row.iter().map(|cell| visible(cell).into_owned()).collect()
    };
    let rows: Vec<Vec<String>> = rows.iter().map(shown).collect();
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| {
        let cells = rows.iter().filter_map(|row| row.get(column));
        cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..columns).map(width).collect();
    for row in &rows {
        let cells = row
            .iter()
            .zip(&widths)
            .map(|(cell, width)| format!("{cell:width$}"));
        line(format!("  {}", cells.collect::<Vec<_>>().join("  ")).trim_end())?;
    }
    Ok(())
}

/// So many of a thing, by its singular: `1 log`, `2 logs`.
pub(crate) fn counted(count: usize, of: &str) -> String {
    let plural = if count == 1 { "" } else { "s" };
    format!("{count} {of}{plural}")
}

/// A number as a person reads it: four significant digits, no trailing zeros.
pub(crate) fn figure(value: f64) -> String {
    if !value.is_finite() || value == 0.0 {
        return format!("{value}");
    }
    let magnitude = value.abs().log10().floor();
    if !(-7.0..9.0).contains(&magnitude) {
        return format!("{value:.3e}");
    }
    let decimals = (3.0 - magnitude).max(0.0) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

/// A metric is no number where what it measures did not happen, such as settling.
pub(crate) fn in_words(value: f64) -> String {
    if value.is_nan() {
        "never".into()
    } else {
        figure(value)
    }
}

/// Prints why a command has failed to stderr, and returns the exit status.
pub(crate) fn report(failure: Failure) -> ExitCode {
    let print = |lines: &[String], before: &str| {
        lines
            .iter()
            .for_each(|line| aside(&format!("{before}{line}")));
        ExitCode::from(2)
    };
    match failure {
        Failure::LimitMissed => ExitCode::from(1),
        Failure::Interrupted => ExitCode::from(interrupt::STATUS),
        Failure::Input(text) => print(&[text], "error: "),
        Failure::Inputs(lines) => print(&lines, "error: "),
        Failure::Rejected(lines) => print(&lines, ""),
        Failure::ReaderGone => ExitCode::SUCCESS,
    }
}

#[cfg(test)]
mod tests {
    use super::{figure, quoted, visible};
    use std::path::Path;

    #[test]
    fn a_path_in_a_command_is_one_word_of_a_shell() {
        for (path, shown) in [
            ("señal/wall-2.toml", "señal/wall-2.toml"),
            ("my robot.toml", "'my robot.toml'"),
            ("o'brien $x", "'o'\\''brien $x'"),
        ] {
            assert_eq!(quoted(Path::new(path)), shown);
        }
    }

    #[test]
    fn what_a_terminal_would_obey_is_shown_escaped() {
        for (text, shown) in [
            (
                "Motor de la derecha: 12 °C, 3 → 5",
                "Motor de la derecha: 12 °C, 3 → 5",
            ),
            ("a\n  ok", "a\\n  ok"),
            ("\u{1b}[2K\u{9b}1A\u{7f}", "\\u{1b}[2K\\u{9b}1A\\u{7f}"),
            ("\u{202e}ssap", "\\u{202e}ssap"),
        ] {
            assert_eq!(visible(text), shown);
        }
    }

    #[test]
    fn figures_keep_four_significant_digits() {
        for (value, shown) in [
            (0.0, "0"),
            (2.4, "2.4"),
            (0.001_234_56, "0.001235"),
            (4.446e-5, "0.00004446"),
            (1234.56, "1235"),
            (-0.3, "-0.3"),
        ] {
            assert_eq!(figure(value), shown);
        }
    }
}
