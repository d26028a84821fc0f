//! What changes slowly, for pages and logs: the state of the session, its link and its robot.

use crate::errand::Errand;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// What changes slowly.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    pub(crate) t_s: f64,
    /// A simulation: its speed can be set and it can be reset.
    pub(crate) simulated: bool,
    /// Seconds of the target asked for per second of the wall clock.
    pub(crate) speed: f64,
    /// Seconds of the target per second of the wall clock, measured.
    pub(crate) achieved_speed: f64,
    pub(crate) link: LinkState,
    pub(crate) robot: RobotState,
    /// The last order, if it was refused or given up, and why.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) refused: Option<String>,
    /// What a person has to see to at once.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) alarms: Vec<String>,
    /// The calibration that runs, or ran last in this run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) calibration: Option<CalibrationState>,
    /// A log is being shown, of this length; `t_s` is where.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) replay: Option<ReplayState>,
}

/// A log being shown, for the page.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct ReplayState {
    pub(crate) name: String,
    pub(crate) duration_s: f64,
}

/// The link, for the page.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct LinkState {
    pub(crate) connected: bool,
    pub(crate) telemetry_hz: f64,
    /// Share of the link's capacity from the robot, 0..=1.
    pub(crate) down_load: f64,
    /// Share of the link's capacity to the robot, 0..=1.
    pub(crate) up_load: f64,
    pub(crate) baud: u32,
    pub(crate) round_trip_ms: Option<u64>,
    /// Frames from the robot that failed the CRC.
    pub(crate) crc_errors_down: u16,
    /// Frames to the robot that failed the CRC.
    pub(crate) crc_errors_up: u8,
    pub(crate) frames_lost: u16,
    /// Telemetry the robot dropped because the link was full.
    pub(crate) dropped: u8,
    /// The operator's commands not acknowledged yet.
    pub(crate) unacknowledged: usize,
    /// Session time at the robot's time 0, where the clocks did not start together.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) clock_offset_ms: Option<i64>,
    /// By how much the robot's clock is fast, in millionths.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) clock_fast_ppm: Option<i64>,
}

/// The robot's slow signals, for the page.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct RobotState {
    pub(crate) mode: u8,
    pub(crate) armed: bool,
    /// The latched fault and what to do about it.
    pub(crate) fault: Option<Cow<'static, str>>,
    pub(crate) battery_v: Option<f64>,
    pub(crate) true_battery_v: Option<f64>,
    pub(crate) reference: [f32; 2],
    pub(crate) overruns: u8,
    pub(crate) servo_rad: f32,
    /// Name of the rig that the robot believes to carry; `None` until it has said so.
    pub(crate) rig: Option<Cow<'static, str>>,
    pub(crate) errand: Errand,
    /// The robot has another parameter table, or another protocol: its parameters are neither shown nor written.
    pub(crate) foreign: bool,
    /// The robot speaks the original's text.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub(crate) text: bool,
}

/// What a calibration found.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Findings {
    /// The quantities.
    pub rows: Vec<Finding>,
    /// The parameters set, by number.
    pub parameters: Vec<(u8, f32)>,
}

/// A quantity that was found.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Finding {
    /// What it is, with its unit.
    pub name: String,
    /// Its value.
    pub found: f64,
    /// Standard deviation of its error.
    pub standard_error: Option<f64>,
}

/// How a calibration stands, for the page.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "phase", rename_all = "snake_case")]
pub(crate) enum CalibrationState {
    Running {
        since_s: f64,
    },
    Done {
        findings: Findings,
        /// When, by the session's time: one that ended at once was never seen running.
        #[serde(default)]
        at_s: f64,
    },
    Failed {
        why: String,
        #[serde(default)]
        at_s: f64,
    },
}
