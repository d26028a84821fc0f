//! Logs: every run as an MCAP file, from which it can be shown, exported, compared and run again.
//!
//! | topic | schema | what |
//! |---|---|---|
//! | `/telemetry` | `rumbo.Telemetry` | the signals of the dashboard, one message per telemetry frame |
//! | `/state` | `rumbo.State` | what changes slowly: mode, faults, battery, figures of the link |
//! | `/parameters` | `rumbo.Parameters` | the values the robot acknowledged, or began the run with, by name |
//! | `/events` | `foxglove.Log` | what happened, in words |
//! | `/pose/estimated`, `/pose/true` | `foxglove.PoseInFrame` | the two poses in the world |
//! | `/world` | `foxglove.SceneUpdate` | walls and boxes |
//! | `/scene` | `rumbo.Scene` | what the dashboard draws around the robot |
//! | `/link/from_robot`, `/link/to_robot` | `rumbo.Bytes` | the raw bytes of the link, base64 |
//! | `/console` | `rumbo.Console` | what the USARTs of an emulated chip sent, and what a person typed to them, base64 |
//! | `/digest` | `rumbo.Digest` | the checksum of each metadata record |
//!
//! Messages are JSON with JSON schemas, times are the run's own, from 0. A metadata record `manifest` says what ran
//! ([`Manifest`]); the files it was made of are attached. Chunks are compressed and closed every
//! 0.4 s (`recorder::FLUSH`), so that a log whose writer was killed is readable up to there.

mod bound;
mod digest;
mod earlier;
mod intake;
mod manifest;
pub(crate) mod messages;
mod pieces;
mod reader;
pub(crate) mod recorder;
mod row_json;
pub(crate) mod schema;
mod summary;
mod writer;

pub use manifest::{Kind, Manifest, Outcome};
pub use reader::Log;
pub use recorder::Recording;
pub use summary::Summary;

use std::fmt;
use std::path::{Path, PathBuf};

/// Raw bytes that crossed the link together.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Burst {
    /// When, in the target's time \[us\].
    pub t_us: u64,
    /// To the robot, or from it.
    pub to_robot: bool,
    /// What.
    pub bytes: Vec<u8>,
}

/// Bytes of a USART of an emulated chip.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Said {
    /// When, in the target's time \[us\].
    pub t_us: u64,
    /// Which USART.
    pub usart: u8,
    /// Typed by a person, or sent by the chip.
    pub to_chip: bool,
    /// What.
    pub bytes: Vec<u8>,
}

/// What somebody sent to the robot.
#[derive(Clone, Copy, Debug)]
pub enum Sent<'a> {
    /// Bytes over the link.
    Link(&'a Burst),
    /// A line typed to a USART.
    Typed(&'a Said),
}

impl Sent<'_> {
    /// When, in the target's time \[us\].
    #[must_use]
    pub fn t_us(&self) -> u64 {
        match self {
            Self::Link(burst) => burst.t_us,
            Self::Typed(said) => said.t_us,
        }
    }
}

/// What is wrong with a log, or with writing one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LogError {
    path: PathBuf,
    what: String,
}

impl LogError {
    /// The same of another file: of the one that this was to become.
    #[must_use]
    pub fn of(&self, path: &Path) -> String {
        format!("{}: {}", path.display(), self.what)
    }

    pub(crate) fn new(path: &Path, what: impl fmt::Display) -> Self {
        Self {
            path: path.into(),
            what: what.to_string(),
        }
    }
}

impl fmt::Display for LogError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.path.display(), self.what)
    }
}

impl std::error::Error for LogError {}
