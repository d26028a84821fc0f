//! The experiments, a file for each: what its chapter shows, and which of its metrics appear in the summary.

mod beside;
mod manual;
mod manual_tables;
pub(crate) mod maps;
mod mode1;
mod mode2;
mod mode5;
mod mode6;
mod mode7;
mod mode8;
mod mode8_beside;
mod mode8_machines;
pub(crate) mod panels;
pub(crate) mod parts;
mod pursuit;
mod wall;

use crate::content;
use crate::data::Data;
use crate::places::Places;
use crate::text::{Language, Text};

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

const fn highlight(scenario: &'static str, metric: &'static str, real: Option<f64>) -> Highlight {
    Highlight {
        scenario,
        metric,
        of: None,
        real,
    }
}

/// All experiments, in the order of the report.
pub const EXPERIMENTS: &[Experiment] = &[
    manual::EXPERIMENT,
    mode1::EXPERIMENT,
    mode2::EXPERIMENT,
    wall::MODE3,
    wall::MODE4,
    mode5::EXPERIMENT,
    mode6::EXPERIMENT,
    mode7::EXPERIMENT,
    mode8::EXPERIMENT,
    pursuit::EXPERIMENT,
];
