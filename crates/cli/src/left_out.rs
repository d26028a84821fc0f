//! Damaged lines of a recording that an import skips, and the notes about them.

use crate::output;
use serde_json::{Value, json};
use std::path::Path;

/// Lines listed one by one.
const SHOWN: usize = 5;

/// Skipped lines, with their reasons.
#[derive(Debug, Default)]
pub(crate) struct LeftOut {
    header: Option<String>,
    rows: Vec<(usize, String)>,
}

impl LeftOut {
    /// Skips a damaged header.
    pub(crate) fn header(&mut self, why: String) {
        self.header = Some(why);
    }

    /// Skips a line, by its number.
    pub(crate) fn row(&mut self, line: usize, why: String) {
        self.rows.push((line, why));
    }

    /// No line is skipped.
    pub(crate) fn is_empty(&self) -> bool {
        self.header.is_none() && self.rows.is_empty()
    }

    /// The first error, if at least half of the lines are damaged: then it is not such a recording at all.
    pub(crate) fn too_much(&self, sound: usize) -> Option<(usize, String)> {
        self.rows
            .first()
            .filter(|_| self.rows.len() >= sound)
            .cloned()
    }

    fn all(&self) -> impl Iterator<Item = (usize, &String)> {
        let header = self.header.iter().map(|why| (1, why));
        header.chain(self.rows.iter().map(|(line, why)| (*line, why)))
    }

    /// As JSON: line and reason of each.
    pub(crate) fn json(&self) -> Value {
        let all = self
            .all()
            .map(|(line, why)| json!({ "line": line, "why": why }));
        all.collect()
    }

    /// Prints notes to stderr: the lines and the reasons; of many the first.
    pub(crate) fn report(&self, path: &Path) {
        let shown = path.display();
        let mut notes: Vec<String> = self
            .all()
            .take(SHOWN)
            .map(|(line, why)| format!("{shown}:{line} is skipped: {why}"))
            .collect();
        let (all, sound) = (self.all().count(), "all the rest is used");
        match all {
            0 => return,
            1..=SHOWN => notes.push(sound.to_owned()),
            _ => notes.push(format!(
                "skipped too: {} of {shown}, the last is line {}; {sound}",
                output::counted(all - SHOWN, "more line"),
                self.all().last().map_or(0, |(line, _)| line)
            )),
        }
        for note in notes {
            output::note(&note);
        }
    }
}
