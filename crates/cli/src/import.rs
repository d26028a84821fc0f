//! `rumbo import`: a CSV of the original program, checked and converted to an MCAP log.
//!
//! The log holds one JSON message per row in SI units, with its schema, on the topic `telemetry`, and the CSV itself
//! as an attachment, so that nothing is lost. `rumbo identify` reads both.

use crate::args::ImportArgs;
use crate::capture;
use crate::failure::Failure;
use crate::output::{self, figure};
use crate::place;
use crate::recorded::{self, CSV};
use mcap::records::{MessageHeader, Metadata};
use mcap::{Attachment, WriteOptions};
use rumbo_scenario::dialect;
use rumbo_wire::csv;
use rumbo_wire::text::RowKind;
use serde_json::{Map, Value, json};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::io::Cursor;
use std::path::{Path, PathBuf};

/// What becomes of a column: its unit's factor, and what its values must lie within.
struct Column {
    original: &'static csv::Column,
    name: String,
    factor: f64,
    min: f64,
    max: f64,
}

/// A checked recording, in SI units.
struct Recording {
    modes: &'static str,
    columns: Vec<Column>,
    /// Time since the first row, in s, and the row's values.
    rows: Vec<(f64, Vec<f64>)>,
    longest_gap_s: f64,
}

/// Checks, converts, writes and sums up.
pub(crate) fn import(args: &ImportArgs) -> Result<(), Failure> {
    let shown = args.file.display();
    let bytes = recorded::bytes(&args.file).map_err(|error| {
        Failure::Input(format!(
            "{shown}: cannot be read ({error}); give the path of a CSV file"
        ))
    })?;
    if bytes.starts_with(mcap::MAGIC) {
        return Err(Failure::Input(format!(
            "{shown}: is a log already; `rumbo replay` shows it"
        )));
    }
    if bytes.is_empty() {
        return Err(Failure::Input(format!(
            "{shown}: is empty; give a CSV of the original program"
        )));
    }
    let text =
        dialect::plain(&bytes).map_err(|error| Failure::Input(format!("{shown}: {error}")))?;
    let out = match &args.out {
        Some(out) => out.clone(),
        None => PathBuf::from(args.file.file_stem().unwrap_or(args.file.as_os_str()))
            .with_extension("mcap"),
    };
    if capture::is_one(&text) {
        return capture::import(args, &text, &out);
    }
    let recording = parse(&args.file, &text)?;
    let log = encode(&recording, &args.file, &bytes).map_err(Failure::input)?;
    if args.out.is_none() {
        spare(&out, &log)?;
    }
    place::write(&out, &log)?;
    summary(&recording, &out, args.json)
}

/// A log of the same name that is another one stays, unless its place was asked for.
pub(crate) fn spare(out: &Path, log: &[u8]) -> Result<(), Failure> {
    match std::fs::read(out) {
        Ok(before) if before != log => Err(Failure::Input(format!(
            "{}: is another log already; choose a name with --out",
            out.display()
        ))),
        _ => Ok(()),
    }
}

impl Column {
    /// What a column becomes: units to SI, motor A to the right wheel and B to the left one.
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

/// What a header lacks that is none of the original program's.
fn unknown(header: &str) -> String {
    let found: Vec<&str> = header.split(',').map(str::trim).collect();
    let matching = |kind: &RowKind| {
        let due = kind.columns().iter().map(|column| column.name);
        due.filter(|name| found.contains(name)).count()
    };
    let nearest = RowKind::ALL.into_iter().max_by_key(matching);
    match nearest.filter(|kind| matching(kind) > 2) {
        Some(kind) => format!(
            "`{header}` is no header of the original program; the nearest is that of {}: {}",
            modes(kind),
            header_of(kind)
        ),
        None => format!(
            "`{}` is neither a header of the original program nor a line of a capture; `rumbo import --help` shows the headers",
            header.chars().take(60).collect::<String>()
        ),
    }
}

fn parse(path: &Path, text: &str) -> Result<Recording, Failure> {
    let wrong =
        |line: usize, what: String| Failure::Input(format!("{}:{line}: {what}", path.display()));
    let mut lines = text
        .lines()
        .enumerate()
        .map(|(index, line)| (index + 1, line.trim()));
    let header = lines.next().unwrap_or_default().1;
    let kind = csv::recognise(header).ok_or_else(|| wrong(1, unknown(header)))?;
    let columns: Vec<Column> = kind.columns().iter().map(Column::of).collect();
    let (mut rows, mut time_s, mut longest_gap_s) = (Vec::new(), 0.0, 0.0_f64);
    for (line, row) in lines.filter(|(_, row)| !row.is_empty()) {
        let fields: Vec<&str> = row.split(',').map(str::trim).collect();
        if fields.len() != columns.len() {
            let (found, due) = (fields.len(), columns.len());
            return Err(wrong(
                line,
                format!(
                    "{found} values in a row of {due} columns; expected {}",
                    header_of(kind)
                ),
            ));
        }
        let mut values = Vec::with_capacity(columns.len());
        for (column, field) in columns.iter().zip(fields) {
            let value = field
                .parse::<f64>()
                .ok()
                .filter(|value| (column.min..=column.max).contains(value));
            let value = value.ok_or_else(|| {
                let Column {
                    original, min, max, ..
                } = column;
                wrong(
                    line,
                    format!(
                        "{} = `{field}`: must be a number within {min}..{max}",
                        original.name
                    ),
                )
            })?;
            values.push(value * column.factor);
        }
        let dt_s = values.first().copied().unwrap_or_default() / 1000.0;
        // The first row's period is the time the program waited before the run.
        if !rows.is_empty() {
            time_s += dt_s;
            longest_gap_s = longest_gap_s.max(dt_s);
        }
        rows.push((time_s, values));
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
    })
}

/// The log's bytes.
fn encode(recording: &Recording, path: &Path, bytes: &[u8]) -> mcap::McapResult<Vec<u8>> {
    let name = path
        .file_name()
        .map(|name| name.to_string_lossy().into_owned())
        .unwrap_or_default();
    let options = WriteOptions::new()
        .compression(None)
        .library(concat!("rumbo ", env!("CARGO_PKG_VERSION")));
    let mut log = options.create(Cursor::new(Vec::new()))?;
    let properties: Map<String, Value> = recording
        .columns
        .iter()
        .skip(1)
        .map(|column| (column.name.clone(), json!({ "type": "number" })))
        .collect();
    let schema =
        json!({ "type": "object", "title": "original_telemetry", "properties": properties });
    let schema = log.add_schema(
        "original_telemetry",
        "jsonschema",
        schema.to_string().as_bytes(),
    )?;
    let channel = log.add_channel(schema, "telemetry", "json", &BTreeMap::new())?;
    for (sequence, (time_s, values)) in recording.rows.iter().enumerate() {
        let named = recording.columns.iter().zip(values).skip(1);
        let message: Map<String, Value> = named
            .map(|(column, value)| (column.name.clone(), json!(value)))
            .collect();
        let time_ns = (time_s * 1e9).round() as u64;
        let header = MessageHeader {
            channel_id: channel,
            sequence: sequence as u32,
            log_time: time_ns,
            publish_time: time_ns,
        };
        log.write_to_known_channel(&header, Value::Object(message).to_string().as_bytes())?;
    }
    let data = Cow::Borrowed(bytes);
    log.attach(&Attachment {
        log_time: 0,
        create_time: 0,
        name: name.clone(),
        media_type: CSV.into(),
        data,
    })?;
    let about = [
        ("source", name),
        ("program", format!("original, {}", recording.modes)),
    ];
    let metadata = about.map(|(key, value)| (key.to_owned(), value)).into();
    log.write_metadata(&Metadata {
        name: "origin".into(),
        metadata,
    })?;
    log.finish()?;
    Ok(log.into_inner().into_inner())
}

fn summary(recording: &Recording, out: &Path, as_json: bool) -> Result<(), Failure> {
    let duration_s = recording.rows.last().map_or(0.0, |(time_s, _)| *time_s);
    let (rows, gap_s, modes) = (
        recording.rows.len(),
        recording.longest_gap_s,
        recording.modes,
    );
    let columns = recording
        .columns
        .iter()
        .enumerate()
        .skip(1)
        .map(|(index, column)| {
            let values = || {
                recording
                    .rows
                    .iter()
                    .filter_map(move |(_, values)| values.get(index).copied())
            };
            let (min, max) = values().fold((f64::MAX, f64::MIN), |(min, max), value| {
                (min.min(value), max.max(value))
            });
            (
                column.name.as_str(),
                min,
                max,
                values().sum::<f64>() / rows as f64,
            )
        });
    if as_json {
        let columns: Map<String, Value> = columns
            .map(|(name, min, max, mean)| {
                (
                    name.to_owned(),
                    json!({ "min": min, "max": max, "mean": mean }),
                )
            })
            .collect();
        return output::json(&json!({
            "log": output::shown(out), "program": modes, "rows": rows, "duration_s": duration_s,
            "longest_gap_s": gap_s, "columns": columns,
        }));
    }
    output::line(&format!(
        "{}: {modes} of the original program, {rows} rows in {} s, longest gap {} s",
        out.display(),
        figure(duration_s),
        figure(gap_s)
    ))?;
    let mut table = vec![["column", "min", "max", "mean"].map(String::from).to_vec()];
    table.extend(
        columns.map(|(name, min, max, mean)| {
            vec![name.into(), figure(min), figure(max), figure(mean)]
        }),
    );
    output::table(&table)
}
