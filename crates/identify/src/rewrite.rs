//! Identified parameters in the `[plant]` table of a robot file; nothing else of it changes.
//!
//! A comment above each table that holds identified values says which they are, from which runs and when; the one of an
//! earlier identification is replaced.

use crate::fit::Identification;
use crate::report::significant;
use rumbo_plant::rewrite::{RewriteError, RobotText};
use std::collections::BTreeMap;

/// How the comment of an identification starts.
const MARK: &str = "# Identified by `rumbo identify`";

/// The robot file `text` with the identified parameters in it. `date` is written as given.
///
/// # Errors
/// A text that is no TOML, or in which `plant` or a section of it is no table.
pub fn rewrite(
    text: &str,
    identification: &Identification,
    date: &str,
) -> Result<String, RewriteError> {
    let mut file = RobotText::parse(text)?;
    let mut written: BTreeMap<String, Vec<&str>> = BTreeMap::new();
    for parameter in &identification.parameters {
        let value = significant(parameter.value);
        let value: f64 = value.parse().unwrap_or(parameter.value);
        for key in &parameter.keys {
            let (table, name) = match key.rsplit_once('.') {
                Some((section, name)) => (format!("plant.{section}"), name),
                None => ("plant".to_owned(), key.as_str()),
            };
            file.set(&table, name, value)?;
            written.entry(table).or_default().push(name);
        }
    }
    let runs: Vec<&str> = identification
        .runs
        .iter()
        .map(|run| run.name.as_str())
        .collect();
    for (table, names) in written {
        let note = format!("on {date} from {}: {}.", runs.join(", "), names.join(", "));
        file.annotate(&table, MARK, &note)?;
    }
    Ok(file.to_string())
}
