//! Which figures of the report's robot are compared, and with which runs of its program: `tools/data/fidelity.toml`.

use crate::data;
use rumbo_experiment::files::FileError;
use serde::Deserialize;

/// A figure of a run.
#[derive(Deserialize)]
pub(crate) struct Figure {
    pub(crate) what: String,
    /// A metric of the run; `measured.stepN` is the settling of a step by the speeds that the program measured.
    pub(crate) metric: String,
    pub(crate) unit: String,
    /// What the recorded run shows, or the report says where no recording is left; NaN where it is read from the run.
    pub(crate) recorded: f64,
}

/// A run of the report's robot, and the scenario that repeats it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Experiment {
    pub(crate) name: String,
    pub(crate) scenario: String,
    /// Its recording, from which battery and floor of that day are read.
    pub(crate) recording: Option<String>,
    /// Longer than the scenario, for a slow program [s].
    pub(crate) duration_s: Option<f64>,
    /// Commands from the third on come this many times later.
    pub(crate) later: Option<f64>,
    pub(crate) figures: Vec<Figure>,
}

#[derive(Deserialize)]
struct File {
    experiment: Vec<Experiment>,
}

/// All of them.
pub(crate) fn experiments() -> Result<Vec<Experiment>, FileError> {
    data::<File>(include_str!("../../data/fidelity.toml")).map(|file| file.experiment)
}

impl Figure {
    /// Which step's settling it is, by the speeds that the program measured, counted from 0.
    pub(crate) fn measured_step(&self) -> Option<usize> {
        let number = self.metric.strip_prefix("measured.step")?;
        number.parse::<usize>().ok()?.checked_sub(1)
    }
}

impl Experiment {
    /// Any of its figures is read off measured speeds.
    pub(crate) fn is_measured(&self) -> bool {
        self.figures
            .iter()
            .any(|figure| figure.measured_step().is_some())
    }
}
