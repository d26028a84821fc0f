//! Tables of other programs as text: CSV with any columns, rows of the Serial Plotter, what the Serial Monitor copied.
//!
//! The time of a sample is the number of its row here: which column has the times is chosen later.

use crate::failure::Failure;
use crate::left_out::LeftOut;
use rumbo_ros::recorded::Series;
use rumbo_session::plotter_row;
use std::borrow::Cow;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::Path;

/// The column of the Serial Monitor's times of day.
pub(crate) const CLOCK: &str = "clock";
/// Columns of a table.
const MOST_COLUMNS: usize = 256;
/// Values of a table.
const MOST_VALUES: usize = 20_000_000;
/// Characters shown of a cell that is no number.
const LONGEST_CELL: usize = 24;
const DAY_S: f64 = 86_400.0;

/// A table, by columns.
#[derive(Debug)]
pub(crate) struct Table {
    pub(crate) columns: Vec<Series>,
    pub(crate) rows: usize,
    pub(crate) left_out: LeftOut,
    pub(crate) unread: Unread,
}

/// Cells that are no finite numbers, by column.
pub(crate) type Unread = BTreeMap<String, UnreadCells>;

/// How many, and the first of them.
#[derive(Debug)]
pub(crate) struct UnreadCells {
    pub(crate) count: usize,
    pub(crate) line: usize,
    pub(crate) first: String,
}

/// Reads a table whose cells commas part, or blanks where it has no commas; `None` if most of it is none.
///
/// # Errors
/// A larger table than is read.
pub(crate) fn read(path: &Path, text: &str) -> Result<Option<Table>, Failure> {
    let text = without_comments(text);
    let lines = || {
        let lines = (1..).zip(text.lines());
        lines.filter(|(_, line)| !line.trim().is_empty())
    };
    let Some((_, first)) = lines().next() else {
        return Ok(None);
    };
    let has_clock = stamp(first).is_some();
    let is_named = |line: &str| {
        let row = plotter_row(without_stamp(line));
        row.is_some_and(|row| row.iter().any(|(name, _)| name.is_some()))
    };
    let mut table = Builder::default();
    // The first line may be the end of one.
    if lines().take(2).any(|(_, line)| is_named(line)) {
        for (number, line) in lines() {
            let row = plotter_row(without_stamp(line));
            let Some(row) = row else {
                table.left_out.row(number, "is no row of numbers".into());
                continue;
            };
            let mut unnamed = 0;
            let row = row.into_iter().map(|(name, value)| match name {
                Some(name) => (name.to_owned(), value),
                None => {
                    unnamed += 1;
                    (format!("value_{unnamed}"), value)
                }
            });
            let (read, unread): (Vec<_>, Vec<_>) = row.partition(|(_, value)| value.is_finite());
            for (name, value) in unread {
                table.leave_out(name, number, &value.to_string());
            }
            table.push(stamp(line), read);
        }
    } else {
        let header = cells(without_stamp(first));
        let is_header = header
            .iter()
            .any(|cell| value(cell).is_none() && !cell.is_empty());
        let names: Vec<String> = match is_header {
            true => distinct(&header, has_clock),
            false => (1..=header.len()).map(|at| format!("value_{at}")).collect(),
        };
        if names.len() < 2 && !has_clock {
            return Ok(None);
        }
        table.order(&names, has_clock);
        for (number, line) in lines().skip(usize::from(is_header)) {
            table.push_cells(number, &names, line);
        }
    }
    table.finish(path)
}

/// Lines with # before a table are blank here, but for the last if it names the columns, as NumPy writes it.
fn without_comments(text: &str) -> Cow<'_, str> {
    let is_comment = |line: &&str| line.trim_start().starts_with('#');
    let count = text.lines().take_while(is_comment).count();
    let last = text.lines().take(count).last();
    let (Some(last), Some(first)) = (last, text.lines().nth(count)) else {
        return Cow::Borrowed(text);
    };
    let names = last.trim_start().trim_start_matches('#').trim();
    let row = cells(first);
    let are_names = cells(names).len() == row.len() && row.iter().all(|cell| value(cell).is_some());
    let header = if are_names { names } else { "" };
    let comments = text.split_inclusive('\n').take(count);
    let rest = &text[comments.map(str::len).sum::<usize>()..];
    // The lines keep their numbers.
    Cow::Owned(format!("{}{header}\n{rest}", "\n".repeat(count - 1)))
}

/// The names of a header, each once: the second `rpm` is `rpm_2`. Columns of one name would be taken for one.
fn distinct(header: &[&str], has_clock: bool) -> Vec<String> {
    let written: HashSet<&str> = header.iter().copied().collect();
    let mut seen: HashMap<&str, usize> = HashMap::new();
    if has_clock {
        seen.insert(CLOCK, 1);
    }
    let mut names = Vec::with_capacity(header.len());
    for &cell in header {
        let count = seen.entry(cell).or_default();
        *count += 1;
        let mut name = cell.to_owned();
        // `rpm_2` may be the name of a third one.
        while *count > 1 {
            name = format!("{cell}_{count}");
            if !written.contains(name.as_str()) {
                break;
            }
            *count += 1;
        }
        names.push(name);
    }
    names
}

#[derive(Default)]
struct Builder {
    columns: Vec<Series>,
    rows: usize,
    values: usize,
    /// Since midnight of the first day, the last one \[s\].
    clock_s: Option<f64>,
    left_out: LeftOut,
    unread: Unread,
}

impl Builder {
    /// A line below a header; one with more or fewer cells, or without any number, is left out.
    fn push_cells(&mut self, number: usize, names: &[String], line: &str) {
        let row = cells(without_stamp(line));
        let values: Vec<Option<f64>> = row.iter().map(|cell| value(cell)).collect();
        if row.len() != names.len() {
            let what = format!("{} values in a row of {} columns", row.len(), names.len());
            self.left_out.row(number, what);
            return;
        }
        if values.iter().all(Option::is_none) {
            self.left_out.row(number, "has no number".into());
            return;
        }
        // A row of nothing but `nan` has its time all the same.
        let values = values.into_iter();
        let values: Vec<_> = values
            .map(|value| value.filter(|it| it.is_finite()))
            .collect();
        for ((name, cell), value) in names.iter().zip(row).zip(&values) {
            if value.is_none() && !cell.is_empty() {
                self.leave_out(name.clone(), number, cell);
            }
        }
        let row = names.iter().zip(values);
        let row = row.filter_map(|(name, value)| Some((name.clone(), value?)));
        self.push(stamp(line), row.collect());
    }

    fn leave_out(&mut self, column: String, line: usize, cell: &str) {
        let unread = self.unread.entry(column).or_insert_with(|| UnreadCells {
            count: 0,
            line,
            first: cell.chars().take(LONGEST_CELL).collect(),
        });
        unread.count += 1;
    }

    fn order(&mut self, names: &[String], has_clock: bool) {
        let clock = has_clock.then(|| CLOCK.to_owned());
        for name in clock.iter().chain(names) {
            self.column(name);
        }
    }

    fn column(&mut self, name: &str) -> Option<&mut Series> {
        let known = self.columns.iter().position(|column| column.name == name);
        let index = match known {
            Some(index) => index,
            None if self.columns.len() == MOST_COLUMNS => return None,
            None => {
                self.columns.push(Series {
                    name: name.to_owned(),
                    ..Series::default()
                });
                self.columns.len() - 1
            }
        };
        self.columns.get_mut(index)
    }

    fn push(&mut self, clock_s: Option<f64>, row: Vec<(String, f64)>) {
        let at = self.rows as f64;
        self.rows += 1;
        let clock = clock_s.map(|clock_s| {
            let before_s = self.clock_s.unwrap_or(clock_s);
            // After midnight.
            let days = ((before_s - clock_s) / DAY_S).round().max(0.0);
            let now_s = clock_s + days * DAY_S;
            self.clock_s = Some(now_s);
            (CLOCK.to_owned(), now_s)
        });
        for (name, value) in clock.into_iter().chain(row) {
            if self.values >= MOST_VALUES {
                continue;
            }
            self.values += 1;
            if let Some(column) = self.column(&name) {
                column.samples.push((at, value));
            }
        }
    }

    fn finish(self, path: &Path) -> Result<Option<Table>, Failure> {
        let wrong = |line: usize, what: String| {
            Failure::Input(format!("{}:{line}: {what}", path.display()))
        };
        if self.rows < 2 || self.left_out.too_much(self.rows).is_some() {
            return Ok(None);
        }
        if self.values >= MOST_VALUES {
            let what = format!("more than {MOST_VALUES} values; cut the table into parts");
            return Err(wrong(1, what));
        }
        Ok(Some(Table {
            columns: self.columns,
            rows: self.rows,
            left_out: self.left_out,
            unread: self.unread,
        }))
    }
}

fn cells(line: &str) -> Vec<&str> {
    match line.contains(',') {
        true => line.split(',').map(str::trim).collect(),
        false => line.split_whitespace().collect(),
    }
}

/// A number, or a time of day with or without its date \[s\].
fn value(cell: &str) -> Option<f64> {
    cell.parse().ok().or_else(|| {
        let time = cell.rsplit([' ', 'T']).next()?;
        time_of_day(time.trim_end_matches('Z'))
    })
}

fn time_of_day(text: &str) -> Option<f64> {
    let mut parts = text.split(':');
    let [hours, minutes] = [parts.next()?, parts.next()?].map(|part| part.parse::<u8>().ok());
    let seconds: f64 = parts.next()?.parse().ok()?;
    let within = parts.next().is_none() && (0.0..61.0).contains(&seconds);
    within.then_some(f64::from(hours?) * 3_600.0 + f64::from(minutes?) * 60.0 + seconds)
}

/// When the Serial Monitor received a line: `18:40:00.000 -> ` before it.
fn stamp(line: &str) -> Option<f64> {
    time_of_day(line.split_once("->")?.0.trim())
}

fn without_stamp(line: &str) -> &str {
    match (stamp(line), line.split_once("->")) {
        (Some(_), Some((_, rest))) => rest.trim(),
        _ => line.trim(),
    }
}

#[cfg(test)]
mod tests {
    use super::{distinct, without_comments};

    #[test]
    fn comments_before_a_table_are_no_rows_and_may_name_its_columns() {
        for (text, without) in [
            ("# by me\n# t v\n0 1\n2 3\n", "\nt v\n0 1\n2 3\n"),
            ("# by me\nt,v\n0,1\n", "\nt,v\n0,1\n"),
            ("t,v\n0,1\n", "t,v\n0,1\n"),
            ("# nothing else", "# nothing else"),
        ] {
            assert_eq!(without_comments(text), without);
        }
    }

    #[test]
    fn columns_of_one_name_stay_apart() {
        for (header, has_clock, names) in [
            (
                vec!["t", "rpm", "rpm", "rpm"],
                false,
                vec!["t", "rpm", "rpm_2", "rpm_3"],
            ),
            (vec!["a", "a", "a_2"], false, vec!["a", "a_3", "a_2"]),
            (vec!["clock", "a"], true, vec!["clock_2", "a"]),
        ] {
            assert_eq!(distinct(&header, has_clock), names);
        }
    }
}
