//! A scenario file: an experiment, as robot + rig + world + mode + timed commands + limits on its metrics.
//!
//! ```toml
//! title = "Stop at a distance from a wall"
//! group = "Mode 1"       # in lists of scenarios; may be missing
//! robot = "memoria"      # a built-in name, or the path of a file beside this one
//! rig = "front_single"   # may be missing where the robot has one or none
//! world = "wall_front"
//! mode = "front_distance"    # may be missing for a sketch or an image of one's own
//! duration_s = 9
//! [start]
//! x_m = 0
//! [[command]]            # one action each; see `commands.rs` for all of them
//! at_s = 0.5
//! reference_m = 0.3
//! [[wire_fault]]         # none in most scenarios
//! [[sonar_fault]]        # none in most scenarios
//! at_s = 2.0
//! sonar = "front"        # or "left", "right"
//! kind = "stuck"         # or "cut", or "spiking" with share = 0.3
//! [limits]
//! "step1.settling_s" = { max = 2.4 }
//! [[fleet]]              # several robots: see `fleet.rs`
//! name = "north"
//! ```

mod fleet;
mod read;

pub(crate) use read::read_bounds;

use super::commands::TimedCommand;
use super::read::Table;
use super::typed::TimedText;
use super::value::{ANGLE, PLACE};
use rumbo_control::mode::ModeId;
use rumbo_control::params::ParamId;
use rumbo_sim::sonar_fault::TimedSonarFault;
use rumbo_sim::wire_fault::TimedWireFault;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// An experiment, as `scenarios/*.toml` describes it.
#[derive(Clone, Debug, PartialEq)]
pub struct ScenarioFile {
    /// Its name in commands: the file's name without `.toml`.
    pub name: String,
    /// The path of its file, as given; `None` for a built-in one.
    pub path: Option<String>,
    /// One line for people.
    pub title: String,
    /// Its heading in lists of scenarios.
    pub group: Option<String>,
    /// The text it was read from, kept for the log's manifest.
    pub text: String,
    /// Name of the robot, or path of its file.
    pub robot: String,
    /// Name of one of the robot's rigs; empty where the file has none: then the robot's only one.
    pub rig: String,
    /// Name of the world, or path of its file.
    pub world: String,
    /// Name of the policy of mode 9, or path of its file.
    pub policy: Option<String>,
    /// The mode selected before the first command; 0 where the file has none.
    pub mode: ModeId,
    /// Whether the file has a mode. One without is for a program of one's own.
    pub has_mode: bool,
    /// How long it lasts, in s.
    pub duration_s: f64,
    /// Where the robot starts.
    pub start: StartPose,
    /// The wheels turn freely: no floor, the body does not move.
    pub wheels_in_air: bool,
    /// A calibration of this seed's robot comes first; its parameters are sent before the first command.
    pub calibrated: bool,
    /// What the station sends, in order of time, ramps already resolved into single commands.
    pub commands: Vec<TimedCommand>,
    /// The lines that are typed besides, in order of time.
    pub texts: Vec<TimedText>,
    /// Sonars that fail on the way.
    pub sonar_faults: Vec<TimedSonarFault>,
    /// Wires that fail on the way.
    pub wire_faults: Vec<TimedWireFault>,
    /// Limits on the metrics for the run to pass.
    pub limits: BTreeMap<String, MetricBounds>,
    /// Control parameters sent before the first command, from `[parameters]`; they win over the robot file's, and later
    /// ones over earlier ones.
    pub parameters: Vec<(ParamId, f32)>,
    /// Whether each seed draws its own robot.
    pub spread: SeedSpread,
    /// Plant values that hold in every run, set after the draw, from `[plant]`; dotted keys of `Params`.
    pub plant: BTreeMap<String, f64>,
    /// The robots in its world, if there are several: then the values above are those that an entry of `[[fleet]]` does
    /// not give itself.
    pub fleet: Vec<Member>,
}

/// The program that drives the robot natively, as part of the simulator.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum NativeProgram {
    /// Ours, behind its link.
    #[default]
    Rumbo,
    /// The report's, rewritten from its description (docs/theory/baseline.md).
    Baseline,
}

/// A robot of a scenario with several.
#[derive(Clone, Debug, PartialEq)]
pub struct Member {
    /// The scenario as this robot has it, by the robot's name.
    pub scenario: ScenarioFile,
    /// The native program that drives it.
    pub program: NativeProgram,
    /// An image on an emulated chip that replaces it, by its path beside the scenario.
    pub firmware: Option<PathBuf>,
    /// The wiring of the image; `None`: chosen by its language and the mode.
    pub wiring: Option<String>,
}

/// The pose at the start, in the world frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StartPose {
    /// Middle of the wheels' axis, in m.
    pub x_m: f64,
    /// Middle of the wheels' axis, in m.
    pub y_m: f64,
    /// Counter-clockwise from x, in rad.
    pub heading_rad: f64,
}

/// Limits on a metric; a missing end is unlimited.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MetricBounds {
    /// Smallest value that passes.
    pub min: Option<f64>,
    /// Largest value that passes.
    pub max: Option<f64>,
}

impl MetricBounds {
    /// Whether a value passes. NaN never does.
    pub fn admit(&self, value: f64) -> bool {
        !value.is_nan()
            && self.min.is_none_or(|min| value >= min)
            && self.max.is_none_or(|max| value <= max)
    }
}

impl std::fmt::Display for MetricBounds {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match (self.min, self.max) {
            (Some(min), Some(max)) => write!(f, "{min} to {max}"),
            (Some(min), None) => write!(f, "at least {min}"),
            (None, Some(max)) => write!(f, "at most {max}"),
            (None, None) => write!(f, "none"),
        }
    }
}

/// Whether each seed draws its own robot about the robot file's values.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SeedSpread {
    /// Each seed draws radii, base, friction, battery, sensors.
    #[default]
    Drawn,
    /// Every seed drives the robot of the file; only the noise differs.
    None,
}

pub(super) fn read_start(table: &Table<'_, '_>) -> StartPose {
    let start = StartPose {
        x_m: table.number("x_m", PLACE).unwrap_or(0.0),
        y_m: table.number("y_m", PLACE).unwrap_or(0.0),
        heading_rad: table
            .number("heading_deg", ANGLE)
            .unwrap_or(0.0)
            .to_radians(),
    };
    table.finish();
    start
}
