//! The log of another program's table or bag: rows of signals, and all else as numbers by name.

use super::columns::Taken;
use super::guess::{self, Guess};
use crate::failure::Failure;
use crate::output::{self, figure};
use rumbo_identify::lacks;
use rumbo_log::{
    ANOTHER, Entry, Level, LogKind, LogWriter, LoggedEvent, Manifest, Names, ReadingSource, Row,
};
use rumbo_ros::recorded::Series;
use serde_json::json;
use std::collections::BTreeSet;
use std::path::Path;

/// Times \[s\], and values.
pub(super) type Samples = Vec<(f64, f64)>;
/// Signals of a log that one column gives.
pub(super) type Signals = (&'static [&'static str], Samples);

/// A log that is made.
pub(super) struct Made {
    pub(super) rows: Vec<Row>,
    pub(super) numbers: Vec<(String, Samples)>,
    pub(super) end_s: f64,
    pub(super) notes: Vec<String>,
}

impl Made {
    pub(super) fn encode(
        &self,
        file: &str,
        taken: &[Taken],
        series: &[Series],
    ) -> std::io::Result<Vec<u8>> {
        let manifest = Manifest {
            kind: LogKind::Robot,
            program: ANOTHER.into(),
            version: env!("CARGO_PKG_VERSION").into(),
            port: Some(file.to_owned()),
            ..Manifest::default()
        };
        let mut log = LogWriter::new(Vec::new(), &manifest)?;
        let columns: Vec<String> = taken.iter().map(|one| in_words(one, series)).collect();
        log.record(&Entry::Event(LoggedEvent {
            t_s: 0.0,
            level: Level::Info,
            text: format!("imported from {file}: {}", columns.join(", ")),
        }))?;
        let mut numbers: Vec<(i64, usize, f64)> = Vec::new();
        for (index, (_, samples)) in self.numbers.iter().enumerate() {
            numbers.extend(
                samples
                    .iter()
                    .map(|(t_s, value)| (to_ms(*t_s), index, *value)),
            );
        }
        numbers.sort_by_key(|(t_ms, index, _)| (*t_ms, *index));
        let mut instants = numbers.chunk_by(|a, b| a.0 == b.0).peekable();
        let mut names = Names::default();
        let mut reading = |instant: &[(i64, usize, f64)]| {
            let values = instant
                .iter()
                .map(|(_, index, value)| (self.numbers[*index].0.clone(), *value));
            names.reading(instant[0].0, ReadingSource::Usart(0), values.collect())
        };
        for row in &self.rows {
            while let Some(instant) = instants.next_if(|instant| instant[0].0 <= row.t_ms) {
                log.record(&Entry::Readings(vec![reading(instant)]))?;
            }
            log.record(&Entry::Rows(vec![*row]))?;
        }
        for instant in instants {
            log.record(&Entry::Readings(vec![reading(instant)]))?;
        }
        log.finish()
    }

    pub(super) fn sum_up(
        &self,
        out: &Path,
        taken: &[Taken],
        series: &[Series],
        as_json: bool,
    ) -> Result<(), Failure> {
        let missing = lacks(&self.rows);
        let columns: Vec<String> = taken.iter().map(|one| in_words(one, series)).collect();
        let gaps = self.rows.windows(2).map(|pair| pair[1].t_ms - pair[0].t_ms);
        let gap_s = gaps.max().unwrap_or(0) as f64 / 1e3;
        let names: Vec<&str> = self.numbers.iter().map(|(name, _)| name.as_str()).collect();
        if as_json {
            return output::json(&json!({
                "log": output::shown(out), "program": ANOTHER, "rows": self.rows.len(), "duration_s": self.end_s,
                "longest_gap_s": gap_s, "columns": columns, "numbers": names, "identify_lacks": missing,
            }));
        }
        output::line(&format!(
            "{}: {} of signals in {} s, longest gap {} s",
            out.display(),
            output::counted(self.rows.len(), "row"),
            figure(self.end_s),
            figure(gap_s)
        ))?;
        for column in &columns {
            output::line(&format!("  {column}"))?;
        }
        if !names.is_empty() {
            output::line(&format!("  as numbers: {}", names.join(", ")))?;
        }
        let guesses = guess::guess(series, true);
        let is_open = |guess: &&Guess| {
            let is_known = taken
                .iter()
                .any(|one| one.name == guess.name || one.column == Some(guess.column));
            !is_known && !guess.name.starts_with("t_") && !guess.name.starts_with("dt_")
        };
        let open: Vec<String> = guesses
            .iter()
            .filter(is_open)
            .map(|guess| guess.text(series))
            .collect();
        if !open.is_empty() {
            output::line(&format!(
                "  may be more: --columns 'auto,{}'",
                open.join(",")
            ))?;
        }
        let log = output::quoted(out);
        let next = match missing.is_empty() {
            true => format!("`rumbo identify {log} --robot ROBOT` fits a robot to it"),
            false => format!("for `rumbo identify` it lacks {}", missing.join(", ")),
        };
        output::line(&format!("`rumbo replay {log}` shows it; {next}"))
    }
}

fn to_ms(t_s: f64) -> i64 {
    (t_s * 1e3).round() as i64
}

/// `left_rpm = Left Speed (rpm)`.
fn in_words(one: &Taken, series: &[Series]) -> String {
    let column = one.column.and_then(|column| series.get(column));
    match column {
        Some(column) => format!("{} = {}", one.name, column.name),
        None => format!("{} = {}", one.name, figure(one.factor)),
    }
}

/// Rows at the times of the signal that has most samples; what the others said last still holds.
pub(super) fn rows(signals: &[Signals]) -> Vec<Row> {
    let Some((_, times)) = signals.iter().max_by_key(|(_, samples)| samples.len()) else {
        return Vec::new();
    };
    let known: BTreeSet<&str> = signals
        .iter()
        .flat_map(|(names, _)| names.iter().copied())
        .collect();
    let has_pose = ["x_m", "y_m", "heading_rad"]
        .iter()
        .all(|name| known.contains(name));
    let mut next = vec![0; signals.len()];
    let mut rows: Vec<Row> = Vec::new();
    for (t_s, _) in times {
        let mut row = Row::unknown(to_ms(*t_s));
        for ((names, samples), next) in signals.iter().zip(&mut next) {
            while samples
                .get(*next)
                .is_some_and(|(at_s, _)| *at_s <= t_s + 5e-4)
            {
                *next += 1;
            }
            let Some((_, value)) = next.checked_sub(1).and_then(|last| samples.get(last)) else {
                continue;
            };
            for name in *names {
                let value = match *name {
                    "heading_rad" => value.sin().atan2(value.cos()),
                    _ => *value,
                };
                row.set(name, value);
            }
        }
        if has_pose {
            for name in ["origin_x_m", "origin_y_m", "origin_heading_rad"] {
                row.set(name, 0.0);
            }
        }
        // A millisecond has one row.
        match rows.last_mut().filter(|last| last.t_ms == row.t_ms) {
            Some(last) => *last = row,
            None => rows.push(row),
        }
    }
    rows
}
