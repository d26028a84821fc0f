//! `rumbo export`: a log as CSV and SVG, and as a bag of ROS 2.

use crate::args::{ExportArgs, Format};
use crate::failure::Failure;
use crate::figures;
use crate::logs;
use crate::mark::Mark;
use crate::output;
use crate::place::{self, Guard};
use crate::ros2bag::Bag;
use rumbo_log::{Log, LogKind, Manifest, Reading, ReadingSource, Row, SIGNALS};
use rumbo_report::FileStamp;
use rumbo_station::log_file;
use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::Path;

/// Writes the requested files and prints the paths.
pub(crate) fn export(args: &ExportArgs) -> Result<(), Failure> {
    let folder = args.out.clone().unwrap_or_default();
    let stem = args.log.file_stem().unwrap_or(args.log.as_os_str());
    let stem = stem.to_string_lossy();
    let path = |ending: &str| folder.join(format!("{stem}.{ending}"));
    let options = format!("{:?}", (args.from_s, args.to_s, &args.signals, args.scan));
    let stamp = FileStamp::of("export", &[output::shown(&args.log), options]);
    let formats = match args.formats.is_empty() && !args.ros2bag {
        true => &[Format::Csv, Format::Svg][..],
        false => &args.formats,
    };
    let bag = Bag::of(&stem, &folder, stamp.clone());
    let guard = Guard::new([&args.log], args.overwrite.force);
    logs::mend(&args.log);
    let mut log = log_file::read(&args.log).map_err(Failure::input)?;
    warn_if_cut(&args.log, &log)?;
    check_signals(&args.signals)?;
    cut_out(&mut log, args)?;
    if formats.contains(&Format::Svg) {
        guard.check(&path("svg"), &Mark::of(&stamp))?;
    }
    if args.ros2bag {
        bag.check(&guard)?;
    }
    let tables = match formats.contains(&Format::Csv) {
        true => tables(&log),
        false => Vec::new(),
    };
    for (ending, table) in &tables {
        let path = path(ending);
        // Nothing in a table says of which log and time it is: it replaces its equal.
        let is_own = std::fs::read(&path).is_ok_and(|before| before == table.as_bytes());
        guard.check_own(&path, is_own)?;
    }
    if !folder.as_os_str().is_empty() {
        place::folder(&folder)?;
    }
    if args.ros2bag {
        bag.write(&args.log, &log, args.scan)?;
    }
    let figures = figures::of_one(&log, &args.signals);
    for format in formats {
        match format {
            Format::Svg if figures.is_empty() => without_figure(args)?,
            Format::Csv => tables
                .iter()
                .try_for_each(|(ending, table)| write(&path(ending), table))?,
            Format::Svg => {
                write(&path("svg"), stamp.put_on(figures.svg()))?;
            }
        }
    }
    Ok(())
}

/// Nothing is there to draw: wrong if a figure was asked for, else the tables are what there is.
fn without_figure(args: &ExportArgs) -> Result<(), Failure> {
    let none = format!("{}: holds no signals to draw", args.log.display());
    if !args.formats.is_empty() {
        let remedy = "--format csv writes what there is";
        return Err(Failure::Input(format!("{none}; {remedy}")));
    }
    output::note(&format!("{none}, so there is no figure"));
    Ok(())
}

/// Refuses a signal that is not plotted.
fn check_signals(signals: &[String]) -> Result<(), Failure> {
    let is_plotted = |name: &str| figures::signal(name).is_some();
    let Some(name) = signals.iter().find(|name| !is_plotted(name)) else {
        return Ok(());
    };
    let known = SIGNALS.iter().map(|signal| signal.name);
    let known: Vec<&str> = known.filter(|name| is_plotted(name)).collect();
    Err(Failure::Input(format!(
        "--signals {name}: no signal that is plotted; known are {}",
        known.join(", ")
    )))
}

/// Leaves of a log what lies between the times that were asked for.
fn cut_out(log: &mut Log, args: &ExportArgs) -> Result<(), Failure> {
    let [from_s, to_s] = stretch(&args.log, log, args.from_s, args.to_s)?;
    let within = |t_s: f64| (from_s..=to_s).contains(&t_s);
    log.rows.retain(|row| within(row.t_ms as f64 / 1e3));
    log.readings.retain(|each| within(each.t_ms as f64 / 1e3));
    log.events.retain(|event| within(event.t_s));
    Ok(())
}

/// The times that were asked for, refused where the log holds nothing between them.
pub(crate) fn stretch(
    path: &Path,
    log: &Log,
    from_s: Option<f64>,
    to_s: Option<f64>,
) -> Result<[f64; 2], Failure> {
    let (from, to) = (from_s.unwrap_or(0.0), to_s.unwrap_or(f64::INFINITY));
    let mut times = log.rows.iter().map(|row| row.t_ms as f64 / 1e3);
    let is_all = from_s.is_none() && to_s.is_none();
    if is_all || from < to && times.any(|t_s| (from..=to).contains(&t_s)) {
        return Ok([from, to]);
    }
    let until = to_s.map_or_else(
        || format!("its end at {:.1} s", log.duration_s()),
        |to_s| format!("{to_s} s"),
    );
    Err(Failure::Input(format!(
        "{}: holds nothing from {from} s to {until}; give times of the log, --from before --to",
        path.display()
    )))
}

/// Reports on stderr that a log ends early; an empty one is an error.
pub(crate) fn warn_if_cut(path: &Path, log: &Log) -> Result<(), Failure> {
    let shown = path.display();
    if let Some(why) = log.why_empty() {
        let again = log
            .manifest
            .as_ref()
            .and_then(once_more)
            .unwrap_or_default();
        return Err(Failure::Input(format!("{shown}: {why}{again}")));
    }
    for note in &log.notes {
        output::note(&format!("{shown}: {note}"));
    }
    let Some(why) = &log.cut else {
        return Ok(());
    };
    let state = match log.has_holes {
        true => "is damaged".to_owned(),
        false => format!("ends at {:.1} s", log.duration_s()),
    };
    output::note(&format!("{shown} {state}: {why}"));
    Ok(())
}

/// How to repeat a headless run.
fn once_more(manifest: &Manifest) -> Option<String> {
    let seed = manifest.seed?;
    let command = match manifest.kind {
        LogKind::Run => format!("run {}", manifest.scenario.as_ref()?),
        LogKind::Calibration => "calibrate".into(),
        LogKind::Lab | LogKind::Robot | LogKind::Episode => return None,
    };
    Some(format!(
        "; `rumbo {command} --seed {seed}` makes such a run again"
    ))
}

fn write(path: &Path, bytes: impl AsRef<[u8]>) -> Result<(), Failure> {
    place::write(path, bytes)?;
    output::line(&path.display().to_string())
}

/// The signals, one row per telemetry frame: a unit in each name, nothing where a value is unknown, `inf` where a range is clear.
fn signals(log: &Log) -> String {
    let names: Vec<&str> = Row::names().collect();
    let mut text = names.join(",") + "\n";
    for row in &log.rows {
        let cells: Vec<String> = (0..names.len())
            .map(|column| {
                row.get(column)
                    .map_or_else(String::new, |value| value.to_string())
            })
            .collect();
        text += &cells.join(",");
        text.push('\n');
    }
    text
}

/// The tables of a log, each with its suffix: telemetry, events, and as far as there are any ground truth and pins, and
/// what the program printed on each port.
fn tables(log: &Log) -> Vec<(String, String)> {
    let own = [("csv", signals(log)), ("events.csv", events(log))];
    let own = own.map(|(ending, table)| (ending.to_owned(), table));
    let sources: BTreeSet<ReadingSource> = log.readings.iter().map(|each| each.source).collect();
    let others = sources.into_iter().map(|source| {
        let ending = match source {
            ReadingSource::Truth => "instruments.csv".to_owned(),
            ReadingSource::Loops => "loops.csv".to_owned(),
            ReadingSource::Others => "others.csv".to_owned(),
            ReadingSource::Usart(usart) => format!("printed{usart}.csv"),
        };
        let of_it = log.readings.iter().filter(|each| each.source == source);
        (ending, table(&of_it.collect::<Vec<_>>()))
    });
    own.into_iter().chain(others).collect()
}

/// A column for each name that there is, one row per reading.
fn table(readings: &[&Reading]) -> String {
    let names = readings.iter().flat_map(|each| each.names.iter());
    let names: BTreeSet<&str> = names.map(String::as_str).collect();
    let header: Vec<String> = names.iter().map(|name| heading(name)).collect();
    let mut text = format!("t_s,{}\n", header.join(","));
    for reading in readings {
        let cells = names.iter().map(|name| reading.signal(name));
        let cells = cells.map(|value| value.map_or_else(String::new, |value| value.to_string()));
        let cells: Vec<String> = cells.collect();
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{},{}", reading.t_ms as f64 / 1e3, cells.join(","));
    }
    text
}

/// The name of a column, which a program may have chosen.
fn heading(name: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '_';
    match name.chars().all(plain) {
        true => name.to_owned(),
        false => text_cell(name),
    }
}

fn events(log: &Log) -> String {
    let mut text = String::from("t_s,level,event\n");
    for (t_s, level, event) in log.events() {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{t_s:.3},{level},{}", text_cell(event));
    }
    text
}

/// A text as a cell of a table: in quotes, in one line, and none that a spreadsheet would compute.
pub(crate) fn text_cell(text: &str) -> String {
    let computes = text.starts_with(['=', '+', '-', '@', '\t', '\r']);
    let apostrophe = if computes { "'" } else { "" };
    let shown = output::visible(text);
    format!("\"{apostrophe}{}\"", shown.replace('"', "\"\""))
}

#[cfg(test)]
mod tests {
    use super::text_cell;

    #[test]
    fn a_spreadsheet_computes_nothing_that_a_robot_said() {
        for (text, cell) in [
            ("STOP: acknowledged", "\"STOP: acknowledged\""),
            ("say \"on\"", "\"say \"\"on\"\"\""),
            ("=cmd|' /C calc'!A0", "\"'=cmd|' /C calc'!A0\""),
            ("-1+1", "\"'-1+1\""),
            ("\t=1\r\n@x", "\"'\\t=1\\r\\n@x\""),
        ] {
            assert_eq!(text_cell(text), cell);
        }
    }
}
