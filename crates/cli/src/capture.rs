//! `rumbo import` of what a terminal showed: rows of the original program and the commands typed to it, without a header.
//!
//! The four kinds of rows and the six of commands of the original's text protocol. Rows tell how long after the one before they were made; a
//! command is of the time of the row before it. The log is one like those of `rumbo connect`.

use crate::args::ImportArgs;
use crate::failure::Failure;
use crate::output;
use crate::place;
use rumbo_station::log::{Burst, Kind, Manifest, record_text};
use rumbo_wire::text::{Row, TextCommand, TextError};
use serde_json::json;
use std::path::Path;

/// The link of the original program [baud].
const BAUD: u32 = 9_600;

/// A line of the capture.
enum Line {
    Row(Row),
    Command,
}

impl Line {
    fn parse(line: &str) -> Result<Self, TextError> {
        match TextCommand::parse(line) {
            // Ours, not the original's.
            Ok(TextCommand::Mode(_)) | Err(_) => Row::parse(line).map(Self::Row),
            Ok(_) => Ok(Self::Command),
        }
    }
}

/// Whether a text is a capture: it begins with a line of the ten kinds, or with the end of a row and then such a line.
pub(crate) fn is_one(text: &str) -> bool {
    let mut lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
    let is_line = |line: Option<&str>| line.is_some_and(|line| Line::parse(line).is_ok());
    match lines.next() {
        Some(first) if is_part(first) => is_line(Some(first)) || is_line(lines.next()),
        first => is_line(first),
    }
}

/// A row, or a part of one.
fn is_part(line: &str) -> bool {
    line.bytes()
        .all(|byte| byte.is_ascii_digit() || b" ,.-".contains(&byte))
}

/// Checks, converts, writes and sums up.
pub(crate) fn import(args: &ImportArgs, text: &str, out: &Path) -> Result<(), Failure> {
    let link = parse(&args.file, text)?;
    let manifest = Manifest {
        kind: Kind::Robot,
        program: "original".into(),
        version: env!("CARGO_PKG_VERSION").into(),
        port: Some(args.file.display().to_string()),
        baud: BAUD,
        ..Manifest::default()
    };
    place::make(out, |place| {
        record_text(place, &manifest, &link).map_err(|error| Failure::Input(error.of(out)))
    })?;
    let rows = link.iter().filter(|burst| !burst.to_robot).count();
    let (commands, duration_s) = (
        link.len() - rows,
        link.last().map_or(0.0, |last| last.t_us as f64 / 1e6),
    );
    if args.json {
        return output::json(
            &json!({ "log": output::shown(out), "rows": rows, "commands": commands, "duration_s": duration_s }),
        );
    }
    output::line(&format!(
        "{}: {rows} rows and {commands} commands in {duration_s:.1} s",
        out.display()
    ))
}

/// The lines with their times. The first and the last may be cut off, and are left out then.
fn parse(path: &Path, text: &str) -> Result<Vec<Burst>, Failure> {
    let lines: Vec<(usize, &str)> = (1..)
        .zip(text.lines().map(str::trim))
        .filter(|(_, line)| !line.is_empty())
        .collect();
    let (mut link, mut t_us, mut rows) = (Vec::new(), 0, 0);
    for (index, (number, line)) in lines.iter().enumerate() {
        let parsed = match Line::parse(line) {
            Ok(parsed) => parsed,
            Err(_) if is_part(line) && (index == 0 || index + 1 == lines.len()) => continue,
            Err(error) => {
                return Err(Failure::Input(format!(
                    "{}:{number}: `{line}` is neither a row nor a command: {error}",
                    path.display()
                )));
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
    if rows == 0 {
        return Err(Failure::Input(format!(
            "{}: holds no row of telemetry; is the capture complete?",
            path.display()
        )));
    }
    Ok(link)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One of each of the ten kinds.
    const TEN: &str = "0, 50.00, 51.00, 30, 1, 115, 115\r\nON\nOFF\nREF 40\n50, 20, 20, 40, 5, 115, 120\nREF A 40\nGOAL 1 0.5\n\
        60, 1, 2, 3, 4, 0.1, 0.2, 45, 100, 101\nPID B 1 0.001 0\n90, 50, 50, -45, 1.5, 0.5, 0.2, 0, 3, 3, 88, 90, 106\n";

    #[test]
    fn all_ten_kinds_of_lines_are_taken_with_the_times_that_rows_tell() {
        let table = "dt_ms,left_cm,right_cm,reference_cm,mode,pwm_a,pwm_b\n60,50,51,30,1,115,115\n";
        assert!(is_one(TEN) && !is_one(table));
        let link = parse(Path::new("x"), TEN).unwrap();
        let times: Vec<u64> = link.iter().map(|burst| burst.t_us / 1_000).collect();
        assert_eq!(times, [0, 0, 0, 0, 50, 50, 50, 110, 110, 200]);
        assert_eq!(link.iter().filter(|burst| burst.to_robot).count(), 6);
    }

    #[test]
    fn a_bad_line_is_named_unless_the_capture_was_cut_there() {
        let cut = format!("15, 115\n{TEN}60, 5");
        assert_eq!(parse(Path::new("x"), &cut).unwrap().len(), 10);
        let bad = TEN.replace("REF 40", "REF forty");
        let Err(Failure::Input(said)) = parse(Path::new("x"), &bad) else {
            panic!("taken")
        };
        assert!(
            said.starts_with("x:4: `REF forty`") && !said.contains('\n'),
            "{said}"
        );
        assert!(parse(Path::new("x"), "ON\nOFF\n").is_err());
    }
}
