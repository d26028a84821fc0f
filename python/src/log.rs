//! Logs as columns.

use crate::guard::{detached, unreadable};
use numpy::IntoPyArray;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rumbo_log::{Log, ReadingSource};
use std::collections::BTreeMap;
use std::fs::File;
use std::path::PathBuf;

/// Readings of one source: their times [s], and each signal by its name.
#[derive(Default)]
struct Readings {
    t_s: Vec<f64>,
    signals: BTreeMap<String, Vec<f64>>,
}

/// Reads a log: a dictionary of its parts.
#[pyfunction]
pub(crate) fn read_log(py: Python<'_>, path: PathBuf) -> PyResult<Bound<'_, PyDict>> {
    let shown = path.display().to_string();
    let file = File::open(&path).map_err(|error| {
        let what = format!("cannot be read ({error}); give the path of an existing log");
        unreadable(error.raw_os_error(), what, &shown)
    })?;
    let log = detached(py, || Log::read_signals(file))?
        .map_err(|error| PyValueError::new_err(format!("{shown}: {error}")))?;
    let parts = PyDict::new(py);
    parts.set_item("signals", signals(py, &log)?)?;
    let readings = PyDict::new(py);
    for (source, of_source) in by_source(&log) {
        let columns = PyDict::new(py);
        columns.set_item("t_s", of_source.t_s.into_pyarray(py))?;
        for (name, values) in of_source.signals {
            columns.set_item(name, values.into_pyarray(py))?;
        }
        readings.set_item(source, columns)?;
    }
    parts.set_item("readings", readings)?;
    let events: Vec<_> = log.events().collect();
    parts.set_item("events", events)?;
    parts.set_item("parameters", log.parameters())?;
    parts.set_item("manifest", json(log.manifest.as_ref())?)?;
    let outcome = log.outcome.as_ref().map(|outcome| {
        let parts = PyDict::new(py);
        parts.set_item("passed", outcome.pass)?;
        parts.set_item("metrics", &outcome.metrics)?;
        parts.set_item("failures", &outcome.failures)?;
        PyResult::Ok(parts)
    });
    parts.set_item("outcome", outcome.transpose()?)?;
    parts.set_item("cut", &log.cut)?;
    parts.set_item("notes", &log.notes)?;
    Ok(parts)
}

/// The telemetry with the ground truth beside it, an array for each signal that is known at any time.
fn signals<'py>(py: Python<'py>, log: &Log) -> PyResult<Bound<'py, PyDict>> {
    let columns = PyDict::new(py);
    for (column, name) in rumbo_log::Row::names().enumerate() {
        let values: Vec<f64> = log
            .rows
            .iter()
            .map(|row| row.get(column).unwrap_or(f64::NAN))
            .collect();
        if column == 0 || values.iter().any(|value| !value.is_nan()) {
            columns.set_item(name, values.into_pyarray(py))?;
        }
    }
    Ok(columns)
}

/// A signal that a reading lacks is not a number there.
fn by_source(log: &Log) -> BTreeMap<String, Readings> {
    let mut sources: BTreeMap<String, Readings> = BTreeMap::new();
    for reading in &log.readings {
        let of_source = sources.entry(name(reading.source)).or_default();
        let before = of_source.t_s.len();
        of_source.t_s.push(reading.t_ms as f64 / 1e3);
        for (signal, value) in reading.names.iter().zip(&reading.values) {
            let values = of_source.signals.entry(signal.clone()).or_default();
            values.resize(before, f64::NAN);
            values.push(f64::from(*value));
        }
    }
    for of_source in sources.values_mut() {
        let rows = of_source.t_s.len();
        for values in of_source.signals.values_mut() {
            values.resize(rows, f64::NAN);
        }
    }
    sources
}

fn name(source: ReadingSource) -> String {
    match source {
        ReadingSource::Truth => "truth".to_owned(),
        ReadingSource::Loops => "loops".to_owned(),
        ReadingSource::Others => "others".to_owned(),
        ReadingSource::Usart(number) => format!("usart{number}"),
    }
}

fn json(part: Option<&impl serde::Serialize>) -> PyResult<Option<String>> {
    part.map(serde_json::to_string)
        .transpose()
        .map_err(|error| PyValueError::new_err(error.to_string()))
}
