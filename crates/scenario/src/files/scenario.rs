//! A scenario file: an experiment, as robot + rig + world + mode + timed commands + limits on its metrics.

use rumbo_control::mode::ModeId;
use rumbo_wire::message::Command;
use std::collections::BTreeMap;

/// An experiment, as `scenarios/*.toml` describes it.
#[derive(Clone, Debug, PartialEq)]
pub struct ScenarioFile {
    /// The name by which commands call it: the file's name without `.toml`.
    pub name: String,
    /// One line for people.
    pub title: String,
    /// The text it was read from, kept for the log's manifest.
    pub text: String,
    /// Name of the robot, or path of its file.
    pub robot: String,
    /// Name of one of the robot's rigs.
    pub rig: String,
    /// Name of the world, or path of its file.
    pub world: String,
    /// The mode selected before the first command.
    pub mode: ModeId,
    /// How long it lasts [s].
    pub duration_s: f64,
    /// Where the robot stands at first.
    pub start: Start,
    /// The wheels turn freely: no floor, the body stays where it is.
    pub wheels_in_air: bool,
    /// What the station sends, in order of time, ramps already resolved into single commands.
    pub commands: Vec<TimedCommand>,
    /// What each metric must keep to for the run to pass.
    pub limits: BTreeMap<String, Bounds>,
    /// Control parameters sent before the first command, from `[parameters]`; they win over the robot file's.
    pub parameters: BTreeMap<String, f32>,
    /// Whether each seed draws its own robot.
    pub spread: Spread,
    /// Plant values that hold in every run, set after the draw, from `[plant]`; dotted keys of `Params`.
    pub plant: BTreeMap<String, f64>,
}

/// The pose at the start, in the world frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Start {
    /// Middle of the wheels' axis [m].
    pub x_m: f64,
    /// Middle of the wheels' axis [m].
    pub y_m: f64,
    /// Counter-clockwise from x [rad].
    pub heading_rad: f64,
}

/// A command and when the station sends it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimedCommand {
    /// Time since the start [s].
    pub at_s: f64,
    /// What is sent, in the units of the link (m, rad/s, fraction of full PWM).
    pub command: Command,
}

/// What a metric must keep to; a missing end is free.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bounds {
    /// Smallest value that passes.
    pub min: Option<f64>,
    /// Largest value that passes.
    pub max: Option<f64>,
}

impl Bounds {
    /// Whether a value passes. What is not a number never does.
    pub fn admit(&self, value: f64) -> bool {
        !value.is_nan()
            && self.min.is_none_or(|min| value >= min)
            && self.max.is_none_or(|max| value <= max)
    }
}

/// Whether each seed draws its own robot about the robot file's values.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Spread {
    /// Each seed draws radii, base, friction, battery, sensors.
    #[default]
    Drawn,
    /// Every seed drives the robot of the file; only the noise differs.
    None,
}
