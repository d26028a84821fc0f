//! `rumbo import` of a terminal's capture: rows of the original program and the commands typed, without a header.
//!
//! The four kinds of rows and the six of commands of the original text protocol. A row carries the time since the
//! previous one; a command has the time of the row before it. The log is like those of `rumbo connect`.

use crate::args::ImportArgs;
use crate::failure::Failure;
use crate::left_out::LeftOut;
use crate::output;
use crate::place::Guard;
use rumbo_log::{Burst, LogKind, Manifest};
use rumbo_station::headless::record_text;
use rumbo_wire::text::{TextCommand, TextError, TextRow};
use serde_json::json;
use std::path::Path;

/// The link of the original program [baud].
const BAUD: u32 = 9_600;

/// A line of the capture.
enum Line {
    Row(TextRow),
    Command,
}

impl Line {
    fn parse(line: &str) -> Result<Self, TextError> {
        match TextCommand::parse(line) {
            // Ours, not the original's.
            Ok(TextCommand::Mode(_)) | Err(_) => TextRow::parse(line).map(Self::Row),
            Ok(_) => Ok(Self::Command),
        }
    }
}

/// Whether a text is a capture: it begins with a line of the ten kinds, or with the end of a row and then such a line, or most of it are such lines and it does not begin with names of columns.
pub(crate) fn is_one(text: &str) -> bool {
    let lines = || text.lines().map(str::trim).filter(|line| !line.is_empty());
    let is_line = |line: &&str| Line::parse(line).is_ok();
    match lines().next() {
        Some(first) if is_line(&first) => true,
        Some(first) if is_part(first) && lines().nth(1).as_ref().is_some_and(is_line) => true,
        Some(first) if first.contains("dt_ms") || first.contains("pwm_") => false,
        _ => 2 * lines().filter(is_line).count() > lines().count(),
    }
}

/// A row, or a part of one.
fn is_part(line: &str) -> bool {
    line.bytes()
        .all(|byte| byte.is_ascii_digit() || b" ,.-".contains(&byte))
}

/// Checks, converts, writes and sums up.
pub(crate) fn import(
    args: &ImportArgs,
    text: &str,
    out: &Path,
    guard: &Guard,
) -> Result<(), Failure> {
    let (link, left_out) = parse(&args.file, text)?;
    left_out.report(&args.file);
    let manifest = Manifest {
        kind: LogKind::Robot,
        program: "original".into(),
        version: env!("CARGO_PKG_VERSION").into(),
        port: Some(args.file.display().to_string()),
        baud: BAUD,
        ..Manifest::default()
    };
    guard.make_equal(out, |place| {
        record_text(place, &manifest, &link).map_err(|error| Failure::input(error.of(out)))
    })?;
    let rows = link.iter().filter(|burst| !burst.to_robot).count();
    let (commands, duration_s) = (
        link.len() - rows,
        link.last().map_or(0.0, |last| last.t_us as f64 / 1e6),
    );
    if args.json {
        return output::json(
            &json!({ "log": output::shown(out), "rows": rows, "commands": commands, "duration_s": duration_s, "left_out": left_out.json() }),
        );
    }
    output::line(&format!(
        "{}: {} and {} in {duration_s:.1} s",
        out.display(),
        output::counted(rows, "row"),
        output::counted(commands, "command"),
    ))
}

/// The lines with their times, and what is left out: the first and the last silently where a capture was cut there, others as long as more are sound.
fn parse(path: &Path, text: &str) -> Result<(Vec<Burst>, LeftOut), Failure> {
    let lines: Vec<(usize, &str)> = (1..)
        .zip(text.lines().map(str::trim))
        .filter(|(_, line)| !line.is_empty())
        .collect();
    let (mut link, mut t_us, mut rows) = (Vec::new(), 0, 0);
    let mut left_out = LeftOut::default();
    for (index, (number, line)) in lines.iter().enumerate() {
        let parsed = match Line::parse(line) {
            Ok(parsed) => parsed,
            Err(_) if is_part(line) && (index == 0 || index + 1 == lines.len()) => continue,
            Err(error) => {
                left_out.row(
                    *number,
                    format!("`{line}` is neither a row nor a command: {error}"),
                );
                continue;
            }
        };
        if let Line::Row(row) = &parsed {
            // The first row's period is the time before the capture.
            t_us += if rows > 0 {
                u64::from(row.dt_ms()) * 1_000
            } else {
                0
            };
            rows += 1;
        }
        link.push(Burst {
            t_us,
            to_robot: matches!(parsed, Line::Command),
            bytes: format!("{line}\n").into_bytes(),
        });
    }
    if let Some((number, what)) = left_out.too_much(link.len()) {
        return Err(Failure::Input(format!(
            "{}:{number}: {what}",
            path.display()
        )));
    }
    if rows == 0 {
        return Err(Failure::Input(format!(
            "{}: holds no row of telemetry; is the capture complete?",
            path.display()
        )));
    }
    Ok((link, left_out))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One of each of the ten kinds.
    const TEN: &str = "0, 50.00, 51.00, 30, 1, 115, 115\r\nON\nOFF\nREF 40\n50, 20, 20, 40, 5, 115, 120\nREF A 40\nGOAL 1 0.5\n\
        60, 1, 2, 3, 4, 0.1, 0.2, 45, 100, 101\nPID B 1 0.001 0\n90, 50, 50, -45, 1.5, 0.5, 0.2, 0, 3, 3, 88, 90, 106\n";

    #[test]
    fn all_ten_kinds_of_lines_are_read_with_the_times_in_the_rows() {
        let table = "dt_ms,left_cm,right_cm,reference_cm,mode,pwm_a,pwm_b\n60,50,51,30,1,115,115\n";
        assert!(is_one(TEN) && !is_one(table));
        let (link, _) = parse(Path::new("x"), TEN).unwrap();
        let times: Vec<u64> = link.iter().map(|burst| burst.t_us / 1_000).collect();
        assert_eq!(times, [0, 0, 0, 0, 50, 50, 50, 110, 110, 200]);
        assert_eq!(link.iter().filter(|burst| burst.to_robot).count(), 6);
    }

    #[test]
    fn a_damaged_line_is_left_out_and_named_unless_the_capture_was_cut_there() {
        let result = |text: &str| {
            let (link, left_out) = parse(Path::new("x"), text).unwrap();
            (link.len(), left_out.json())
        };
        let cut = format!("15, 115\n{TEN}60, 5");
        assert_eq!(result(&cut), (10, json!([])));
        let damaged = TEN.replace("REF 40", "REF forty");
        assert!(is_one(&damaged));
        let (lines, why) = result(&damaged);
        assert_eq!((lines, why.as_array().unwrap().len()), (9, 1));
        assert_eq!(why[0]["line"], 4);
        // Also noise from plugging in the cable.
        let noisy = format!("\u{fffd}\u{fffd}x7\n{TEN}");
        assert!(is_one(&noisy));
        assert_eq!(result(&noisy).0, 10);
    }

    #[test]
    fn what_is_mostly_no_line_of_a_capture_is_refused() {
        for text in ["ON\nOFF\n", "ON\none\ntwo\nthree\n"] {
            assert!(parse(Path::new("x"), text).is_err(), "{text}");
        }
        assert!(!is_one("one\ntwo\nON\n"));
    }
}
