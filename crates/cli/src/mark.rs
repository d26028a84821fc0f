//! Marks that show that Rumbo wrote a file for the same run or report, so that it may be overwritten.
//!
//! | file | its mark |
//! |---|---|
//! | log | the manifest's scenario, seed and options; of a program its file's name, since it may be changed and run again |
//! | result | its first keys: scenario, seed, and the scenario's path if it has one; and the log beside it |
//! | table | the names of its columns |
//! | SVG, HTML, waveform, profile | a comment, `rumbo compare 5a1c09e2`: the command and a checksum of what it was about |

use rumbo_experiment::files::{Overrides, Setup};
use rumbo_lab::manifest;
use rumbo_log::{LogKind, Manifest};
use rumbo_report::FileStamp;
use rumbo_station::log_file;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// A mark stands within so many bytes of a file's beginning.
const BEGINNING: u64 = 4_096;

/// The mark of a file of Rumbo.
#[derive(Clone, Debug)]
pub(crate) enum Mark {
    /// This text at its beginning.
    Text(String),
    /// The log of a run with this manifest.
    Log(Box<Manifest>),
}

impl Mark {
    /// That of the log of a run of this setup, as these overrides made it.
    pub(crate) fn run(setup: &Setup, overrides: &Overrides, seed: u64) -> Self {
        let run = manifest::of(LogKind::Run, setup, overrides, seed);
        Self::Log(Box::new(asked(run)))
    }

    /// The stamp of what else is written of such a run, by a command.
    pub(crate) fn stamp(
        command: &str,
        setup: &Setup,
        overrides: &Overrides,
        seed: u64,
    ) -> FileStamp {
        let run = asked(manifest::of(LogKind::Run, setup, overrides, seed));
        FileStamp::of(command, &[format!("{run:?}")])
    }

    /// That of a stamped file.
    pub(crate) fn of(stamp: &FileStamp) -> Self {
        Self::Text(stamp.text().to_owned())
    }

    /// A table that begins with the names of its columns.
    pub(crate) fn table(text: &str) -> Self {
        let header = text.split_inclusive('\n').next().unwrap_or_default();
        Self::Text(header.to_owned())
    }

    /// Whether a file carries it.
    pub(crate) fn is_on(&self, path: &Path) -> bool {
        match self {
            Self::Log(run) => log_file::summary(path)
                .ok()
                .and_then(|log| log.manifest)
                .is_some_and(|log| log.kind == LogKind::Run && asked(log) == **run),
            Self::Text(text) => beginning(path).is_some_and(|beginning| beginning.contains(text)),
        }
    }
}

/// What was asked for: the rest depends on it, on the version, and on what the files hold.
fn asked(run: Manifest) -> Manifest {
    let program = Path::new(&run.program).file_name().unwrap_or_default();
    Manifest {
        program: program.to_string_lossy().into_owned(),
        scenario: run.scenario,
        seed: run.seed,
        robot: run.robot,
        world: run.world,
        rig: run.rig,
        wiring: run.wiring,
        policy: run.policy,
        parameters: run.parameters,
        texts: run.texts,
        usb_texts: run.usb_texts,
        part_texts: run.part_texts,
        hand_texts: run.hand_texts,
        line_ending: run.line_ending,
        ..Manifest::default()
    }
}

fn beginning(path: &Path) -> Option<String> {
    let mut bytes = Vec::new();
    let file = File::open(path).ok()?;
    file.take(BEGINNING).read_to_end(&mut bytes).ok()?;
    Some(String::from_utf8_lossy(&bytes).into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use rumbo_plot::{Curve, Ink, Panel, Plot, Sheet, Words};

    #[test]
    fn a_stamped_file_is_known_again_and_stays_what_it_is() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x");
        let line = Curve::new("a", Ink::First, vec![(0.0, 0.0), (1.0, 1.0)]);
        let plot = Plot::over_time(vec![Panel::new("cm", vec![line])]);
        let sheet = Sheet::new(1).with("t", plot.picture(Words::default(), 300.0));
        let svg = sheet.svg();
        let html = b"<!doctype html>\n<html lang=\"en\">\n".to_vec();
        for file in [svg.into_bytes(), html] {
            let stamp = |about: &str| FileStamp::of("compare", &["a".into(), about.into()]);
            std::fs::write(&path, stamp("b").put_on(file.clone())).unwrap();
            assert!(Mark::of(&stamp("b")).is_on(&path));
            assert!(!Mark::of(&stamp("c")).is_on(&path));
            std::fs::write(&path, file).unwrap();
            assert!(!Mark::of(&stamp("b")).is_on(&path));
        }
    }
}
