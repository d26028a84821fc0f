//! Recorded runs of a real robot: CSVs of the original program and logs, each matched to its experiment.

#[cfg(feature = "host")]
mod folder;

#[cfg(feature = "host")]
pub use folder::read;

use crate::text::{Text, word};
use rumbo_wire::text::TextRow;
use std::collections::BTreeMap;
use thiserror::Error;

/// A recorded run.
#[derive(Clone, Debug)]
pub struct RealRun {
    /// File name without folder.
    pub file: String,
    /// Time since the first row [s], and the row.
    pub rows: Vec<(f64, TextRow)>,
    /// The robot ran our program, not the original one.
    pub ours: bool,
}

/// The run in a log of a real robot.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FromLog {
    /// The run as a CSV of the original program.
    pub csv: String,
    /// The robot ran our program.
    pub ours: bool,
}

/// A file that is shown nowhere, and why.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Skipped {
    /// File name without folder.
    pub file: String,
    /// Why.
    pub why: NotShown,
}

/// The recordings of a folder.
#[derive(Clone, Debug, Default)]
pub struct Real {
    /// By the scenario that each is a run of.
    pub runs: BTreeMap<&'static str, RealRun>,
    /// CSVs that are none, or of which there is another one.
    pub skipped: Vec<Skipped>,
}

/// Why the recordings of a folder cannot be read: what, where, what to do.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{0}")]
pub struct RealError(String);

/// Why a file is shown nowhere.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NotShown {
    /// Its header is none of the original program's.
    Header,
    /// No experiment has such a run.
    NoExperiment,
    /// Another file before it is a run of the same experiment.
    Another,
    /// It has fewer than two rows.
    Short,
    /// It is no log that can be read.
    NoLog,
    /// It is a log of a simulated robot.
    Simulated,
    /// It is a log without a run.
    NoRun,
}

impl NotShown {
    /// The reason as the report words it.
    #[must_use]
    pub const fn text(self) -> Text {
        match self {
            Self::Header => word("file-with-unknown-header"),
            Self::NoExperiment => word("file-of-no-experiment"),
            Self::Another => word("file-after-another"),
            Self::Short => word("file-too-short"),
            Self::NoLog => word("file-no-log"),
            Self::Simulated => word("file-of-simulated-robot"),
            Self::NoRun => word("file-without-run"),
        }
    }
}

impl RealRun {
    /// A signal over time; a row that has none is left out.
    pub(crate) fn signal(&self, of: impl Fn(&TextRow) -> Option<f64>) -> Vec<(f64, f64)> {
        self.rows
            .iter()
            .filter_map(|(t_s, row)| Some((*t_s, of(row)?)))
            .collect()
    }

    /// How long it lasted [s].
    pub fn duration_s(&self) -> f64 {
        self.rows.last().map_or(0.0, |(t_s, _)| *t_s)
    }

    /// When the reference changed, and to what (SI): that of the first row, and each one that differs from the one before.
    pub(crate) fn references(&self) -> Vec<(f64, f64)> {
        let value = |row: &TextRow| match row {
            TextRow::Distance(row) => Some(f64::from(row.reference_cm) / 100.0),
            TextRow::Speed(row) => Some(f64::from(row.reference_rpm) * std::f64::consts::PI / 30.0),
            _ => None,
        };
        let mut references = self.signal(value);
        references.dedup_by(|after, before| after.1 == before.1);
        references
    }
}
