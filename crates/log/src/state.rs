//! What changes slowly, for pages and logs: the state of the session, its link and its robot.

use crate::scene::RoutePlan;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// What changes slowly.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Session time \[s\].
    pub t_s: f64,
    /// A simulation: its speed can be set and it can be reset.
    pub simulated: bool,
    /// Requested seconds of the target per second of the wall clock.
    pub speed: f64,
    /// Seconds of the target per second of the wall clock, measured.
    pub achieved_speed: f64,
    /// The link.
    pub link: LinkState,
    /// The robot.
    pub robot: RobotState,
    /// Why the last order was refused or given up, if it was.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub refused: Option<String>,
    /// What needs the operator's attention at once.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub alarms: Vec<String>,
    /// The calibration that runs, or ran last in this run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub calibration: Option<CalibrationState>,
    /// The program of an emulated robot.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub program: Option<ProgramState>,
    /// STOP or OFF cut the supply of the motors of a simulated robot, whose program may ignore them.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub motors_cut: bool,
    /// The scenario that commands the robot, or has done so in this run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub experiment: Option<ExperimentState>,
    /// A log is being shown, of this length; `t_s` is where.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub replay: Option<ReplayState>,
}

/// A scenario that commands the robot.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ExperimentState {
    /// How far it is.
    pub phase: ExperimentPhase,
    /// How long it takes \[s\].
    pub duration_s: f64,
    /// Its limits.
    pub limits: Vec<LimitState>,
    /// Why it has not passed, a line each.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub failures: Vec<String>,
    /// The parameters that are not the scenario's.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub parameters: Vec<(String, f64)>,
}

/// How far an experiment is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ExperimentPhase {
    /// It goes on.
    #[default]
    Running,
    /// Its time is over, and no limit was missed.
    Passed,
    /// Its time is over.
    Failed,
    /// A person ended it.
    Stopped,
}

/// A limit of an experiment.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LimitState {
    /// The metric, its unit at the end.
    pub name: String,
    /// Smallest value that passes.
    pub min: Option<f64>,
    /// Largest value that passes.
    pub max: Option<f64>,
    /// The metric, once the experiment is over; `None`: what it measures did not happen.
    pub value: Option<f64>,
    /// It was kept.
    pub kept: bool,
}

/// The program of an emulated robot, for the page.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ProgramState {
    /// Name of its sketch or image.
    pub name: String,
    /// The USART that the Bluetooth module is on, if the wiring has one.
    pub link_usart: Option<u8>,
    /// What it does.
    pub phase: ProgramPhase,
    /// It starts again when its file is saved.
    #[serde(default)]
    pub watched: bool,
    /// What else is at its pins.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub parts: Vec<PartState>,
    /// What the compiler rejects; then the robot stands still.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub complaints: Vec<Complaint>,
    /// Where its time goes, while that is measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub profile: Option<ProgramProfile>,
    /// It is in the hands of the page's debugger.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub held: Option<HeldState>,
}

/// A program in the hands of a debugger.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct HeldState {
    /// It stands, and the robot's time with it.
    pub stands: bool,
    /// Where in its time it is \[us\].
    pub t_us: u64,
    /// How far it has gone back \[us\].
    pub back_us: u64,
}

/// Something at a pin that a person works or looks at.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PartState {
    /// Its name in the robot file.
    pub name: String,
    /// `button`, `switch`, `potentiometer`, `led`, `buzzer`, `infrared`; on the two-wire bus `mpu6050`, `vl53l0x`,
    /// `qmc5883l`, `hmc5883l`, `ssd1306`, `hd44780`.
    pub kind: String,
    /// How far it is pressed, closed or turned up \[%\].
    pub percent: u8,
    /// Its address on the two-wire bus, if it is there.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub address: Option<u8>,
    /// The keys of its remote control.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub keys: Vec<String>,
}

/// Where the time of a program goes; all times in cycles of its clock.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ProgramProfile {
    /// All that were counted.
    pub cycles: u64,
    /// Of them asleep.
    pub asleep: u64,
    /// Cycles in a second.
    pub hertz: u32,
    /// The costliest functions, those first that cost most with all that they call.
    pub functions: Vec<FunctionShare>,
    /// The interrupts that were served, by vector.
    pub interrupts: Vec<InterruptShare>,
}

/// What a function costs.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct FunctionShare {
    /// Its name.
    pub name: String,
    /// How often it was called.
    pub calls: u64,
    /// Cycles in itself.
    pub own: u64,
    /// Cycles with all that it calls.
    pub total: u64,
}

/// What an interrupt costs.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct InterruptShare {
    /// Its vector.
    pub vector: u8,
    /// The vector's name in the datasheet.
    pub name: String,
    /// How often it was served.
    pub count: u64,
    /// Cycles of all of them, from the entry to the end of RETI.
    pub total: u64,
    /// Cycles of one, on average.
    pub mean: u64,
    /// Cycles of the longest.
    pub longest: u64,
    /// Most cycles from its request to its first instruction.
    pub worst_latency: u64,
}

/// What a program does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ProgramPhase {
    /// It runs.
    #[default]
    Running,
    /// It runs while its changed source is compiled.
    Compiling,
    /// Its changed source does not compile: the chip is switched off.
    Rejected,
}

/// An error of the compiler.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Complaint {
    /// File, line and column, as far as the compiler names them: `wall.ino:12:3`.
    pub place: Option<String>,
    /// What is wrong.
    pub text: String,
    /// The line itself.
    pub line: Option<String>,
}

/// A log being shown, for the page.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ReplayState {
    /// Its name.
    pub name: String,
    /// Its length \[s\].
    pub duration_s: f64,
}

/// The link, for the page.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LinkState {
    /// The robot answers.
    pub connected: bool,
    /// Telemetry frames a second.
    pub telemetry_hz: f64,
    /// Share of the link's capacity from the robot, 0..=1.
    pub down_load: f64,
    /// Share of the link's capacity to the robot, 0..=1.
    pub up_load: f64,
    /// Its speed \[baud\].
    pub baud: u32,
    /// From a command to its acknowledgement, smoothed \[ms\].
    pub round_trip_ms: Option<u64>,
    /// Frames from the robot that failed the CRC.
    pub crc_errors_down: u16,
    /// Frames to the robot that failed the CRC.
    pub crc_errors_up: u8,
    /// Frames from the robot missing by their sequence numbers.
    pub frames_lost: u16,
    /// Telemetry the robot dropped because the link was full.
    pub dropped: u8,
    /// The operator's commands not acknowledged yet.
    pub unacknowledged: usize,
    /// Session time at the robot's time 0, where the clocks did not start together.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clock_offset_ms: Option<i64>,
    /// By how much the robot's clock is fast, in millionths.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clock_fast_ppm: Option<i64>,
}

/// The robot's slow signals, for the page.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RobotState {
    /// Number of the active mode.
    pub mode: u8,
    /// ON.
    pub armed: bool,
    /// The latched fault and what to do about it.
    pub fault: Option<Cow<'static, str>>,
    /// Battery as measured \[V\].
    pub battery_v: Option<f64>,
    /// True battery voltage of a simulated robot \[V\].
    pub true_battery_v: Option<f64>,
    /// The mode's setpoints.
    pub reference: [f32; 2],
    /// Ticks that took too long.
    pub overruns: u8,
    /// The servo's angle \[rad\].
    pub servo_rad: f32,
    /// Name of the rig set in the robot; `None` until it is reported.
    pub rig: Option<Cow<'static, str>>,
    /// Its task.
    pub task: TaskState,
    /// The robot has another parameter table, or another protocol: its parameters are neither shown nor written.
    pub foreign: bool,
    /// The robot speaks the original's text.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub text: bool,
}

/// Outcome of a task.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum End {
    /// The goal is reached.
    Reached,
    /// There is no path to the goal.
    Unreachable,
    /// The time for a way to the goal is over.
    GaveUp,
}

/// The robot's task: goal, lane or route, and its outcome. Positions are relative to the robot's origin.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TaskState {
    /// The goal of mode 8 \[m\]; `None` once it is reached, since the origin may have moved there.
    pub goal: Option<[f32; 2]>,
    /// Mode 8 follows a lane.
    pub lane: bool,
    /// The route of mode 7.
    pub route: Option<RoutePlan>,
    /// Pose of the robot at the start of a relative route: x, y \[m\] and heading \[rad\].
    pub from: Option<[f32; 3]>,
    /// Its outcome; `None` while it lasts.
    pub end: Option<End>,
}

/// What a calibration found.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Findings {
    /// The quantities.
    pub rows: Vec<Finding>,
    /// The parameters set, by number.
    pub parameters: Vec<(u8, f32)>,
    /// The same before.
    #[serde(default)]
    pub before: Vec<(u8, f32)>,
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

/// A calibration of a session, for the page.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CalibrationState {
    /// Counts those asked for in the session, from 1: the page tells a new one from the last one that ended the same way.
    #[serde(default)]
    pub number: u32,
    /// How far it is.
    #[serde(flatten)]
    pub phase: CalibrationPhase,
}

/// How far a calibration is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "phase", rename_all = "snake_case")]
pub enum CalibrationPhase {
    /// It goes on.
    Running {
        /// Since then, in session time \[s\].
        since_s: f64,
    },
    /// It has set the parameters.
    Done {
        /// What it found.
        findings: Findings,
    },
    /// It was given up.
    Failed {
        /// Why.
        why: String,
    },
}
