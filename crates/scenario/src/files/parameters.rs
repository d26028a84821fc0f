//! Control parameters by name, as files and `--param` give them: the table is `control`'s.

use super::near;
use super::read::{Allowed, Table};
use std::collections::BTreeMap;

/// One row of the control core's table of parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entry {
    /// Its number on the link.
    pub id: u8,
    /// Its name in files and commands.
    pub name: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Smallest allowed value.
    pub min: f64,
    /// Largest allowed value.
    pub max: f64,
    /// Value without any override.
    pub default: f64,
    /// What it does, in one line.
    pub help: &'static str,
}

impl Entry {
    /// What is allowed, for complaints.
    pub(crate) fn allowed(&self) -> Allowed {
        Allowed::new(self.min, self.max, self.unit)
    }
}

/// The whole table, in the order of numbers.
pub fn all() -> Vec<Entry> {
    Vec::new()
}

/// A parameter by name.
///
/// # Errors
/// What to write instead.
pub fn find(name: &str) -> Result<Entry, String> {
    let entries = all();
    entries
        .iter()
        .find(|entry| entry.name == name)
        .copied()
        .ok_or_else(|| {
            let known: Vec<&str> = entries.iter().map(|entry| entry.name).collect();
            format!(
                "unknown parameter; {}",
                near::remedy_for_key(name, None, &known)
            )
        })
}

/// Reads a `[parameters]` table: names and values.
pub(crate) fn read_parameters(table: &Table<'_, '_>) -> BTreeMap<String, f32> {
    let mut values = BTreeMap::new();
    for entry in all() {
        if let Some(value) = table.number(entry.name, entry.allowed()) {
            values.insert(entry.name.to_owned(), value as f32);
        }
    }
    table.finish();
    values
}
