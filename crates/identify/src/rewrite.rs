//! Writes identified parameters into the `[plant]` table of a robot file and touches nothing else.
//!
//! Comments stay, also those within the table. A comment above each table that holds identified values says which
//! they are, from which runs and when; the one of an earlier identification is replaced.

use crate::error::IdentifyError;
use crate::fit::Identification;
use crate::report::significant;
use toml_edit::{DocumentMut, Item, Table, Value};

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
) -> Result<String, IdentifyError> {
    let mut document: DocumentMut = text
        .parse()
        .map_err(|error| IdentifyError::RobotFile(format!("{error}")))?;
    let runs: Vec<&str> = identification
        .runs
        .iter()
        .map(|run| run.name.as_str())
        .collect();
    let mut written: Vec<(&str, Vec<&str>)> = Vec::new();
    for parameter in &identification.parameters {
        for key in &parameter.keys {
            let (section, name) = key.rsplit_once('.').unwrap_or(("", key));
            let value: f64 = significant(parameter.value)
                .parse()
                .unwrap_or(parameter.value);
            set(table(&mut document, section)?, name, value);
            match written.iter_mut().find(|(known, _)| *known == section) {
                Some((_, names)) => names.push(name),
                None => written.push((section, vec![name])),
            }
        }
    }
    for (section, names) in written {
        let note = format!(
            "{MARK} on {date} from {}: {}.\n",
            runs.join(", "),
            names.join(", ")
        );
        annotate(table(&mut document, section)?, &note);
    }
    Ok(document.to_string())
}

/// The table `[plant.<section>]`, made if absent.
fn table<'a>(document: &'a mut DocumentMut, section: &str) -> Result<&'a mut Table, IdentifyError> {
    let mut table = document.as_table_mut();
    for name in std::iter::once("plant").chain(section.split('.').filter(|name| !name.is_empty())) {
        let item = table.entry(name).or_insert_with(|| {
            let mut new = Table::new();
            new.set_implicit(true);
            Item::Table(new)
        });
        table = item.as_table_mut().ok_or_else(|| {
            IdentifyError::RobotFile(format!(
                "`{name}` of `plant.{section}` is no [table]; write it as one"
            ))
        })?;
    }
    Ok(table)
}

/// Sets a number and keeps what surrounds it.
fn set(table: &mut Table, name: &str, value: f64) {
    if let Some(Item::Value(old)) = table.get_mut(name) {
        let decor = old.decor().clone();
        *old = Value::from(value);
        *old.decor_mut() = decor;
    } else {
        table.insert(name, toml_edit::value(value));
    }
}

/// Puts the note above the table's header, in place of an earlier one.
fn annotate(table: &mut Table, note: &str) {
    let before = table
        .decor()
        .prefix()
        .and_then(|prefix| prefix.as_str())
        .unwrap_or("\n")
        .to_owned();
    let kept: String = before
        .split_inclusive('\n')
        .filter(|line| !line.starts_with(MARK))
        .collect();
    let kept = if kept.is_empty() || kept.ends_with('\n') {
        kept
    } else {
        format!("{kept}\n")
    };
    table.decor_mut().set_prefix(format!("{kept}{note}"));
}
