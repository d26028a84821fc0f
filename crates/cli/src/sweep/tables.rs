//! The runs of a sweep as tables: CSV for people and spreadsheets, Parquet for data frames.
//!
//! One row per run: point, seed, the parameters, whether it passes, every metric. Empty (null) where what is measured
//! never happened, or where the run has no such metric.

use crate::failure::Failure;
use parquet::basic::{Compression, Repetition, Type as Physical};
use parquet::data_type::{BoolType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;
use rumbo_experiment::sweep::Sweep;
use std::collections::BTreeSet;
use std::sync::Arc;

/// Columns before the parameters, and between them and the metrics.
const BEFORE: [&str; 2] = ["point", "seed"];
const PASS: &str = "pass";

/// Names of all metrics of any run.
fn metrics(sweep: &Sweep) -> Vec<&str> {
    let names = sweep.rows.iter().flat_map(|row| row.metrics.keys());
    let names: BTreeSet<&str> = names.map(String::as_str).collect();
    names.into_iter().collect()
}

/// As comma-separated values.
pub(super) fn csv(sweep: &Sweep) -> String {
    let metrics = metrics(sweep);
    let axes = sweep.plan.axes.iter().map(|axis| axis.name.as_str());
    let header: Vec<&str> = BEFORE
        .into_iter()
        .chain(axes)
        .chain([PASS])
        .chain(metrics.iter().copied())
        .collect();
    let mut text = header.join(",") + "\n";
    for row in &sweep.rows {
        let mut cells = vec![row.point.to_string(), row.seed.to_string()];
        let values = sweep.plan.points[row.point].iter();
        cells.extend(values.map(ToString::to_string));
        cells.push(row.pass.to_string());
        cells.extend(metrics.iter().map(|name| {
            let value = row.metrics.get(*name).filter(|value| value.is_finite());
            value.map(ToString::to_string).unwrap_or_default()
        }));
        text += &(cells.join(",") + "\n");
    }
    text
}

/// As Parquet.
pub(super) fn parquet(sweep: &Sweep) -> Result<Vec<u8>, Failure> {
    write(sweep).map_err(Failure::input)
}

fn write(sweep: &Sweep) -> Result<Vec<u8>, ParquetError> {
    let metrics = metrics(sweep);
    let column = |name: &str, kind, repetition| {
        let column = Type::primitive_type_builder(name, kind).with_repetition(repetition);
        column.build().map(Arc::new)
    };
    let required = |name: &str, kind| column(name, kind, Repetition::REQUIRED);
    let mut columns = Vec::new();
    for name in BEFORE {
        columns.push(required(name, Physical::INT64)?);
    }
    for axis in &sweep.plan.axes {
        columns.push(required(&axis.name, Physical::DOUBLE)?);
    }
    columns.push(required(PASS, Physical::BOOLEAN)?);
    for name in &metrics {
        columns.push(column(name, Physical::DOUBLE, Repetition::OPTIONAL)?);
    }
    let schema = Type::group_type_builder("runs")
        .with_fields(columns)
        .build()?;
    let properties = WriterProperties::builder().set_compression(Compression::LZ4_RAW);
    let mut writer =
        SerializedFileWriter::new(Vec::new(), Arc::new(schema), Arc::new(properties.build()))?;
    let mut group = writer.next_row_group()?;
    let rows = &sweep.rows;
    let mut whole = |values: Vec<i64>| -> Result<(), ParquetError> {
        if let Some(mut column) = group.next_column()? {
            column
                .typed::<Int64Type>()
                .write_batch(&values, None, None)?;
            column.close()?;
        }
        Ok(())
    };
    whole(rows.iter().map(|row| row.point as i64).collect())?;
    // The same 64 bits: seeds above 2^63 read as negative numbers.
    whole(rows.iter().map(|row| row.seed.cast_signed()).collect())?;
    for axis in 0..sweep.plan.axes.len() {
        let values = rows.iter().map(|row| sweep.plan.points[row.point][axis]);
        let values: Vec<f64> = values.collect();
        if let Some(mut column) = group.next_column()? {
            column
                .typed::<DoubleType>()
                .write_batch(&values, None, None)?;
            column.close()?;
        }
    }
    if let Some(mut column) = group.next_column()? {
        let values: Vec<bool> = rows.iter().map(|row| row.pass).collect();
        column
            .typed::<BoolType>()
            .write_batch(&values, None, None)?;
        column.close()?;
    }
    for name in metrics {
        let values = rows.iter().map(|row| {
            let value = row.metrics.get(name).copied();
            value.filter(|value| value.is_finite())
        });
        let values: Vec<Option<f64>> = values.collect();
        let there: Vec<i16> = values
            .iter()
            .map(|value| i16::from(value.is_some()))
            .collect();
        let values: Vec<f64> = values.into_iter().flatten().collect();
        if let Some(mut column) = group.next_column()? {
            column
                .typed::<DoubleType>()
                .write_batch(&values, Some(&there), None)?;
            column.close()?;
        }
    }
    group.close()?;
    writer.into_inner()
}
