//! Tables and bags of other programs as logs: the signals that were named, and all other columns as numbers.

use super::columns::{Taken, taken};
use super::guess::{self, Guess};
use super::made::{Made, Samples, Signals, rows};
use super::table::{self, Table, Unread, UnreadCells};
use crate::args::ImportArgs;
use crate::column_names::Role;
use crate::failure::Failure;
use crate::output::{self, figure};
use crate::place::{self, Guard};
use rumbo_ros::recorded::{Recorded, Series, recorded};
use serde_json::json;
use std::path::Path;

/// A speed is that of this time at least, where a column counts \[s\]: fewer counts are no speed.
const LEAST_S: f64 = 0.05;
/// Numbers besides the signals.
const MOST_NUMBERS: usize = 64;
/// Longest log \[s\].
const LONGEST_S: f64 = 604_800.0;

/// What a file of another program holds.
struct Held {
    series: Vec<Series>,
    /// The samples have their times; else the numbers of their rows.
    timed: bool,
    unread: Unread,
}

/// Imports a bag or a log of another program: its types say what is what.
pub(super) fn import_bag(
    args: &ImportArgs,
    bytes: &[u8],
    out: &Path,
    guard: &Guard,
) -> Result<(), Failure> {
    let shown = args.file.display();
    let Recorded { series, notes } = recorded(bytes).ok_or_else(|| {
        Failure::Input(format!(
            "{shown}: is damaged, or no bag of ROS 2: it has no tables of topics and messages"
        ))
    })?;
    for note in notes {
        output::note(&format!("{shown}: {note}"));
    }
    if series.is_empty() {
        return Err(Failure::Input(format!(
            "{shown}: holds no message with numbers that can be read: those in CDR with definitions in `ros2msg`, or in JSON"
        )));
    }
    let held = Held {
        series,
        timed: true,
        unread: Unread::default(),
    };
    let asked = match args.columns.is_empty() {
        true => &["auto".to_owned()][..],
        false => &args.columns,
    };
    held.import(args, asked, out, guard)
}

/// Imports a table, or shows what its columns may be; `false` if the text is no table.
pub(super) fn import_table(
    args: &ImportArgs,
    text: &str,
    out: &Path,
    guard: &Guard,
) -> Result<bool, Failure> {
    let Some(Table {
        columns,
        rows,
        left_out,
        unread,
    }) = table::read(&args.file, text)?
    else {
        return match args.columns.is_empty() {
            true => Ok(false),
            false => Err(Failure::Input(format!(
                "{}: is no table: it needs two rows, and most of them with a number and as many cells as the header",
                args.file.display()
            ))),
        };
    };
    left_out.report(&args.file);
    let held = Held {
        series: columns,
        timed: false,
        unread,
    };
    match args.columns.is_empty() {
        true => held.preview(args, rows)?,
        false => held.import(args, &args.columns, out, guard)?,
    }
    Ok(true)
}

/// What to write where a guess leaves something open.
fn remedies(guesses: &[Guess]) -> Result<(), Failure> {
    let has = |test: &dyn Fn(&Guess) -> bool| guesses.iter().any(test);
    if !has(&|guess| guess.name.starts_with("t_") || guess.name.starts_with("dt_")) {
        output::line("  no column is a time: write the time between two rows, as dt_ms=20")?;
    }
    if has(&|guess| guess.divisor == Some("COUNTS")) {
        output::line(
            "  COUNTS is what a whole turn of the wheel counts, as 748 or, for a disc of 20 slots, 20 or 40",
        )?;
    }
    if has(&|guess| guess.divisor == Some("RADIUS")) {
        output::line("  RADIUS is that of the wheel in m, as 0.0325, in mm for mm/s")?;
    }
    if has(&|guess| !guess.is_sure && guess.divisor.is_none()) {
        output::line(
            "  what has a ? is guessed, its unit too; the names there are: rumbo import --help",
        )?;
    }
    Ok(())
}

impl Held {
    /// What the columns may be, and the command that imports them so.
    fn preview(&self, args: &ImportArgs, rows: usize) -> Result<(), Failure> {
        let guesses = guess::guess(&self.series, self.timed);
        let of = |index: usize| guesses.iter().find(|guess| guess.column == index);
        let command = command(&args.file, &guesses, &self.series);
        if args.json {
            let columns = self.series.iter().enumerate().map(|(index, column)| {
                let guess = of(index).map(|guess| guess.name.as_str());
                let is_sure = of(index).is_some_and(|guess| guess.is_sure);
                json!({ "column": column.name, "taken_as": guess, "certain": is_sure })
            });
            let columns: Vec<_> = columns.collect();
            return output::json(
                &json!({ "log": null, "rows": rows, "columns": columns, "command": command }),
            );
        }
        let shown = args.file.display();
        output::line(&format!(
            "{shown}: a table of another program, {}; nothing is written yet",
            output::counted(rows, "row")
        ))?;
        let mut table = vec![
            ["#", "column", "first", "min", "max", "may be"]
                .map(String::from)
                .to_vec(),
        ];
        for (index, column) in self.series.iter().enumerate() {
            let values = || column.samples.iter().map(|(_, value)| *value);
            // A sonar that never heard anything has no values.
            let figure_of = |value: Option<f64>| value.map_or_else(String::new, figure);
            let is = of(index).map_or_else(String::new, |guess| {
                let doubt = if guess.is_sure { "" } else { " ?" };
                format!("{}{doubt}", guess.name)
            });
            table.push(vec![
                (index + 1).to_string(),
                column.name.clone(),
                figure_of(values().next()),
                figure_of(values().reduce(f64::min)),
                figure_of(values().reduce(f64::max)),
                is,
            ]);
        }
        output::table(&table)?;
        output::remark(&format!("import it: {command}"))?;
        remedies(&guesses)
    }

    fn import(
        &self,
        args: &ImportArgs,
        asked: &[String],
        out: &Path,
        guard: &Guard,
    ) -> Result<(), Failure> {
        let shown = args.file.display();
        let wrong = |what: String| Failure::Input(format!("{shown}: {what}"));
        let taken = taken(asked, &self.series, self.timed).map_err(wrong)?;
        let made = self.log(&taken).map_err(wrong)?;
        let name = args.file.file_name().unwrap_or(args.file.as_os_str());
        let log = made
            .encode(&name.to_string_lossy(), &taken, &self.series)
            .map_err(|error| {
                // Memory takes all.
                wrong(error.to_string())
            })?;
        guard.make_equal(out, |place| {
            std::fs::write(place, &log).map_err(|error| place::unwritable(out, &error))
        })?;
        for note in made.notes.iter().chain(&self.notes_on(&taken)) {
            output::note(&format!("{shown}: {note}"));
        }
        made.sum_up(out, &taken, &self.series, args.json)
    }

    /// What of the columns that were named could not be read.
    fn notes_on(&self, taken: &[Taken]) -> Vec<String> {
        let columns = taken.iter().filter_map(|one| self.series.get(one.column?));
        let notes = columns.filter_map(|Series { name, .. }| {
            let UnreadCells { count, line, first } = self.unread.get(name)?;
            let values = output::counted(*count, "value");
            Some(format!(
                "{name}: {values} left out, the first is `{first}` in line {line}: no finite number"
            ))
        });
        notes.collect()
    }

    /// Times of all samples \[s\], and what is taken of them.
    fn log(&self, taken: &[Taken]) -> Result<Made, String> {
        let mut notes = Vec::new();
        let series = match self.timed {
            true => self.series.clone(),
            false => self.with_times(taken, &mut notes)?,
        };
        let mut signals: Vec<Signals> = Vec::new();
        let mut numbers: Vec<(String, Samples)> = Vec::new();
        for one in taken {
            let Some(column) = one.column.and_then(|column| series.get(column)) else {
                continue;
            };
            let scaled = column
                .samples
                .iter()
                .map(|(t_s, value)| (*t_s, value * one.factor));
            let scaled: Samples = scaled.collect();
            match one.role {
                Role::Time | Role::Period => {}
                Role::Number(name) => numbers.push((name.to_owned(), scaled)),
                Role::Turned(names) => signals.push((names, speeds(&scaled))),
                Role::Signals(names) => {
                    check(one, column, names, &scaled)?;
                    signals.push((names, scaled));
                }
            }
        }
        let is_taken = |index: usize| taken.iter().any(|one| one.column == Some(index));
        let others = series
            .iter()
            .enumerate()
            .filter(|(index, column)| !is_taken(*index) && !column.samples.is_empty());
        let others: Vec<&Series> = others.map(|(_, column)| column).collect();
        if others.len() > MOST_NUMBERS {
            notes.push(format!(
                "{} columns are left out: more than {MOST_NUMBERS}",
                others.len() - MOST_NUMBERS
            ));
        }
        let others = others.into_iter().take(MOST_NUMBERS);
        numbers.extend(others.map(|column| (column.name.clone(), column.samples.clone())));
        let end_s = signals
            .iter()
            .map(|(_, samples)| samples)
            .chain(numbers.iter().map(|(_, samples)| samples));
        let end_s = end_s.flatten().map(|(t_s, _)| *t_s).fold(0.0, f64::max);
        if end_s > LONGEST_S {
            return Err(format!(
                "it lasts {end_s:.0} s: at most {LONGEST_S} s; is the unit of the time right?"
            ));
        }
        Ok(Made {
            rows: rows(&signals),
            numbers,
            end_s,
            notes,
        })
    }

    /// The columns with times instead of the numbers of rows. Rows that are not later than the one before are left out.
    fn with_times(&self, taken: &[Taken], notes: &mut Vec<String>) -> Result<Vec<Series>, String> {
        let one = taken
            .iter()
            .find(|one| matches!(one.role, Role::Time | Role::Period));
        let one = one.ok_or("no column has the times")?;
        let column = one.column.and_then(|column| self.series.get(column));
        let rows = self
            .series
            .iter()
            .filter_map(|column| column.samples.last());
        let rows = rows.map(|(row, _)| *row as usize + 1).max().unwrap_or(0);
        let mut given = vec![None; rows];
        match column {
            Some(column) => {
                for (row, value) in &column.samples {
                    given[*row as usize] = Some(value * one.factor);
                }
            }
            None => given.fill(Some(one.factor)),
        }
        let (mut times, mut back, mut now_s, mut first_s) = (vec![None; rows], 0, 0.0, None);
        for (row, value) in given.iter().enumerate() {
            let Some(value) = *value else {
                continue;
            };
            let t_s = match (one.role, row) {
                // The first row's period is the time before it.
                (Role::Period, 0) => 0.0,
                (Role::Period, _) => now_s + value,
                _ => value - *first_s.get_or_insert(value),
            };
            if row > 0 && t_s <= now_s {
                back += 1;
                continue;
            }
            now_s = t_s;
            times[row] = Some(t_s);
        }
        if 2 * back > rows {
            return Err(format!(
                "{} does not rise: it is no time; give another column",
                one.name
            ));
        }
        if back > 0 {
            notes.push(format!(
                "{} not later than the one before, left out",
                output::counted(back, "row")
            ));
        }
        let timed = self.series.iter().map(|column| {
            let samples = column.samples.iter();
            let samples = samples.filter_map(|(row, value)| Some((times[*row as usize]?, *value)));
            Series {
                samples: samples.collect(),
                ..column.clone()
            }
        });
        Ok(timed.collect())
    }
}

/// Refuses values that are in another unit.
fn check(
    one: &Taken,
    column: &Series,
    names: &[&str],
    scaled: &[(f64, f64)],
) -> Result<(), String> {
    let largest = scaled
        .iter()
        .fold(0.0_f64, |most, (_, value)| most.max(value.abs()));
    let is_pwm = names.iter().any(|name| name.ends_with("_pwm"));
    if is_pwm && largest > 255.5 {
        let most = column
            .samples
            .iter()
            .fold(0.0_f64, |most, (_, value)| most.max(value.abs()));
        return Err(format!(
            "{} reaches {} of 255: is another value full power? scale it, as {}={}*255/{}",
            one.name,
            figure(largest),
            one.name,
            column.name,
            figure(most)
        ));
    }
    Ok(())
}

/// Speeds of a wheel by how far it has turned.
fn speeds(angles: &[(f64, f64)]) -> Samples {
    let mut from = 0;
    let mut speeds = Vec::new();
    for (index, (t_s, angle)) in angles.iter().enumerate() {
        // The last sample that is old enough, or the one before.
        while from + 1 < index
            && angles
                .get(from + 1)
                .is_some_and(|(before_s, _)| t_s - before_s >= LEAST_S - 1e-9)
        {
            from += 1;
        }
        if let Some((before_s, before)) = angles.get(from).filter(|_| index > from) {
            speeds.push((*t_s, (angle - before) / (t_s - before_s)));
        }
    }
    speeds
}

/// The command that imports a table as it was guessed.
fn command(file: &Path, guesses: &[Guess], series: &[Series]) -> String {
    let columns: Vec<String> = guesses.iter().map(|guess| guess.text(series)).collect();
    let has_time = guesses
        .iter()
        .any(|guess| guess.name.starts_with("t_") || guess.name.starts_with("dt_"));
    let period = (!has_time).then(|| "dt_ms=MILLISECONDS".to_owned());
    let columns: Vec<String> = period.into_iter().chain(columns).collect();
    format!(
        "rumbo import {} --columns '{}'",
        output::quoted(file),
        columns.join(",")
    )
}
