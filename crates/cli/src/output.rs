//! What goes to stdout: lines, JSON and aligned tables. A reader who stops reading ends the command quietly.

use crate::failure::Failure;
use serde::Serialize;
use std::io::Write;
use std::path::Path;

/// Prints one line and flushes it, so that a program that reads us sees it at once.
pub(crate) fn line(text: &str) -> Result<(), Failure> {
    let mut stdout = std::io::stdout().lock();
    writeln!(stdout, "{text}")?;
    Ok(stdout.flush()?)
}

/// Prints a value as one line of JSON.
pub(crate) fn json(value: &impl Serialize) -> Result<(), Failure> {
    let text = serde_json::to_string(value).map_err(Failure::input)?;
    line(&text)
}

/// A path as text, whatever bytes its name is made of.
pub(crate) fn shown(path: &Path) -> String {
    path.display().to_string()
}

/// Prints rows with their columns aligned, each row indented by two spaces.
pub(crate) fn table(rows: &[Vec<String>]) -> Result<(), Failure> {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| {
        let cells = rows.iter().filter_map(|row| row.get(column));
        cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..columns).map(width).collect();
    for row in rows {
        let cells = row
            .iter()
            .zip(&widths)
            .map(|(cell, width)| format!("{cell:width$}"));
        line(format!("  {}", cells.collect::<Vec<_>>().join("  ")).trim_end())?;
    }
    Ok(())
}

/// A number as a person reads it: four significant digits, no trailing zeros.
pub(crate) fn figure(value: f64) -> String {
    if !value.is_finite() || value == 0.0 {
        return format!("{value}");
    }
    let magnitude = value.abs().log10().floor();
    if !(-4.0..9.0).contains(&magnitude) {
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

#[cfg(test)]
mod tests {
    use super::figure;

    #[test]
    fn figures_keep_four_significant_digits() {
        for (value, shown) in [
            (0.0, "0"),
            (2.4, "2.4"),
            (0.001_234_56, "0.001235"),
            (1234.56, "1235"),
            (-0.3, "-0.3"),
        ] {
            assert_eq!(figure(value), shown);
        }
    }
}
