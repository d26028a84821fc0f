//! Reads the recordings of a folder.

use super::{FromLog, NotShown, Real, RealError, RealRun, Skipped};
use rumbo_experiment::files::bounded::{LONGEST_RECORDING, read_at_most};
use rumbo_identify::dialect;
use rumbo_wire::csv;
use rumbo_wire::text::{RowKind, TextRow};
use std::path::{Path, PathBuf};

/// Reads all CSVs of a folder, and its logs through `log`, which returns the run in a log or why it is not shown.
///
/// # Errors
/// A folder or a file that cannot be read, or a row that is damaged.
pub fn read(
    folder: &Path,
    log: impl Fn(&Path) -> Result<FromLog, NotShown>,
) -> Result<Real, RealError> {
    let files = recordings(folder)?;
    let mut real = Real::default();
    for path in files {
        let file = path
            .file_name()
            .map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        let skip = |why| Skipped {
            file: file.clone(),
            why,
        };
        let found = match (path.is_file(), is_a(&path, "mcap")) {
            (true, true) => log(&path),
            (true, false) => Ok(csv_of(&path)?),
            // A pipe or a device: to open one may wait for ever.
            (false, true) => Err(NotShown::NoLog),
            (false, false) => Err(NotShown::Header),
        };
        let FromLog { csv: text, ours } = match found {
            Ok(found) => found,
            Err(why) => {
                real.skipped.push(skip(why));
                continue;
            }
        };
        let Some(kind) = csv::recognise(text.lines().next().unwrap_or_default()) else {
            real.skipped.push(skip(NotShown::Header));
            continue;
        };
        let rows = rows(&path, kind, &text)?;
        if rows.len() < 2 {
            real.skipped.push(skip(NotShown::Short));
            continue;
        }
        match scenario(&rows) {
            None => real.skipped.push(skip(NotShown::NoExperiment)),
            Some(scenario) if real.runs.contains_key(scenario) => {
                real.skipped.push(skip(NotShown::Another))
            }
            Some(scenario) => {
                real.runs.insert(scenario, RealRun { file, rows, ours });
            }
        }
    }
    Ok(real)
}

/// The CSVs and logs of a folder, by their names.
fn recordings(folder: &Path) -> Result<Vec<PathBuf>, RealError> {
    let remedy = "give --real a folder with recorded runs";
    let shown = folder.display();
    let unreadable =
        |error: std::io::Error| RealError(format!("{shown}: cannot be read ({error}); {remedy}"));
    let mut files: Vec<PathBuf> = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(unreadable)? {
        let path = entry.map_err(unreadable)?.path();
        if is_a(&path, "csv") || is_a(&path, "mcap") {
            files.push(path);
        }
    }
    files.sort();
    match files.is_empty() {
        true => Err(RealError(format!(
            "{shown}: holds no CSV and no log; {remedy}"
        ))),
        false => Ok(files),
    }
}

fn is_a(path: &Path, ending: &str) -> bool {
    path.extension()
        .is_some_and(|found| found.eq_ignore_ascii_case(ending))
}

/// A CSV, unchanged; one that is no text has no header of the original program.
fn csv_of(path: &Path) -> Result<FromLog, RealError> {
    let bytes = read_at_most(path, LONGEST_RECORDING).map_err(|error| {
        RealError(format!(
            "{}: cannot be read ({error}); take it out of the folder",
            path.display()
        ))
    })?;
    let csv = dialect::plain(&bytes).unwrap_or_default().into_owned();
    Ok(FromLog { csv, ours: false })
}

/// The rows with their times; the first row's period is the wait before the run and does not count.
fn rows(path: &Path, kind: RowKind, text: &str) -> Result<Vec<(f64, TextRow)>, RealError> {
    let mut rows: Vec<(f64, TextRow)> = Vec::new();
    let mut t_s = 0.0;
    for (index, line) in text.lines().enumerate().skip(1) {
        let line = line.trim();
        if line.is_empty() {
            continue;
        }
        let row = TextRow::parse_as(kind, line).map_err(|_| {
            let due = kind.columns().len();
            RealError(format!(
                "{}:{}: `{line}` is no row of {due} numbers; correct it, or take the log that `rumbo import` makes of the other rows",
                path.display(),
                index + 1
            ))
        })?;
        if !rows.is_empty() {
            t_s += f64::from(period_ms(&row)) * 1e-3;
        }
        rows.push((t_s, row));
    }
    Ok(rows)
}

fn period_ms(row: &TextRow) -> u32 {
    match row {
        TextRow::Distance(row) => row.dt_ms,
        TextRow::Speed(row) => row.dt_ms,
        TextRow::Waypoints(row) => row.dt_ms,
        TextRow::Mission(row) => row.dt_ms,
    }
}

/// The experiment to which these rows belong.
fn scenario(rows: &[(f64, TextRow)]) -> Option<&'static str> {
    let (_, first) = rows.first()?;
    match first {
        TextRow::Distance(row) => ["mode1", "mode2", "mode3", "mode4"]
            .get(usize::from(row.mode).wrapping_sub(1))
            .copied(),
        TextRow::Speed(row) => match row.mode {
            5 => Some("mode5"),
            6 => Some("mode6"),
            _ => None,
        },
        TextRow::Waypoints(_) => Some("mode7"),
        TextRow::Mission(_) => {
            let missions = || {
                rows.iter().filter_map(|(_, row)| {
                    if let TextRow::Mission(row) = row {
                        Some(row)
                    } else {
                        None
                    }
                })
            };
            if missions().all(|row| row.goal_x_m == 0.0 && row.goal_y_m == 0.0) {
                return Some("mode8-lane");
            }
            // States 4 and 5 sweep the servo: there was something in the way.
            let swept = missions().any(|row| row.state == 4 || row.state == 5);
            Some(if swept {
                "mode8-obstacles"
            } else {
                "mode8-goals"
            })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for (name, text) in files {
            std::fs::write(folder.path().join(name), text).unwrap();
        }
        folder
    }

    fn no_log(_: &Path) -> Result<FromLog, NotShown> {
        Err(NotShown::Short)
    }

    const DISTANCE: &str = "dt_ms,left_cm,right_cm,reference_cm,mode,pwm_a,pwm_b\n";

    #[test]
    fn files_find_their_experiment_and_what_matches_none_is_named() {
        let folder = folder(&[
            (
                "a.csv",
                &format!(
                    "{DISTANCE}9000,100,100,30,1,115,115\n60,99,99,30,1,115,115\n70,98,98,50,1,115,115\n"
                ),
            ),
            (
                "b.csv",
                &format!("{DISTANCE}60,100,100,30,1,115,115\n60,99,99,30,1,115,115\n"),
            ),
            ("c.csv", "time,value\n1,2\n"),
            ("notes.txt", "no CSV"),
        ]);
        let real = read(folder.path(), no_log).unwrap();
        let run = &real.runs["mode1"];
        assert_eq!(run.file, "a.csv");
        assert!(
            (run.duration_s() - 0.13).abs() < 1e-9,
            "the wait before the run does not count"
        );
        let references: Vec<i64> = run
            .references()
            .iter()
            .map(|(_, m)| (m * 100.0).round() as i64)
            .collect();
        assert_eq!(references, [30, 50]);
        let skipped: Vec<_> = real
            .skipped
            .iter()
            .map(|skipped| (skipped.file.as_str(), skipped.why))
            .collect();
        assert_eq!(
            skipped,
            [("b.csv", NotShown::Another), ("c.csv", NotShown::Header)]
        );
    }

    #[test]
    fn a_damaged_row_is_named_by_its_line() {
        let folder = folder(&[(
            "a.csv",
            &format!("{DISTANCE}60,100,100,30,1,115,115\n60,99,x,30,1,115,115\n"),
        )]);
        let error = read(folder.path(), no_log).unwrap_err().to_string();
        assert!(
            error.contains("a.csv:3:") && error.contains("`60,99,x"),
            "{error}"
        );
    }

    #[test]
    fn a_missing_or_empty_folder_is_an_error_with_the_remedy() {
        let empty = folder(&[]);
        for place in [empty.path(), Path::new("/no/such/folder")] {
            let error = read(place, no_log).unwrap_err().to_string();
            assert!(error.contains("--real"), "{error}");
        }
    }
}
