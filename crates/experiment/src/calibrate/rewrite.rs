//! The parameters found, in the `[parameters]` table of a robot file; nothing else of it changes.

use super::Calibration;
use crate::files::parameters::exact;
use rumbo_plant::rewrite::{RewriteError, RobotText};

/// How the comment of a calibration starts.
const MARK: &str = "# Calibrated by `rumbo calibrate`";
const TABLE: &str = "parameters";

/// Whether the parameters of a robot file are those of a calibration.
pub fn is_calibrated(text: &str) -> bool {
    text.lines().any(|line| line.starts_with(MARK))
}

/// The text with the calibration's parameters in its table `[parameters]`, made if absent. `date` is written as given.
///
/// # Errors
/// A text that is no TOML, or in which `parameters` is no table.
pub fn rewrite(text: &str, calibration: &Calibration, date: &str) -> Result<String, RewriteError> {
    let mut file = RobotText::parse(text)?;
    for (id, value) in calibration.parameters() {
        file.set(TABLE, id.name(), exact(value))?;
    }
    let note = format!("on {date}, {:.1} m along a wall.", calibration.way_m);
    file.annotate(TABLE, MARK, &note)?;
    Ok(file.to_string())
}
