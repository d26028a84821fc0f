//! Ranges of a recorded run, from the original program's CSV.

use crate::error::IdentifyError;
use crate::log::{DAMAGED_IN, name_of};
use std::path::Path;

/// The ranges of a recorded run of modes 1 to 4.
#[derive(Clone, Debug, PartialEq)]
pub struct SonarLog {
    /// File name without folder.
    pub name: String,
    /// Time of each row since the first.
    pub t_s: Vec<f64>,
    /// True where the bridge drove either wheel.
    pub driven: Vec<bool>,
    /// Readings by sonar (left, right), in the order they were pinged; one series if the run used one sonar.
    pub range_m: Vec<Vec<f64>>,
}

impl SonarLog {
    /// Reads a CSV of the original program's modes 1 to 4.
    ///
    /// # Errors
    /// A file that cannot be read, lacks a column, or holds something that is no number.
    pub fn read(path: &Path) -> Result<Self, IdentifyError> {
        let text = std::fs::read_to_string(path);
        let text = text.map_err(|cause| IdentifyError::read(path, cause))?;
        Self::parse(path, &text)
    }

    /// Reads the same from memory; `path` is for messages and the name.
    ///
    /// # Errors
    /// As [`SonarLog::read`].
    pub fn parse(path: &Path, text: &str) -> Result<Self, IdentifyError> {
        let error = |line: u64, cause: String| IdentifyError::Row {
            path: path.into(),
            line,
            cause,
        };
        let mut reader = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .from_reader(text.as_bytes());
        let bad = |cause: csv::Error| match cause.position() {
            Some(at) => error(at.line(), cause.to_string()),
            None => IdentifyError::read(path, cause),
        };
        let header = reader.headers().map_err(bad)?.clone();
        let mut columns = [0; 5];
        for (column, name) in columns.iter_mut().zip(COLUMNS) {
            let place = header.iter().position(|field| field == name);
            *column = place.ok_or_else(|| {
                error(1, format!("no column `{name}`: not a log of modes 1 to 4"))
            })?;
        }
        let (mut t_s, mut driven, mut left_m, mut right_m) = (vec![], vec![], vec![], vec![]);
        let mut now_s = 0.0;
        let mut damaged = Vec::new();
        for record in reader.records() {
            let values = record.map_err(bad).and_then(|record| {
                let line = record.position().map_or(0, csv::Position::line);
                values_of(&record, columns).map_err(|cause| error(line, cause))
            });
            match values {
                Ok([dt_ms, left_cm, right_cm, pwm_a, pwm_b]) => {
                    now_s += dt_ms * 1e-3;
                    t_s.push(now_s);
                    driven.push(pwm_a != 0.0 || pwm_b != 0.0);
                    left_m.push(left_cm * 0.01);
                    right_m.push(right_cm * 0.01);
                }
                Err(error) => damaged.push(error),
            }
        }
        // The same share as of a drive's log.
        if damaged.len() > t_s.len() / DAMAGED_IN {
            return Err(damaged.swap_remove(0));
        }
        Ok(Self {
            name: name_of(path),
            t_s,
            driven,
            // Mode 1 has one sonar and writes its reading twice.
            range_m: match left_m == right_m {
                true => vec![left_m],
                false => vec![left_m, right_m],
            },
        })
    }
}

/// What a log of the modes with sonars has.
const COLUMNS: [&str; 5] = ["dt_ms", "left_cm", "right_cm", "pwm_a", "pwm_b"];

/// The values of these columns of a row, or which one is no number.
fn values_of(record: &csv::StringRecord, columns: [usize; 5]) -> Result<[f64; 5], String> {
    let mut values = [0.0; 5];
    for ((value, column), name) in values.iter_mut().zip(columns).zip(COLUMNS) {
        let field = record.get(column).unwrap_or_default();
        let number = field.parse().ok();
        *value = number
            .filter(|number: &f64| number.is_finite())
            .ok_or_else(|| format!("`{name}` is `{field}`, not a number"))?;
    }
    Ok(values)
}
