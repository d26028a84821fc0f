//! The files that describe robots, worlds and experiments.

pub mod robot;
pub mod scenario;
pub mod world;

pub use robot::{FirmwareCaps, Mount, Rig, RobotFile, Wiring};
pub use scenario::{Bounds, ScenarioFile, Spread, Start, TimedCommand};
pub use world::{Arena, BoxShape, WallSegment, WorldFile};
