//! The results of a report's runs, and what was requested.

use crate::chapters::Experiment;
use crate::real::{Real, Recording};
use crate::signals::Outcome;
use std::collections::BTreeMap;

/// Everything that goes into a report.
#[derive(Debug, Default)]
pub struct Data {
    /// The requested experiments, in the report's order.
    pub experiments: Vec<&'static Experiment>,
    /// The seed of all runs.
    pub seed: u64,
    /// Name and title of the robot.
    pub robot: [String; 2],
    /// File name and CRC-32 of the image that drove the robot; none: the native program.
    pub firmware: Option<[String; 2]>,
    /// By scenario.
    pub outcomes: BTreeMap<String, Outcome>,
    /// The same with the references of the recorded run at their times.
    pub as_recorded: BTreeMap<String, Outcome>,
    /// Recorded runs, where there are any.
    pub real: Real,
}

impl Data {
    pub(crate) fn outcome(&self, scenario: &str) -> Option<&Outcome> {
        self.outcomes.get(scenario)
    }

    /// Our run beside a recorded one, and that one.
    pub(crate) fn beside(&self, scenario: &str) -> Option<(&Outcome, &Recording)> {
        let recording = self.real.runs.get(scenario)?;
        let ours = self
            .as_recorded
            .get(scenario)
            .or_else(|| self.outcomes.get(scenario))?;
        Some((ours, recording))
    }

    /// The runs of an experiment's scenarios.
    pub(crate) fn of(&self, experiment: &Experiment) -> Vec<&Outcome> {
        let names = experiment.scenarios.iter();
        names.filter_map(|name| self.outcome(name)).collect()
    }

    /// Whether every run of an experiment passed.
    pub fn passes(&self, experiment: &Experiment) -> bool {
        self.of(experiment)
            .iter()
            .all(|outcome| outcome.result.pass)
    }

    /// Whether every run passed.
    pub fn pass(&self) -> bool {
        self.experiments
            .iter()
            .all(|experiment| self.passes(experiment))
    }
}
