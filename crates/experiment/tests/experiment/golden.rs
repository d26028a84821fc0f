//! Metrics of every scenario at three seeds, kept in `tests/golden/`: a change of behaviour is a readable difference.
//!
//! After an intended change: raise `MODEL` in `crates/experiment/src/lib.rs`,
//! `RUMBO_BLESS=1 cargo test -p rumbo-experiment --test experiment golden`, and read the difference.

#![cfg(test)]

use crate::closed_loop::driven;
use rumbo_experiment::MODEL;
use rumbo_experiment::files::{Kind, Library};
use std::fmt::Write as _;
use std::path::Path;

#[test]
fn metrics_are_those_of_the_golden_files() {
    let library = Library::new();
    let folder = &Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/golden");
    let bless = std::env::var_os("RUMBO_BLESS").is_some();
    let mut wrong = Vec::new();
    for name in library.list(Kind::Scenario) {
        let mut text = String::new();
        for run in &driven(&name)[..3] {
            writeln!(text, "[seed.{}]", run.seed).unwrap();
            for (metric, value) in &run.metrics {
                writeln!(text, "\"{metric}\" = {value:.4}").unwrap();
            }
        }
        let path = folder.join(format!("{name}.toml"));
        if bless {
            std::fs::write(&path, &text).unwrap();
        } else if std::fs::read_to_string(&path).unwrap_or_default() != text {
            wrong.push(name);
        }
    }
    assert!(
        wrong.is_empty(),
        "other metrics than in tests/golden: {wrong:?}; if that is meant, raise MODEL, run with RUMBO_BLESS=1 and read the difference"
    );
    // Beside the metrics are the model's number and their checksum: other metrics need another number.
    let (number, path) = (checksum(folder), folder.join("model.txt"));
    let known = std::fs::read_to_string(&path).unwrap_or_default();
    let (old, sum) = known.trim_end().split_once(' ').unwrap_or(("0", ""));
    if bless && old != MODEL.to_string() {
        std::fs::write(&path, format!("{MODEL} {number}\n")).unwrap();
        return;
    }
    assert_eq!(
        (old, sum),
        (MODEL.to_string().as_str(), number.as_str()),
        "tests/golden changed: raise MODEL in crates/experiment/src/lib.rs, then run with RUMBO_BLESS=1"
    );
}

/// CRC-32 of all metrics, in the order of their files' names, with any line ending.
fn checksum(folder: &Path) -> String {
    let files = std::fs::read_dir(folder).unwrap();
    let mut paths: Vec<_> = files.map(|file| file.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|ending| ending == "toml"));
    paths.sort();
    let crc = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);
    let mut sum = crc.digest();
    for path in paths {
        let text = std::fs::read_to_string(path).unwrap();
        sum.update(text.replace("\r\n", "\n").as_bytes());
    }
    format!("{:08x}", sum.finalize())
}
