//! The results of a report's runs, and what was requested.

use crate::content;
use crate::places::Places;
use crate::real::{Real, RealRun};
use crate::signals::ReportedRun;
use crate::text::{Language, Text};
use std::collections::BTreeMap;

/// An experiment of the report.
#[derive(Debug)]
pub struct Experiment {
    /// Its name for `--only`, and its place in the page.
    pub name: &'static str,
    /// Number of its chapter.
    pub number: &'static str,
    /// The scenarios that it is made of.
    pub scenarios: &'static [&'static str],
    /// Metrics of the summary.
    pub(crate) highlights: &'static [Highlight],
    /// Computes what the places of its chapter show.
    pub(crate) fill: fn(&mut Places, &Data),
}

impl Experiment {
    /// The title of its chapter.
    #[must_use]
    pub fn title(&self, language: Language) -> String {
        content::title(language, self.name)
    }
}

/// A metric of the summary, and what the robot of the original report did.
#[derive(Debug)]
pub(crate) struct Highlight {
    pub(crate) scenario: &'static str,
    pub(crate) metric: &'static str,
    /// The part of the experiment, where the metric's name does not show it.
    pub(crate) of: Option<Text>,
    /// In the metric's own unit.
    pub(crate) real: Option<f64>,
}

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
    pub outcomes: BTreeMap<String, ReportedRun>,
    /// The same with the references of the recorded run at their times.
    pub as_recorded: BTreeMap<String, ReportedRun>,
    /// Recorded runs, where there are any.
    pub real: Real,
}

impl Data {
    pub(crate) fn outcome(&self, scenario: &str) -> Option<&ReportedRun> {
        self.outcomes.get(scenario)
    }

    /// Another program than ours drove the robot: what our controller does is no part of its report.
    pub(crate) fn is_foreign(&self) -> bool {
        let mut setups = self.outcomes.values().map(|outcome| &outcome.setup);
        setups.any(|setup| !setup.takes_parameters())
    }

    /// Our run beside a recorded one, and that one.
    pub(crate) fn beside(&self, scenario: &str) -> Option<(&ReportedRun, &RealRun)> {
        let recording = self.real.runs.get(scenario)?;
        let ours = self
            .as_recorded
            .get(scenario)
            .or_else(|| self.outcomes.get(scenario))?;
        Some((ours, recording))
    }

    /// The runs of an experiment's scenarios.
    pub(crate) fn of(&self, experiment: &Experiment) -> Vec<&ReportedRun> {
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
