//! The files that describe robots, worlds and experiments.
//!
//! [`Library`] finds a file by name (built in) or path (on disk) and reads it; [`Library::setup`] puts a scenario
//! together with its robot, rig and world. Everything is checked while it is read: a wrong file yields one line per
//! problem, with file, line, key, value and what is allowed. Angles are degrees and speeds rpm in the files, radians
//! and rad/s in the result.

mod assemble;
pub mod bounded;
pub mod commands;
mod devices;
mod error;
mod faults;
pub mod firmware;
mod fit;
mod kept;
mod library;
mod light;
mod line;
mod maxsonar;
mod mover;
mod named;
mod names;
pub(crate) mod near;
mod new_answers;
mod new_asked;
mod new_parts;
mod new_plant;
pub mod new_robot;
mod new_sensors;
mod new_speed;
mod obstacle;
pub mod parameters;
mod parts;
mod pin;
pub(crate) mod policy;
pub(crate) mod read;
mod robot;
mod route;
mod scenario;
mod setup;
mod sonars;
mod start;
mod typed;
mod value;
mod word;
mod world;

pub use commands::TimedCommand;
pub(crate) use error::did_you_mean;
pub use error::{About, FileError, FileProblem};
pub(crate) use fit::takes;
pub(crate) use kept::Calibrated;
pub use kept::Calibrations;
pub use library::{Kind, Library};
pub use mover::Mover;
pub use names::{MOVEMENTS, find_mode, find_movement};
pub(crate) use near::near_or_all;
pub use near::unknown;
pub use policy::PolicyFile;
pub use robot::{FirmwareCaps, RobotFile};
pub(crate) use scenario::read_bounds;
pub use scenario::{Member, MetricBounds, NativeProgram, ScenarioFile, SeedSpread, StartPose};
pub use setup::{Overrides, Setup, goal_seen_from};
pub use start::fleet_around;
pub(crate) use typed::read_press;
pub use typed::{TimedText, TypedPort, check_line, placed, pressed};
pub use word::WordError;
pub use world::{Arena, WorldFile};
