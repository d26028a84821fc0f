//! The runs of a sweep as they are done, a line of JSON each: what was interrupted goes on from here.
//!
//! The first line says what is run. A line that was cut off by the end of the disk or the power is left out.

use crate::failure::Failure;
use crate::place;
use rumbo_experiment::sweep::{RunRow, SweepPlan};
use serde::{Deserialize, Serialize};
use std::fs::{File, OpenOptions};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// What is run: two sweeps with the same are the same.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Header {
    /// Version of Rumbo.
    pub(super) rumbo_sweep: String,
    /// Number of the model.
    pub(super) model: u32,
    pub(super) scenario: String,
    /// The axes as they were given.
    pub(super) axes: Vec<String>,
    pub(super) design: String,
    pub(super) seed: u64,
    pub(super) runs: u32,
    pub(super) program: String,
    /// Hash of the image.
    pub(super) image: Option<String>,
    pub(super) parameters: Vec<(String, f64)>,
    /// Checksum of the files of scenario, robot and world, and of rig and wiring.
    pub(super) files: String,
}

impl Header {
    /// What is not the same, by name.
    fn differs(&self, other: &Self) -> Vec<&'static str> {
        let same = [
            (
                "version",
                self.rumbo_sweep == other.rumbo_sweep && self.model == other.model,
            ),
            ("scenario", self.scenario == other.scenario),
            ("axes", self.axes == other.axes),
            ("design", self.design == other.design),
            ("seed", self.seed == other.seed),
            ("runs", self.runs == other.runs),
            (
                "program",
                self.program == other.program && self.image == other.image,
            ),
            ("parameters", self.parameters == other.parameters),
            (
                "files of scenario, robot or world",
                self.files == other.files,
            ),
        ];
        let differ = same.into_iter().filter(|(_, same)| !same);
        differ.map(|(name, _)| name).collect()
    }
}

/// The file while it is written.
pub(super) struct Journal {
    path: PathBuf,
    file: File,
}

impl Journal {
    /// Goes on with the sweep of this file; returns the runs that are done. `None` if there is no file. A complete sweep
    /// begins again without `resume`.
    ///
    /// # Errors
    /// It is of another sweep, or a line is none.
    pub(super) fn resume(
        path: &Path,
        header: &Header,
        plan: &SweepPlan,
        resume: bool,
    ) -> Result<Option<(Self, Vec<RunRow>)>, Failure> {
        let Some(text) = read(path)? else {
            return Ok(None);
        };
        let before = Content::parse(path, &text, header, plan)?;
        if !resume && before.rows.len() == plan.len() {
            return Ok(Some((Self::begin(path, header)?, Vec::new())));
        }
        if !resume {
            return Err(Failure::Input(format!(
                "{}: has {} of {} runs of this sweep; go on with --resume, or begin again with --force",
                path.display(),
                before.rows.len(),
                plan.len()
            )));
        }
        let open = || {
            let mut file = OpenOptions::new().write(true).open(path)?;
            file.set_len(before.length as u64)?;
            file.seek(SeekFrom::End(0))?;
            Ok(file)
        };
        let file = open().map_err(|error| place::unwritable(path, &error))?;
        let path = path.to_owned();
        Ok(Some((Self { path, file }, before.rows)))
    }

    /// Begins one.
    ///
    /// # Errors
    /// The file cannot be written.
    pub(super) fn begin(path: &Path, header: &Header) -> Result<Self, Failure> {
        let file = File::create(path).map_err(|error| place::unwritable(path, &error))?;
        let mut journal = Self {
            path: path.to_owned(),
            file,
        };
        journal.put(header)?;
        Ok(journal)
    }

    /// Adds a line.
    pub(super) fn put(&mut self, line: &impl Serialize) -> Result<(), Failure> {
        let text = serde_json::to_string(line).map_err(Failure::input)?;
        let written = self.file.write_all((text + "\n").as_bytes());
        written.map_err(|error| place::unwritable(&self.path, &error))
    }
}

/// What is in a file.
struct Content {
    rows: Vec<RunRow>,
    /// Of the lines that are whole \[bytes\].
    length: usize,
}

impl Content {
    fn parse(path: &Path, text: &str, header: &Header, plan: &SweepPlan) -> Result<Self, Failure> {
        let wrong = |line: usize, what: &str| {
            Failure::Input(format!(
                "{}, line {line}: {what}; choose another folder with --out, or begin again with --force",
                path.display()
            ))
        };
        let is_whole = |line: &&str| line.ends_with('\n');
        let mut lines = text.split_inclusive('\n').filter(is_whole);
        let first = lines.next().unwrap_or_default();
        let before: Header = serde_json::from_str(first).map_err(|_| wrong(1, "is of no sweep"))?;
        let differs = before.differs(header);
        if !differs.is_empty() {
            let what = format!(
                "is of another sweep, which differs in {}",
                differs.join(", ")
            );
            return Err(wrong(1, &what));
        }
        let (mut rows, mut length) = (Vec::new(), first.len());
        for (index, line) in lines.enumerate() {
            let row: RunRow =
                serde_json::from_str(line).map_err(|_| wrong(index + 2, "is no run"))?;
            if index < plan.len() && plan.job(index) != (row.point, row.seed) {
                return Err(wrong(index + 2, "is a run of another sweep"));
            }
            rows.push(row);
            length += line.len();
        }
        Ok(Self { rows, length })
    }
}

fn read(path: &Path) -> Result<Option<String>, Failure> {
    let unreadable = |error: std::io::Error| Failure::Input(format!("{}: {error}", path.display()));
    let mut text = String::new();
    match File::open(path) {
        Ok(mut file) => file.read_to_string(&mut text).map_err(unreadable)?,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(unreadable(error)),
    };
    Ok(Some(text))
}
