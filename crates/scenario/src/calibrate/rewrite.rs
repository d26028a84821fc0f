//! Writes the parameters found into the `[parameters]` table of a robot file and touches nothing else.

use super::Calibration;
use crate::files::parameters::exact;
use toml_edit::{DocumentMut, Item, Table, Value};

/// How the comment of a calibration starts.
const MARK: &str = "# Calibrated by `rumbo calibrate`";

/// Whether the parameters of a robot file are those of a calibration.
pub fn is_calibrated(text: &str) -> bool {
    text.lines().any(|line| line.starts_with(MARK))
}

/// The text with the calibration's parameters in its table `[parameters]`, made if absent; comments stay. `date` is written as given.
///
/// # Errors
/// A text that is no TOML, or in which `parameters` is no table.
pub fn rewrite(text: &str, calibration: &Calibration, date: &str) -> Result<String, String> {
    let mut document: DocumentMut = text.parse().map_err(|error| format!("{error}"))?;
    let table = document
        .as_table_mut()
        .entry("parameters")
        .or_insert_with(|| Item::Table(Table::new()))
        .as_table_mut()
        .ok_or("`parameters` is no [table]; write it as one")?;
    for (id, value) in calibration.parameters() {
        let value = exact(value);
        if let Some(Item::Value(old)) = table.get_mut(id.name()) {
            let decor = old.decor().clone();
            *old = Value::from(value);
            *old.decor_mut() = decor;
        } else {
            table.insert(id.name(), toml_edit::value(value));
        }
    }
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
    table.decor_mut().set_prefix(format!(
        "{kept}{MARK} on {date}, {:.1} m along a wall.\n",
        calibration.way_m
    ));
    Ok(document.to_string())
}
