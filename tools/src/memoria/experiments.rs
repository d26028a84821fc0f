//! The scenarios, the report's program's time in each, and the metric compared: `tools/data/memoria.toml`.

use crate::data;
use rumbo_experiment::files::FileError;
use serde::Deserialize;

/// One row.
#[derive(Deserialize)]
pub(crate) struct Metric {
    pub(crate) what: String,
    pub(crate) name: String,
    pub(crate) unit: String,
}

/// One table.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Experiment {
    pub(crate) scenario: String,
    /// Ending of the image's name.
    pub(crate) sketch: String,
    pub(crate) duration_s: f64,
    /// Lines sent for the profile besides `ON`.
    pub(crate) line: String,
    pub(crate) metric: Metric,
}

#[derive(Deserialize)]
struct File {
    experiment: Vec<Experiment>,
}

/// All of them.
pub(crate) fn experiments() -> Result<Vec<Experiment>, FileError> {
    data::<File>(include_str!("../../data/memoria.toml")).map(|file| file.experiment)
}
