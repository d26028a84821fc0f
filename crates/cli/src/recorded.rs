//! Logs of real robots as the original program's CSV, which reports read.
//!
//! A log that `rumbo import` made of a CSV carries it. Any other one has the signals of its telemetry: what was recorded from the first
//! armed instant to the last becomes rows of the kind that the original program writes in that mode.

use crate::logs;
use rumbo_control::mode::{Description, ModeId, ReferenceKind, Takes};
use rumbo_experiment::files::bounded::{LONGEST_LOG, read_at_most};
use rumbo_log::{LogKind, Row, recorded_csv};
use rumbo_report::real::{FromLog, NotShown};
use rumbo_station::log_file;
use rumbo_wire::text::RowKind;
use std::f64::consts::PI;
use std::path::Path;

/// The value for a clear range \[cm\]: the sonars' maximum.
const CLEAR_CM: f64 = 250.0;

/// The run in a log, or why it is not one of a real robot.
pub(crate) fn from_log(path: &Path) -> Result<FromLog, NotShown> {
    logs::mend(path);
    let bytes = read_at_most(path, LONGEST_LOG).map_err(|_| NotShown::NoLog)?;
    if let Some(csv) = recorded_csv(&bytes) {
        let csv = String::from_utf8_lossy(&csv).into_owned();
        return Ok(FromLog { csv, ours: false });
    }
    let log = log_file::read_signals(path).map_err(|_| NotShown::NoLog)?;
    let manifest = log.manifest.as_ref().ok_or(NotShown::NoLog)?;
    if manifest.kind != LogKind::Robot {
        return Err(NotShown::Simulated);
    }
    let csv = csv(&log.rows).ok_or(NotShown::NoRun)?;
    let ours = manifest.program != "original";
    Ok(FromLog { csv, ours })
}

/// The rows of a run: armed, in the mode in which it was armed first. A robot that does not report it counts as armed.
fn csv(rows: &[Row]) -> Option<String> {
    let armed = |row: &&Row| row.signal("armed") != Some(0.0);
    let mode = |row: &Row| ModeId::from_number(row.signal("mode")? as u8);
    let first = rows.iter().find(armed)?;
    let mode_then = mode(first)?;
    let kind = kind(mode_then)?;
    let names: Vec<&str> = kind.columns().iter().map(|column| column.name).collect();
    let mut text = names.join(",") + "\n";
    let mut before = first.t_ms;
    let run = rows
        .iter()
        .filter(|row| armed(row) && mode(row) == Some(mode_then));
    for row in run {
        let cells = names.iter().map(|name| match *name {
            "dt_ms" => (row.t_ms - before).max(0).to_string(),
            name => format!("{:.4}", value(row, name, mode_then).unwrap_or(0.0)),
        });
        text += &cells.collect::<Vec<_>>().join(",");
        text.push('\n');
        before = row.t_ms;
    }
    Some(text)
}

fn kind(mode: ModeId) -> Option<RowKind> {
    let Description {
        reference, takes, ..
    } = mode.description();
    Some(match (reference.as_ref()?.kind, takes) {
        (ReferenceKind::Distance, _) => RowKind::Distance,
        (ReferenceKind::WheelSpeed | ReferenceKind::Speed, _) => RowKind::Speed,
        (ReferenceKind::Goal, Some(Takes::Lane)) => RowKind::Mission,
        (ReferenceKind::Goal, _) => RowKind::Waypoints,
    })
}

/// A column of the original program, in its unit. Motor A is the right one.
fn value(row: &Row, name: &str, mode: ModeId) -> Option<f64> {
    let rpm = |name| Some(row.signal(name)? * 30.0 / PI);
    let deg = |name| Some(row.signal(name)? * 180.0 / PI);
    let cm = |name| {
        let range_m = row.signal(name)?;
        Some(if range_m.is_finite() {
            100.0 * range_m
        } else {
            CLEAR_CM
        })
    };
    // A robot with one sonar sends it twice.
    let of_pair = |name| {
        cm(name)
            .filter(|_| mode != ModeId::FrontDistance)
            .or_else(|| cm("range_front_m"))
    };
    match name {
        "left_cm" if mode != ModeId::Mission => of_pair("range_left_m"),
        "right_cm" if mode != ModeId::Mission => of_pair("range_right_m"),
        "left_cm" => cm("range_left_m"),
        "right_cm" => cm("range_right_m"),
        "front_cm" => cm("range_front_m"),
        "reference_cm" => Some(100.0 * row.signal("reference_left")?),
        "reference_rpm" => rpm("reference_left"),
        "mode" => Some(f64::from(mode as u8)),
        "pwm_a" => row.signal("right_pwm"),
        "pwm_b" => row.signal("left_pwm"),
        "speed_a_rpm" => rpm("right_rad_s"),
        "speed_b_rpm" => rpm("left_rad_s"),
        "reference_a_rpm" => rpm("right_ref_rad_s"),
        "reference_b_rpm" => rpm("left_ref_rad_s"),
        "heading_deg" => deg("heading_rad"),
        "heading_reference_deg" => deg("heading_ref_rad"),
        "goal_x_m" => row.signal("reference_left"),
        "goal_y_m" => row.signal("reference_right"),
        _ => row.signal(name),
    }
}
