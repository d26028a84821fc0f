//! Runs that another program recorded, from a log that `rumbo import` made of its table or bag.
//!
//! What a row says holds until the next one. How its speeds were measured nobody knows: they count as means over the
//! time since the row before, and over 50 ms at least.

use crate::error::IdentifyError;
use crate::log::{DriveLog, RobotProgram, Seen, WINDOW_MS};
use crate::row::{LONGEST_MS, LogRow, Window};
use rumbo_log::Log;
use std::path::Path;

const PWM: [&str; 2] = ["left_pwm", "right_pwm"];
const SPEEDS: [&str; 2] = ["left_rad_s", "right_rad_s"];
const REFERENCES: [&str; 2] = ["left_ref_rad_s", "right_ref_rad_s"];
const AHEAD: &str = "range_front_m";

/// What of an identification's needs no row has, in the names of `rumbo import`; nothing where it has all.
#[must_use]
pub fn lacks(rows: &[rumbo_log::Row]) -> Vec<&'static str> {
    let has = |name: &str| rows.iter().any(|row| row.signal(name).is_some());
    let mut missing: Vec<&str> = PWM.into_iter().filter(|name| !has(name)).collect();
    if !has(AHEAD) {
        let speeds = [(SPEEDS[0], "left_rpm"), (SPEEDS[1], "right_rpm")];
        missing.extend(
            speeds
                .into_iter()
                .filter(|(name, _)| !has(name))
                .map(|(_, column)| column),
        );
    }
    missing
}

/// The run in such a log.
///
/// # Errors
/// One without the PWM of both wheels, or without their speeds and a distance ahead; one that is too long.
pub(crate) fn foreign(path: &Path, log: &Log) -> Result<DriveLog, IdentifyError> {
    let missing = lacks(&log.rows);
    if !missing.is_empty() {
        let cause = format!(
            "has no {}: an identification needs what drove both wheels and how they turned; import it again, as with \
             --columns auto,{}=COLUMN",
            missing.join(", "),
            missing.join("=COLUMN,")
        );
        return Err(IdentifyError::read(path, cause));
    }
    let has = |names: [&str; 2]| {
        names
            .iter()
            .all(|name| log.rows.iter().any(|row| row.signal(name).is_some()))
    };
    let seen = if has(SPEEDS) {
        Seen::Speeds
    } else {
        Seen::FrontRange
    };
    let first_ms = log.rows.first().map_or(0, |row| row.t_ms);
    let mut before_ms = None;
    let mut rows = Vec::new();
    for row in &log.rows {
        let Ok(at_ms) = usize::try_from(row.t_ms - first_ms) else {
            continue;
        };
        if at_ms > LONGEST_MS {
            return Err(IdentifyError::too_long(path));
        }
        let pair = |names: [&str; 2]| Some([row.signal(names[0])?, row.signal(names[1])?]);
        let range_m = row.signal(AHEAD).filter(|range_m| range_m.is_finite());
        let shown = match seen {
            Seen::Speeds => pair(SPEEDS).map(|speeds| (speeds, 0.0)),
            _ => range_m.map(|range_m| ([0.0; 2], range_m)),
        };
        let (Some(pwm), Some((speed_rad_s, range_m))) = (pair(PWM), shown) else {
            continue;
        };
        let gap_ms = before_ms.map_or(WINDOW_MS, |before_ms| at_ms - before_ms);
        before_ms = Some(at_ms);
        let duty = pwm.map(|pwm| (pwm / 255.0).clamp(-1.0, 1.0));
        rows.push(LogRow {
            at_ms,
            duty,
            reference_rad_s: pair(REFERENCES).unwrap_or(duty),
            speed_rad_s,
            range_m: [range_m; 2],
            window: [Window {
                end_ms: at_ms,
                length_ms: gap_ms.max(WINDOW_MS),
            }; 2],
            ..LogRow::default()
        });
    }
    if rows.iter().filter(|row| row.duty != [0.0; 2]).count() < 2 {
        let cause = "the wheels are never driven: PWM is zero throughout";
        return Err(IdentifyError::read(path, cause));
    }
    Ok(DriveLog::new(path, RobotProgram::Another, seen, rows))
}
