//! `rumbo export`: a log as CSV, SVG and PNG.

use crate::args::{ExportArgs, Format};
use crate::failure::Failure;
use crate::figures;
use crate::output;
use crate::place;
use rumbo_scenario::chart;
use rumbo_station::Row;
use rumbo_station::log::{Kind, Log, Manifest};
use std::fmt::Write;
use std::path::Path;

/// Writes what was asked for and prints the paths.
pub(crate) fn export(args: &ExportArgs) -> Result<(), Failure> {
    let log = Log::read(&args.log).map_err(Failure::input)?;
    warn_if_cut(&args.log, &log)?;
    let folder = args.out.clone().unwrap_or_default();
    if !folder.as_os_str().is_empty() {
        place::folder(&folder)?;
    }
    let stem = args.log.file_stem().unwrap_or(args.log.as_os_str());
    let path = |ending: &str| folder.join(stem).with_extension(ending);
    let formats = if args.formats.is_empty() {
        &[Format::Csv, Format::Svg][..]
    } else {
        &args.formats
    };
    let charts = figures::of_one(&log);
    for format in formats {
        match format {
            Format::Svg | Format::Png if charts.is_empty() => {
                return Err(Failure::Input(format!(
                    "{}: holds no signals to draw; --format csv writes what there is",
                    args.log.display()
                )));
            }
            Format::Csv => {
                write(&path("csv"), signals(&log))?;
                write(&path("events.csv"), events(&log))?;
            }
            Format::Svg => {
                let text = chart::svg(&charts, 1, figures::SIZE).map_err(Failure::Input)?;
                write(&path("svg"), text)?;
            }
            Format::Png => {
                let image = chart::png(&charts, 1, figures::SIZE).map_err(Failure::Input)?;
                write(&path("png"), image)?;
            }
        }
    }
    Ok(())
}

/// Says on stderr that a log ends early; one in which nothing had happened yet is of no use.
pub(crate) fn warn_if_cut(path: &Path, log: &Log) -> Result<(), Failure> {
    use std::io::Write;
    let shown = path.display();
    let Some(why) = &log.cut else {
        return Ok(());
    };
    if log.holds_nothing() {
        let again = log
            .manifest
            .as_ref()
            .and_then(once_more)
            .unwrap_or_default();
        return Err(Failure::Input(format!(
            "{shown}: was cut off before anything that happened had reached it{again}"
        )));
    }
    let state = match log.has_holes {
        true => "is damaged".to_owned(),
        false => format!("ends at {:.1} s", log.duration_s()),
    };
    // A closed stderr leaves nobody to tell.
    let _ = writeln!(std::io::stderr(), "note: {shown} {state}: {why}");
    Ok(())
}

/// How a run without a window comes again.
fn once_more(manifest: &Manifest) -> Option<String> {
    let seed = manifest.seed?;
    let command = match manifest.kind {
        Kind::Run => format!("run {}", manifest.scenario.as_ref()?),
        Kind::Calibration => "calibrate".into(),
        Kind::Lab | Kind::Robot => return None,
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

fn events(log: &Log) -> String {
    let mut text = String::from("t_s,level,event\n");
    for (t_s, level, event) in log.events() {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{t_s:.3},{level},\"{}\"", event.replace('"', "\"\""));
    }
    text
}
