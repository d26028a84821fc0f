//! What an import leaves out of a damaged recording, and how it is told.

use crate::output;
use serde_json::{Value, json};
use std::path::Path;

/// So many lines are told one by one.
const TOLD: usize = 5;

/// Lines that are not taken, with their reasons.
#[derive(Debug, Default)]
pub(crate) struct LeftOut {
    header: Option<String>,
    rows: Vec<(usize, String)>,
}

impl LeftOut {
    /// The first line, which is not what it should be.
    pub(crate) fn header(&mut self, why: String) {
        self.header = Some(why);
    }

    /// A line, by its number.
    pub(crate) fn row(&mut self, line: usize, why: String) {
        self.rows.push((line, why));
    }

    /// Nothing is.
    pub(crate) fn is_empty(&self) -> bool {
        self.header.is_none() && self.rows.is_empty()
    }

    /// The first thing wrong, if no more lines are sound than are not: then it is no such recording at all.
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

    /// Notes on stderr: which lines, and why; of many the first.
    pub(crate) fn tell(&self, path: &Path) {
        let shown = path.display();
        let mut notes: Vec<String> = self
            .all()
            .take(TOLD)
            .map(|(line, why)| format!("{shown}:{line} is left out: {why}"))
            .collect();
        let (all, sound) = (self.all().count(), "all the rest is taken");
        match all {
            0 => return,
            1..=TOLD => notes.push(sound.to_owned()),
            _ => notes.push(format!(
                "{} more lines of {shown} are left out, the last is line {}; {sound}",
                all - TOLD,
                self.all().last().map_or(0, |(line, _)| line)
            )),
        }
        for note in notes {
            output::note(&note);
        }
    }
}
