//! `rumbo export --ros2bag`: a log as a bag of ROS 2.

use crate::failure::Failure;
use crate::mark::Mark;
use crate::output;
use crate::place::{self, Guard, unwritable};
use rumbo_log::Log;
use rumbo_report::FileStamp;
use rumbo_ros::{bag, convert};
use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};

/// A bag: a folder with two files.
pub(crate) struct Bag {
    folder: PathBuf,
    /// Name of its MCAP file.
    file: String,
    stamp: FileStamp,
}

impl Bag {
    /// The bag of the log with this name, in a folder.
    pub(crate) fn of(stem: &str, folder: &Path, stamp: FileStamp) -> Self {
        Self {
            folder: folder.join(format!("{stem}.ros2bag")),
            file: format!("{stem}.mcap"),
            stamp,
        }
    }

    fn paths(&self) -> [PathBuf; 2] {
        [&self.file, "metadata.yaml"].map(|name| self.folder.join(name))
    }

    /// Whether its files may be written.
    pub(crate) fn check(&self, guard: &Guard) -> Result<(), Failure> {
        let mark = Mark::of(&self.stamp);
        self.paths()
            .iter()
            .try_for_each(|path| guard.check(path, &mark))
    }

    /// Writes it, with the sonars as a scan if that is wanted, and prints where it is.
    pub(crate) fn write(&self, path: &Path, log: &Log, with_scan: bool) -> Result<(), Failure> {
        let messages = convert::messages(log, with_scan)
            .map_err(|error| Failure::Input(format!("{}: {error}", path.display())))?;
        place::folder(&self.folder)?;
        let [mcap, metadata] = self.paths();
        place::make(&mcap, |place| {
            let written = File::create(place)
                .and_then(|file| bag::write(BufWriter::new(file), &messages, self.stamp.text()));
            written.map(drop).map_err(|error| unwritable(&mcap, &error))
        })?;
        let text = bag::metadata(&messages, &self.file);
        place::write(&metadata, format!("# {}\n{text}", self.stamp.text()))?;
        output::line(&self.folder.display().to_string())
    }
}
