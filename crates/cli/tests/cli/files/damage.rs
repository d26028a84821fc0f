//! A flipped bit is found: reported, or without any consequence for what is said of the log.

use super::{rumbo_in, scenario, status};
use crate::support;
use rumbo_station::log_file;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// What a log says, and what it says of itself: damage is in the second, or nowhere.
fn read(path: &Path) -> (String, String) {
    match log_file::read(path) {
        Err(error) => (String::new(), error.to_string()),
        Ok(mut log) => {
            let (cut, holes) = (log.cut.take(), std::mem::take(&mut log.has_holes));
            let notes = std::mem::take(&mut log.notes);
            let of_itself = format!("{cut:?} {holes} {notes:?} {}", log.duration_s());
            (format!("{log:?}"), of_itself)
        }
    }
}

/// The records of a log's data at the top, by kind and place.
fn records(bytes: &[u8]) -> Vec<(u8, Range<usize>)> {
    let mut records = Vec::new();
    let mut at = mcap::MAGIC.len();
    while at + 9 <= bytes.len() - mcap::MAGIC.len() {
        let length = u64::from_le_bytes(bytes[at + 1..at + 9].try_into().unwrap()) as usize;
        records.push((bytes[at], at..at + 9 + length));
        at += 9 + length;
    }
    records
}

fn log(folder: &Path) -> PathBuf {
    std::fs::write(folder.join("task.toml"), scenario("t", 1.0)).unwrap();
    assert!(status(&rumbo_in(folder, &["run", "task.toml", "--out", "."])) < 2);
    folder.join("task-1.mcap")
}

/// Flips a bit at each of these places; gives how many flips changed what the log says.
fn flip(path: &Path, bytes: &[u8], places: impl Iterator<Item = usize>) -> (usize, usize) {
    std::fs::write(path, bytes).unwrap();
    let sound = read(path);
    let (mut tried, mut changed) = (0, 0);
    for at in places {
        let mut damaged = bytes.to_vec();
        // Each bit of a byte in its turn.
        damaged[at] ^= 1 << (at % 8);
        std::fs::write(path, &damaged).unwrap();
        let found = read(path);
        assert!(
            found.0 == sound.0 || found.1 != sound.1,
            "byte {at}, bit {}: changed what the log says, and nothing is reported",
            at % 8
        );
        tried += 1;
        changed += usize::from(found.0 != sound.0);
    }
    (tried, changed)
}

#[test]
fn a_flipped_bit_anywhere_in_a_log_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    let path = log(folder.path());
    let bytes = std::fs::read(&path).unwrap();
    // Of a whole log not one flip is passed over.
    let sound = read(&path);
    assert!(sound.1.starts_with("None false [] "), "{}", sound.1);
    let places = (0..bytes.len()).step_by(bytes.len() / 2_500 + 1);
    for at in places {
        let mut damaged = bytes.clone();
        damaged[at] ^= 1 << (at % 8);
        std::fs::write(&path, &damaged).unwrap();
        assert_ne!(read(&path).1, sound.1, "byte {at}");
    }
}

#[test]
fn a_flipped_bit_in_a_log_that_was_cut_off_is_reported_or_changes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = log(folder.path());
    let whole = std::fs::read(&path).unwrap();
    let records = records(&whole);
    let end = records
        .iter()
        .find(|(kind, _)| *kind == mcap::records::op::DATA_END);
    let bytes = &whole[..end.unwrap().1.start];
    // Every byte that no checksum of MCAP covers, with the heads of what one does cover.
    let uncovered = records.iter().filter(|(_, place)| place.end <= bytes.len());
    let uncovered = uncovered.flat_map(|(kind, place)| match *kind {
        mcap::records::op::CHUNK | mcap::records::op::ATTACHMENT => place.start..place.start + 60,
        _ => place.clone(),
    });
    let (tried, changed) = flip(&path, bytes, uncovered);
    assert!(tried > 1_000 && changed > 100, "{tried} {changed}");
    let (tried, changed) = flip(
        &path,
        bytes,
        (0..bytes.len()).step_by(bytes.len() / 2_500 + 1),
    );
    assert!(tried > 2_000 && changed > 500, "{tried} {changed}");
}

#[test]
fn metadata_that_is_damaged_is_left_out_and_the_rest_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = log(folder.path());
    let bytes = std::fs::read(&path).unwrap();
    let sound = log_file::read(&path).unwrap();
    let metadata = records(&bytes)
        .into_iter()
        .filter(|(kind, _)| *kind == mcap::records::op::METADATA);
    let places: Vec<Range<usize>> = metadata.map(|(_, place)| place).collect();
    assert_eq!(places.len(), 2, "manifest and outcome");
    // Every byte of what they hold, digits of metrics among them, and each bit of a byte in its turn.
    let (mut tried, mut lost) = (0, 0);
    for at in places
        .into_iter()
        .flat_map(|place| place.start + 9..place.end)
    {
        let mut damaged = bytes.clone();
        damaged[at] ^= 1 << (at % 8);
        std::fs::write(&path, &damaged).unwrap();
        let log = log_file::read(&path).unwrap();
        tried += 1;
        assert_eq!(
            (log.rows.len(), log.link.len()),
            (sound.rows.len(), sound.link.len())
        );
        let is_lost = log.manifest.is_none() || log.outcome.is_none();
        assert_eq!(
            (log.has_holes, log.cut.is_some()),
            (is_lost, is_lost),
            "byte {at}"
        );
        // A length that says the same in another way.
        let is_same = (&log.manifest, &log.outcome) == (&sound.manifest, &sound.outcome);
        assert!(is_lost || is_same && !log.notes.is_empty(), "byte {at}");
        lost += usize::from(is_lost);
    }
    assert!(tried > 500 && lost > tried - 20, "{tried} {lost}");
    std::fs::write(&path, &bytes).unwrap();
    let rerun = rumbo_in(folder.path(), &["rerun", "task-1.mcap"]);
    assert_eq!(support::stderr(&rerun), "");
}
