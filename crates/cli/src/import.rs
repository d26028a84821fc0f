//! `rumbo import`: a CSV of the original program, or what another program recorded, checked and converted to a log.
//!
//! Of the original's CSV the log holds one JSON message per row in SI units, with its schema, on the topic `telemetry`, and the CSV itself
//! as an attachment, so that nothing is lost. `rumbo identify` reads both. For a damaged recording the valid rows are
//! attached as a CSV, and the original file too. Tables and bags of others: `foreign`.

mod columns;
mod foreign;
mod guess;
mod made;
mod table;

use crate::args::ImportArgs;
use crate::capture;
use crate::csv_rows::{self, Column, Recording};
use crate::failure::Failure;
use crate::output::{self, figure};
use crate::place::{self, Guard};
use mcap::records::{MessageHeader, Metadata};
use mcap::{Attachment, WriteOptions};
use rumbo_experiment::files::bounded::{LONGEST_LOG, LONGEST_RECORDING, read_at_most};
use rumbo_identify::dialect;
use rumbo_log::{CSV, MAGIC};
use rumbo_ros::recorded::is_recorded;
use rumbo_station::log_file;
use serde_json::{Map, Value, json};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::ffi::OsString;
use std::io::Cursor;
use std::path::{Path, PathBuf};

/// Media type of a recording with skipped lines.
const AS_IT_WAS: &str = "application/octet-stream";

/// Checks, converts, writes and sums up.
pub(crate) fn import(args: &ImportArgs) -> Result<(), Failure> {
    let shown = args.file.display();
    let bytes = read_at_most(&args.file, LONGEST_LOG).map_err(|error| {
        Failure::Input(format!(
            "{shown}: cannot be read ({error}); give the path of a table, a bag or a log"
        ))
    })?;
    if bytes.is_empty() {
        return Err(Failure::Input(format!(
            "{shown}: is empty; give a table with rows"
        )));
    }
    let out = args.out.clone().unwrap_or_else(|| {
        let stem = args.file.file_stem().unwrap_or(args.file.as_os_str());
        // Beside a log of another program, which has that ending already.
        let is_mcap = bytes.starts_with(MAGIC);
        let name = [
            stem.to_os_string(),
            if is_mcap { "-rumbo.mcap" } else { ".mcap" }.into(),
        ];
        PathBuf::from(name.into_iter().collect::<OsString>())
    });
    let guard = Guard::new([&args.file], args.overwrite.force);
    if is_recorded(&bytes) {
        if log_file::read_replay(&args.file).is_ok() {
            let what = "is a log already; `rumbo replay` shows it";
            return Err(Failure::Input(format!("{shown}: {what}")));
        }
        return foreign::import_bag(args, &bytes, &out, &guard);
    }
    if bytes.len() as u64 > LONGEST_RECORDING {
        let most = LONGEST_RECORDING >> 20;
        return Err(Failure::Input(format!(
            "{shown}: is longer than {most} MB; cut the table into parts"
        )));
    }
    let text =
        dialect::plain(&bytes).map_err(|error| Failure::Input(format!("{shown}: {error}")))?;
    if args.columns.is_empty() && capture::is_one(&text) {
        return capture::import(args, &text, &out, &guard);
    }
    let is_the_originals = args.columns.is_empty() && csv_rows::is_one(&text);
    if !is_the_originals && foreign::import_table(args, &text, &out, &guard)? {
        return Ok(());
    }
    let recording = csv_rows::parse(&args.file, &text)?;
    recording.left_out.report(&args.file);
    let log = encode(&recording, &args.file, &bytes).map_err(Failure::input)?;
    guard.make_equal(&out, |place| {
        std::fs::write(place, &log).map_err(|error| place::unwritable(&out, &error))
    })?;
    summary(&recording, &out, args.json)
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
    let schema = schema(&recording.columns).to_string();
    let schema = log.add_schema("original_telemetry", "jsonschema", schema.as_bytes())?;
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
    let mut attach = |name: &str, media_type: &str, data: &[u8]| {
        log.attach(&Attachment {
            log_time: 0,
            create_time: 0,
            name: name.to_owned(),
            media_type: media_type.to_owned(),
            data: Cow::Borrowed(data),
        })
    };
    if recording.left_out.is_empty() {
        attach(&name, CSV, bytes)?;
    } else {
        attach(&name, CSV, recording.sound.as_bytes())?;
        attach(&format!("{name}.original"), AS_IT_WAS, bytes)?;
    }
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

/// Of a message: a number for each column but the time.
fn schema(columns: &[Column]) -> Value {
    let columns = columns.iter().skip(1);
    let properties: Map<String, Value> = columns
        .map(|column| (column.name.clone(), json!({ "type": "number" })))
        .collect();
    json!({ "type": "object", "title": "original_telemetry", "properties": properties })
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
            "longest_gap_s": gap_s, "columns": columns, "left_out": recording.left_out.json(),
        }));
    }
    output::line(&format!(
        "{}: {modes} of the original program, {} in {} s, longest gap {} s",
        out.display(),
        output::counted(rows, "row"),
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
