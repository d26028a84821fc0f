//! Logs of our own program, cut into stretches in which the duty is known throughout.
//!
//! A telemetry frame each 40 ms has the duty applied at its tick, and the wheel speeds at its tick and 20 ms before. A
//! speed is that of the last motor turn, up to the last edge: the window of a row. How it is joined with that of the newest
//! edges ([`rumbo_control::speed`]) is in `shown.rs`. The duty changes somewhere within the 40 ms before a frame, at one of four ticks, and takes effect 3 ms later: 12 ms
//! before the frame on average.
//!
//! A stretch ends where frames are lost, where the robot's clock jumps (it was switched off and on), where the mode
//! changes, and a second after the wheels were released: what then turns them is a person. Ground truth, which logs of
//! simulated robots have too, is not looked at.

use crate::error::IdentifyError;
use crate::log::{DriveLog, RobotProgram, Seen, name_of};
use crate::row::{LogRow, Window};
use crate::shown::{EDGE_RAD, MOTOR_TURN_RAD};
use rumbo_log::Log;
use std::path::Path;

/// An event with this text says that the wheels turn freely from then on.
pub const IN_THE_AIR: &str = "identification: the wheels are in the air";
/// An event with this text says that they are on the floor again.
pub const ON_THE_FLOOR: &str = "identification: the wheels are on the floor";
/// How an event begins that has the voltage of the idle battery, as a person measured it.
pub const BATTERY: &str = "identification: battery, V: ";

/// From a change of the duty to the frame that shows it, on average.
const SHOWN_AFTER_MS: i64 = 12;
/// Frames further apart than this have lost others in between: what was applied there is not known.
const LONGEST_GAP_MS: i64 = 100;
/// A released wheel of ours has come to rest by then.
const ROLLING_MS: i64 = 1_000;
/// Shorter stretches show nothing.
const SHORTEST_MS: usize = 1_000;
/// Time before the first frame of a stretch, for the windows of its speeds.
const LEAD_MS: i64 = 200;
/// A wheel that has turned by less since it stood has no whole motor turn of edges yet, rad: it turned less fast before a
/// frame than at it.
const TELLING_RAD: f64 = 2.0 * MOTOR_TURN_RAD;
/// So many frames before a wheel stands it sticks sooner or later than a model says.
const STOPPING_ROWS: usize = 2;
/// Time over which a standing wheel is known to stand.
const STANDING_MS: f64 = 40.0;
/// Shortest and longest window: a tick, and what a wheel takes that is about to stop.
const WINDOW_MS: (f64, f64) = (10.0, 120.0);
/// Standard deviation of a voltage by the robot's divider, and by a multimeter, V.
const DIVIDER_SD_V: f64 = 0.1;
const MULTIMETER_SD_V: f64 = 0.03;

/// What a log has for identification.
#[derive(Clone, Debug, Default)]
pub struct Stretches {
    /// Its stretches.
    pub logs: Vec<DriveLog>,
    /// What is missing in it, a line each.
    pub notes: Vec<String>,
}

/// One telemetry frame.
struct Frame {
    t_ms: i64,
    mode: f64,
    armed: bool,
    duty: [f64; 2],
    speed_rad_s: [f64; 2],
    reference_rad_s: [f64; 2],
}

/// Cuts a log of our program into stretches.
///
/// # Errors
/// A log of the original's text, or one in which the wheels were never driven.
pub fn stretches(path: &Path, log: &Log) -> Result<Stretches, IdentifyError> {
    if log.speaks_text() {
        let cause = "the robot spoke the original's text, whose rows have no time of their own; give its CSV";
        return Err(IdentifyError::read(path, cause));
    }
    let mut found = Stretches::default();
    if let Some(cut) = &log.cut {
        found.notes.push(format!("{}: {cut}", path.display()));
    }
    let frames = frames(path, log, &mut found.notes);
    let (mut stretch, mut released_ms): (Vec<Frame>, Option<i64>) = (Vec::new(), None);
    let changes = surface_changes(log);
    let surface = |t_ms: i64| {
        let before = changes.iter().rev().find(|(at_ms, _)| *at_ms <= t_ms);
        before.map_or(!starts_in_the_air(log), |(_, on_floor)| *on_floor)
    };
    for frame in frames {
        released_ms = match (frame.armed, released_ms) {
            (true, _) => None,
            (false, since) => since.or(Some(frame.t_ms)),
        };
        let resting = released_ms.is_some_and(|since_ms| frame.t_ms > since_ms + ROLLING_MS);
        let continues = stretch.last().is_some_and(|last| {
            let gap_ms = frame.t_ms - last.t_ms;
            (1..=LONGEST_GAP_MS).contains(&gap_ms)
                && last.mode == frame.mode
                && surface(last.t_ms) == surface(frame.t_ms)
        });
        if resting || !continues {
            found.close(path, log, &mut stretch, &surface);
        }
        if !resting && (frame.armed || !stretch.is_empty()) {
            stretch.push(frame);
        }
    }
    found.close(path, log, &mut stretch, &surface);
    if found.logs.is_empty() {
        let cause = "the wheels are never driven for a second without a gap; record a run with ON";
        return Err(IdentifyError::read(path, cause));
    }
    Ok(found)
}

impl Stretches {
    fn close(
        &mut self,
        path: &Path,
        log: &Log,
        frames: &mut Vec<Frame>,
        surface: &dyn Fn(i64) -> bool,
    ) {
        let frames = std::mem::take(frames);
        let Some(first) = frames.first() else {
            return;
        };
        let from_ms = first.t_ms - LEAD_MS;
        let mut rows: Vec<LogRow> = frames.iter().map(|frame| frame.row(from_ms)).collect();
        mark_edgeless(&mut rows);
        let on_floor = surface(first.t_ms);
        let (name, from_s) = (name_of(path), first.t_ms as f64 / 1e3);
        let surface = if on_floor { "" } else { ", in the air" };
        let stretch = DriveLog {
            name: format!("{name}, from {from_s:.1} s{surface}"),
            on_floor,
            battery_v: battery_v(log),
            ..DriveLog::new(path, RobotProgram::Rumbo, Seen::Speeds, rows)
        };
        let drives = stretch.rows.iter().any(|row| row.duty != [0.0; 2]);
        if drives && stretch.duration_ms() >= SHORTEST_MS {
            self.logs.push(stretch);
        }
    }
}

impl Frame {
    fn row(&self, from_ms: i64) -> LogRow {
        let at_ms = self.t_ms - from_ms;
        LogRow {
            at_ms: usize::try_from(at_ms - SHOWN_AFTER_MS).unwrap_or(0),
            duty: self.duty,
            reference_rad_s: self.reference_rad_s,
            speed_rad_s: self.speed_rad_s,
            window: self.speed_rad_s.map(|speed_rad_s| {
                let (half_edge_ms, length_ms) = match speed_rad_s.abs() {
                    0.0 => (0.0, STANDING_MS),
                    speed => (0.5e3 * EDGE_RAD / speed, 1e3 * MOTOR_TURN_RAD / speed),
                };
                let end_ms = at_ms as f64 - half_edge_ms.min(0.5 * STANDING_MS);
                Window {
                    end_ms: end_ms.round() as usize,
                    length_ms: length_ms.clamp(WINDOW_MS.0, WINDOW_MS.1).round() as usize,
                }
            }),
            ..LogRow::default()
        }
    }
}

/// Marks where a wheel has too few edges for a speed: it has not turned far enough since it stood, it is about to stand, or
/// has just come to.
fn mark_edgeless(rows: &mut [LogRow]) {
    for wheel in [0, 1] {
        let stands: Vec<bool> = rows
            .iter()
            .map(|row| row.speed_rad_s[wheel] == 0.0)
            .collect();
        let (mut turned_rad, mut before_ms) = (0.0, rows.first().map_or(0, |row| row.at_ms));
        for (index, row) in rows.iter_mut().enumerate() {
            let passed_ms = row.at_ms - std::mem::replace(&mut before_ms, row.at_ms);
            turned_rad += row.speed_rad_s[wheel].abs() * passed_ms as f64 / 1e3;
            row.edgeless[wheel] = if stands[index] {
                turned_rad = 0.0;
                index == 0 || !stands[index - 1]
            } else {
                let soon = &stands[index..stands.len().min(index + 1 + STOPPING_ROWS)];
                turned_rad < TELLING_RAD || soon.contains(&true)
            };
        }
    }
}

/// The frames with all that is needed; the others are counted and named.
fn frames(path: &Path, log: &Log, notes: &mut Vec<String>) -> Vec<Frame> {
    let mut damaged = Vec::new();
    let mut frames = Vec::new();
    for row in &log.rows {
        match frame(row) {
            Some(frame) => frames.push(frame),
            None => damaged.push(row.t_ms as f64 / 1e3),
        }
    }
    if let Some(first) = damaged.first() {
        let count = damaged.len();
        notes.push(format!(
            "{}: frames without PWM and speeds, left out: {count}, the first at {first:.2} s",
            path.display()
        ));
    }
    frames
}

fn frame(row: &rumbo_log::Row) -> Option<Frame> {
    let signal = |name: &str| row.signal(name).filter(|value| value.is_finite());
    let pair = |left: &str, right: &str| Some([signal(left)?, signal(right)?]);
    Some(Frame {
        t_ms: row.t_ms,
        mode: signal("mode")?,
        armed: signal("armed")? != 0.0,
        duty: pair("left_pwm", "right_pwm")?.map(|pwm| (pwm / 255.0).clamp(-1.0, 1.0)),
        speed_rad_s: pair("left_rad_s", "right_rad_s")?,
        reference_rad_s: pair("left_ref_rad_s", "right_ref_rad_s")?,
    })
}

/// When the robot was lifted and put down, as the log's events say: time, on the floor.
fn surface_changes(log: &Log) -> Vec<(i64, bool)> {
    let events = log.events.iter().filter_map(|event| {
        let on_floor = match event.text.as_str() {
            IN_THE_AIR => false,
            ON_THE_FLOOR => true,
            _ => return None,
        };
        Some(((event.t_s * 1e3) as i64, on_floor))
    });
    events.collect()
}

/// Whether the scenario of a simulated run has the wheels in the air.
fn starts_in_the_air(log: &Log) -> bool {
    let manifest = log.manifest.as_ref();
    let scenario = manifest.and_then(|manifest| manifest.files.get("scenario"));
    scenario.is_some_and(|text| {
        let key = |line: &str| {
            line.split_once('=').map(|(key, value)| {
                (
                    key.trim() == "wheels_in_air",
                    value.trim().starts_with("true"),
                )
            })
        };
        text.lines().any(|line| key(line) == Some((true, true)))
    })
}

/// The idle battery's voltage with its standard deviation: a person's measurement, else the divider's.
fn battery_v(log: &Log) -> Option<(f64, f64)> {
    let said = log.events.iter().rev().find_map(|event| {
        let volts: f64 = event.text.strip_prefix(BATTERY)?.parse().ok()?;
        Some((volts, MULTIMETER_SD_V))
    });
    said.or_else(|| {
        let idle = log.states.iter().filter(|state| !state.robot.armed);
        let mut volts: Vec<f64> = idle.filter_map(|state| state.robot.battery_v).collect();
        volts.sort_by(f64::total_cmp);
        Some((*volts.get(volts.len() / 2)?, DIVIDER_SD_V))
    })
}
