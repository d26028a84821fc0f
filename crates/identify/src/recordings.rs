//! Recorded runs from files: CSVs of the original program, logs that carry one, and logs of ours or made of other programs'.

use crate::dialect;
use crate::error::IdentifyError;
use crate::fit::{GENERATIONS, Identification, check, identify, leave_one_out};
use crate::foreign::foreign;
use crate::log::{DriveLog, RobotProgram};
use crate::progress::FitProgress;
use crate::score::RunScore;
use crate::sonar_stats::{self, Comparison, SonarLog};
use crate::stretches::stretches;
use rumbo_log::{ANOTHER, Log, recorded_csv};
use rumbo_plant::params::Params;
use rumbo_wire::csv;
use rumbo_wire::text::RowKind;
use serde::Serialize;
use std::io::{self, Cursor};
use std::path::{Path, PathBuf};

/// What comes of recordings.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum RecordingsOutcome {
    /// Parameters fitted.
    Identified(Box<Identification>),
    /// Repeated with the robot's own parameters.
    Checked {
        /// How well; none of them if the runs show nothing of the drive.
        runs: Vec<RunScore>,
    },
}

impl RecordingsOutcome {
    /// How well each run is repeated.
    #[must_use]
    pub fn runs(&self) -> &[RunScore] {
        match self {
            Self::Identified(found) => &found.runs,
            Self::Checked { runs } => runs,
        }
    }

    /// What was identified.
    #[must_use]
    pub fn identification(&self) -> Option<&Identification> {
        match self {
            Self::Identified(found) => Some(found),
            Self::Checked { .. } => None,
        }
    }
}

/// What the runs of some files show.
#[derive(Clone, Debug, Default)]
pub struct Recordings {
    /// Of the drive.
    pub drive: Vec<DriveLog>,
    /// Of the sonars, where there was a wall.
    pub sonars: Vec<SonarLog>,
    /// What is left out or missing, a line each.
    pub notes: Vec<String>,
}

impl Recordings {
    /// Reads files; `bytes` gets the content of one, within the limits of its caller.
    ///
    /// # Errors
    /// A file that cannot be read, or holds nothing for identification.
    pub fn read(
        paths: &[PathBuf],
        bytes: impl Fn(&Path) -> io::Result<Vec<u8>>,
    ) -> Result<Self, IdentifyError> {
        let mut recordings = Self::default();
        for path in paths {
            let bytes = bytes(path).map_err(|error| {
                let cause = format!("cannot be read ({error}); give the path of a CSV or a log");
                IdentifyError::read(path, cause)
            })?;
            let is_log = path.extension().is_some_and(|ending| ending == "mcap");
            match (is_log, recorded_csv(&bytes)) {
                (true, Some(csv)) => recordings.add_csv(path, &csv, paths.len() == 1)?,
                (true, None) => recordings.add_log(path, &bytes)?,
                (false, _) => recordings.add_csv(path, &bytes, paths.len() == 1)?,
            }
        }
        Ok(recordings)
    }

    /// Fits the plant to all runs together, from a robot's parameters. A robot like that one needs no search besides: the
    /// logs of our own program are of such.
    ///
    /// # Errors
    /// As [`identify`].
    pub fn identify(
        &self,
        start: &Params,
        progress: &FitProgress<'_>,
    ) -> Result<RecordingsOutcome, IdentifyError> {
        let is_ours = |log: &DriveLog| log.program == RobotProgram::Rumbo;
        let generations = match self.drive.iter().all(is_ours) {
            true => 0,
            false => GENERATIONS,
        };
        let found = identify(&self.drive, start, generations, progress)?;
        Ok(RecordingsOutcome::Identified(Box::new(found)))
    }

    /// Repeats each run on this plant ([`check`]). Runs along a wall show nothing of the drive, but all of the sonars.
    ///
    /// # Errors
    /// As [`check`]; not where the sonars are all that is shown.
    pub fn check(&self, params: &Params) -> Result<RecordingsOutcome, IdentifyError> {
        let runs = match check(&self.drive, params) {
            Ok(runs) => runs,
            Err(IdentifyError::NothingToFit) if !self.sonars.is_empty() => Vec::new(),
            Err(error) => return Err(error),
        };
        Ok(RecordingsOutcome::Checked { runs })
    }

    /// Repeats each run on what the others give ([`leave_one_out`]).
    ///
    /// # Errors
    /// As [`leave_one_out`].
    pub fn leave_one_out(
        &self,
        start: &Params,
        progress: &FitProgress<'_>,
    ) -> Result<RecordingsOutcome, IdentifyError> {
        let runs = leave_one_out(&self.drive, start, progress)?;
        Ok(RecordingsOutcome::Checked { runs })
    }

    /// The recorded figures of each sonar beside those of a simulated one.
    #[must_use]
    pub fn compare_sonars(&self, params: &Params) -> Vec<Comparison> {
        let compared = |log| sonar_stats::compare(log, params);
        self.sonars.iter().flat_map(compared).collect()
    }

    /// A log of our own program, or one that was imported of another.
    fn add_log(&mut self, path: &Path, bytes: &[u8]) -> Result<(), IdentifyError> {
        let log = Log::read_signals(Cursor::new(bytes))
            .map_err(|error| IdentifyError::read(path, error))?;
        let program = log
            .manifest
            .as_ref()
            .map(|manifest| manifest.program.as_str());
        if program == Some(ANOTHER) {
            self.drive.push(foreign(path, &log)?);
            return Ok(());
        }
        let found = stretches(path, &log)?;
        self.notes.extend(found.notes);
        self.drive.extend(found.logs);
        Ok(())
    }

    /// A CSV of the original program.
    fn add_csv(&mut self, path: &Path, bytes: &[u8], alone: bool) -> Result<(), IdentifyError> {
        let text = dialect::plain(bytes).map_err(|error| IdentifyError::read(path, error))?;
        let kind = csv::recognise(text.lines().next().unwrap_or_default());
        if kind == Some(RowKind::Mission) && !alone {
            let path = path.display();
            let note = format!("{path} is skipped: recordings of mode 8 have no PWM");
            self.notes.push(note);
            return Ok(());
        }
        let log = DriveLog::parse(path, text.as_bytes())?;
        let left_out = |error| format!("{error}; the row is left out");
        self.notes.extend(log.damaged.iter().map(left_out));
        self.drive.push(log);
        if kind == Some(RowKind::Distance) {
            let log = SonarLog::parse(path, &text)?;
            self.sonars.push(log);
        }
        Ok(())
    }
}
