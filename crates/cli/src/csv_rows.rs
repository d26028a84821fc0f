//! The rows of a CSV of the original program: checked, in SI units, with their times.
//!
//! A truncated or damaged row is skipped and reported, as long as more of them are valid; so is a header, where the
//! rows determine their kind. A file that is mostly damaged is rejected, with its first error.

use crate::failure::Failure;
use crate::left_out::LeftOut;
use rumbo_wire::csv;
use rumbo_wire::text::{RowKind, TextRow};
use std::f64::consts::PI;
use std::path::Path;

/// Most of a first line that an error shows \[characters\]: every header has fewer.
const MOST_SHOWN: usize = 160;

/// Conversion of a column: its unit's factor, and the limits of its values.
pub(crate) struct Column {
    original: &'static csv::Column,
    pub(crate) name: String,
    factor: f64,
    min: f64,
    max: f64,
}

/// A checked recording, in SI units.
pub(crate) struct Recording {
    pub(crate) modes: &'static str,
    pub(crate) columns: Vec<Column>,
    /// Time since the first row, in s, and the row's values.
    pub(crate) rows: Vec<(f64, Vec<f64>)>,
    pub(crate) longest_gap_s: f64,
    /// The valid rows under their header, unchanged.
    pub(crate) sound: String,
    /// The skipped lines.
    pub(crate) left_out: LeftOut,
}

impl Column {
    /// Converts a column: units to SI, motor A to the right wheel and B to the left one.
    fn of(original: &'static csv::Column) -> Self {
        let (unit, factor) = match original.unit {
            "cm" => ("_m", 0.01),
            "rpm" => ("_rad_s", PI / 30.0),
            "deg" => ("_rad", PI / 180.0),
            "m" => ("_m", 1.0),
            _ => ("", 1.0),
        };
        let suffix = format!("_{}", original.unit);
        let stem = original
            .name
            .strip_suffix(suffix.as_str())
            .unwrap_or(original.name);
        let stem = match stem {
            "left" | "right" | "front" => format!("{stem}_range"),
            "pwm_a" => "right_pwm".into(),
            "pwm_b" => "left_pwm".into(),
            "speed_a" => "right_speed".into(),
            "speed_b" => "left_speed".into(),
            "reference_a" => "right_reference".into(),
            "reference_b" => "left_reference".into(),
            other => other.to_owned(),
        };
        let (min, max) = match original.name {
            "pwm_a" | "pwm_b" => (-255.0, 255.0),
            "mode" => (0.0, 8.0),
            "state" => (0.0, 15.0),
            "dt_ms" => (0.0, 600_000.0),
            _ => (-1e6, 1e6),
        };
        Self {
            original,
            name: format!("{stem}{unit}"),
            factor,
            min,
            max,
        }
    }
}

/// The modes whose rows look like this.
fn modes(kind: RowKind) -> &'static str {
    match kind {
        RowKind::Distance => "modes 1 to 4",
        RowKind::Speed => "modes 5 and 6",
        RowKind::Waypoints => "mode 7",
        RowKind::Mission => "mode 8",
    }
}

fn header_of(kind: RowKind) -> String {
    kind.columns()
        .iter()
        .map(|column| column.name)
        .collect::<Vec<_>>()
        .join(",")
}

/// Whether a text is such a recording, or nearly.
pub(crate) fn is_one(text: &str) -> bool {
    let header = text.lines().next().unwrap_or_default();
    csv::recognise(header).is_some()
        || nearest(header).is_some()
        || kind_by_rows(header, text).is_some()
}

/// The kind whose header a line nearly is.
fn nearest(header: &str) -> Option<RowKind> {
    let found: Vec<&str> = header.split(',').map(str::trim).collect();
    let matching = |kind: &RowKind| {
        let due = kind.columns().iter().map(|column| column.name);
        due.filter(|name| found.contains(name)).count()
    };
    let nearest = RowKind::ALL.into_iter().max_by_key(matching);
    // Others have an x_m and a y_m too.
    nearest.filter(|kind| 2 * matching(kind) > kind.columns().len())
}

/// The columns that an unknown header lacks.
fn unknown(header: &str) -> String {
    // Where lines end otherwise, all of the file is its first line.
    let shown: String = header.chars().take(MOST_SHOWN).collect();
    match nearest(header) {
        Some(kind) => format!(
            "`{shown}` is no header of the original program; the nearest is that of {}: {}; --columns takes any table",
            modes(kind),
            header_of(kind)
        ),
        None => format!(
            "`{shown}` is neither the beginning of a table nor a line of a capture; `rumbo import --help` shows what is read"
        ),
    }
}

/// The kind of most rows, where the first line is a damaged header.
fn kind_by_rows(header: &str, text: &str) -> Option<RowKind> {
    let names = RowKind::ALL.iter().flat_map(|kind| kind.columns());
    let known = |name: &str| names.clone().any(|column| column.name == name);
    if header.split(',').filter(|name| known(name.trim())).count() < 3 {
        return None;
    }
    let lines = || {
        text.lines()
            .skip(1)
            .map(str::trim)
            .filter(|row| !row.is_empty())
    };
    let of = |kind: &RowKind| {
        let rows = lines().filter(|line| TextRow::parse(line).is_ok_and(|row| row.kind() == *kind));
        2 * rows.count() > lines().count()
    };
    RowKind::ALL.into_iter().find(of)
}

/// A row's values in their own units; if it is no sound row, what is wrong with it.
fn values(columns: &[Column], row: &str, kind: RowKind) -> Result<Vec<f64>, Failure> {
    let fields: Vec<&str> = row.split(',').map(str::trim).collect();
    if fields.len() != columns.len() {
        let (found, due) = (fields.len(), columns.len());
        let header = header_of(kind);
        return Err(Failure::Input(format!(
            "{found} values in a row of {due} columns; expected {header}"
        )));
    }
    let value = |(column, field): (&Column, &str)| {
        let Column {
            original, min, max, ..
        } = column;
        let value = field
            .parse::<f64>()
            .ok()
            .filter(|value| (*min..=*max).contains(value));
        value.ok_or_else(|| {
            Failure::Input(format!(
                "{} = `{field}`: must be a number within {min}..{max}",
                original.name
            ))
        })
    };
    columns.iter().zip(fields).map(value).collect()
}

/// The period at the beginning of a damaged row [ms], if that is whole.
fn period_ms(row: &str, columns: &[Column]) -> Option<f64> {
    let (first, _) = row.split_once(',')?;
    let dt = columns.first()?;
    let value = first.trim().parse::<f64>().ok()?;
    (dt.min..=dt.max).contains(&value).then_some(value)
}

/// Reads a recording.
///
/// # Errors
/// No header of the original program, no rows, or as many damaged ones as sound ones.
pub(crate) fn parse(path: &Path, text: &str) -> Result<Recording, Failure> {
    let wrong =
        |line: usize, what: String| Failure::Input(format!("{}:{line}: {what}", path.display()));
    let mut left_out = LeftOut::default();
    let mut lines = (1..).zip(text.lines().map(str::trim));
    let header = lines.next().unwrap_or_default().1;
    let by_rows = || {
        let kind = kind_by_rows(header, text)?;
        let of = modes(kind);
        left_out.header(format!(
            "`{header}` is no header; by its rows it is of {of}"
        ));
        Some(kind)
    };
    let kind = csv::recognise(header).or_else(by_rows);
    let kind = kind.ok_or_else(|| wrong(1, unknown(header)))?;
    let columns: Vec<Column> = kind.columns().iter().map(Column::of).collect();
    let mut sound = header_of(kind) + "\n";
    let (mut rows, mut time_s, mut longest_gap_s) = (Vec::new(), 0.0, 0.0_f64);
    // Since the last valid row, with an estimate for rows whose time is damaged.
    let (mut gap_s, mut usual_s) = (0.0, 0.0);
    for (line, row) in lines.filter(|(_, row)| !row.is_empty()) {
        let values = match values(&columns, row, kind) {
            Ok(values) => values,
            Err(what) => {
                gap_s += period_ms(row, &columns).map_or(usual_s, |ms| ms / 1000.0);
                left_out.row(line, what.to_string());
                continue;
            }
        };
        let dt_s = values.first().copied().unwrap_or_default() / 1000.0;
        gap_s += dt_s;
        // The first row's period is the time the program waited before the run.
        if !rows.is_empty() {
            time_s += gap_s;
            longest_gap_s = longest_gap_s.max(gap_s);
            usual_s = dt_s;
        }
        gap_s = 0.0;
        sound = sound + row + "\n";
        let scaled = std::iter::zip(&columns, values);
        rows.push((
            time_s,
            scaled
                .map(|(column, value)| value * column.factor)
                .collect(),
        ));
    }
    if let Some((line, what)) = left_out.too_much(rows.len()) {
        return Err(wrong(line, what));
    }
    if rows.is_empty() {
        return Err(wrong(
            1,
            "no rows under the header; is the recording complete?".into(),
        ));
    }
    Ok(Recording {
        modes: modes(kind),
        columns,
        rows,
        longest_gap_s,
        sound,
        left_out,
    })
}
