//! The logs of headless runs.
//!
//! With `--out` each run writes one to that folder, and it depends only on the run's inputs. Without, they are stored
//! among the logs of sessions, with the time of day; a command of many runs keeps only some there, since each can be
//! reproduced from its seed.

use crate::failure::Failure;
use crate::logs;
use crate::output;
use crate::place;
use rumbo_experiment::files::Setup;
use rumbo_experiment::run::RunResult;
pub(crate) use rumbo_lab::run_log::{RunSource, burst, said};
use rumbo_log::Manifest;
use rumbo_station::headless::{record_run, record_run_in};
use std::path::PathBuf;

/// Most runs of a command that are recorded by default: all of them, or the first that miss a limit.
const KEPT: usize = 20;

/// Writes the log of a run, of several robots one for each, to the path that is requested for it.
pub(crate) fn write(
    source: &RunSource<'_>,
    path_of: impl Fn(Option<&str>) -> PathBuf,
    setup: &Setup,
    result: &RunResult,
) -> Result<(), Failure> {
    source.each_robot(setup, result, |manifest, run| {
        let path = &path_of(manifest.member.as_deref());
        place::make(path, |place| {
            record_run(place, manifest, run).map_err(|error| Failure::input(error.of(path)))
        })
    })
}

/// The logs that a command adds to those of sessions.
pub(crate) struct Kept {
    /// `None` where nothing is recorded, or no longer.
    folder: Option<PathBuf>,
    begun: Option<String>,
    /// There are more runs than are kept: only those that miss a limit are recorded.
    many: bool,
    logs: Vec<PathBuf>,
}

impl Kept {
    /// For a command of so many runs; `wanted`: whether it records at all.
    pub(crate) fn of(runs: usize, wanted: bool) -> Self {
        Self {
            folder: logs::folder(None).filter(|_| wanted),
            begun: Some(rumbo_station::now_utc()),
            many: runs > KEPT,
            logs: Vec::new(),
        }
    }

    /// Records a run, if it is one to keep. A failure to record does not fail the run; it is reported once.
    pub(crate) fn take(&mut self, source: &RunSource<'_>, setup: &Setup, result: &RunResult) {
        let Some(folder) = &self.folder else {
            return;
        };
        if self.logs.len() >= KEPT || (self.many && result.pass) {
            return;
        }
        let mut logs = Vec::new();
        let written = source.each_robot(setup, result, |manifest, run| {
            let manifest = Manifest {
                started: self.begun.clone(),
                ..manifest.clone()
            };
            logs.push(record_run_in(folder, &manifest, run).map_err(Failure::input)?);
            Ok::<_, Failure>(())
        });
        self.logs.extend(logs);
        if let Err(failure) = written {
            self.folder = None;
            output::note(&format!("not recording: {failure}"));
        }
    }

    /// Prints where they are.
    pub(crate) fn report(&self) {
        let which = if self.many {
            " of runs that miss a limit"
        } else {
            ""
        };
        match &self.logs[..] {
            [] => {}
            [only] => output::aside(&format!("recorded: {}", only.display())),
            [first, ..] => output::aside(&format!(
                "recorded: {} logs{which} in {}",
                self.logs.len(),
                first.parent().unwrap_or(first).display()
            )),
        }
    }
}
