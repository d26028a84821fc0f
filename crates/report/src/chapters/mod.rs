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
pub(crate) mod panels;
pub(crate) mod parts;
mod pursuit;
mod wall;

use crate::data::{Experiment, Highlight};

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
