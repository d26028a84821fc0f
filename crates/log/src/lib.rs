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
//! | `/truth` | `rumbo.Truth` | ground truth and pins of an emulated robot, 33 times a second |
//! | `/pose/others` | `rumbo.Others` | where the other robots in the world are, 33 times a second |
//! | `/printed` | `rumbo.Printed` | numbers that its program printed, by name |
//! | `/digest` | `rumbo.Digest` | the checksum of each metadata record |
//!
//! Messages are JSON with JSON schemas, times are the run's own, from 0. A metadata record `manifest` says what ran
//! ([`Manifest`]); the files it was made of are attached. A log whose writer was killed is readable up to the last
//! chunk that was closed ([`LogWriter::flush`]), and [`mend`] gives it the end that it lacks.
//!
//! Works on bytes: which file they are in, when they are flushed and who waits for the disk is the caller's business.

mod bound;
mod container;
mod digest;
mod entry;
mod error;
mod event;
mod foreign;
mod frames;
mod log;
mod manifest;
mod mend;
mod messages;
mod parameters;
mod reader;
mod reading;
mod recorded;
mod scene;
mod schema;
mod signals;
mod state;
mod summary;
mod viewers;
mod writer;

pub use bound::Bound;
pub use container::Container;
pub use entry::{Burst, Entry, Said};
pub use error::ReadError;
pub use event::{Level, LoggedEvent};
pub use foreign::{Foreign, read_foreign};
pub use log::{Log, Sent};
pub use manifest::{ANOTHER, LogKind, Manifest, Outcome};
pub use mcap::MAGIC;
pub use mend::mend;
pub use parameters::{Parameter, ParameterState, parameter, parameters};
pub use reading::{Names, Reading, ReadingSource};
pub use recorded::{CSV, recorded_csv};
pub use scene::{
    Choice, FloorLine, MapPose, Other, Repeat, RoutePlace, RoutePlan, ScenarioOffer, Scene,
    SceneLamp, SceneMover, SceneObstacle, SonarMount, TimedPose, Truth, compose,
};
pub use signals::{EARLIER_MS, Row, RowValue, SIGNALS, Sample, Signal, Spread};
pub use state::{
    CalibrationPhase, CalibrationState, Complaint, End, ExperimentPhase, ExperimentState, Finding,
    Findings, FunctionShare, HeldState, InterruptShare, LimitState, LinkState, PartState,
    ProgramPhase, ProgramProfile, ProgramState, ReplayState, RobotState, State, TaskState,
};
pub use summary::Summary;
pub use writer::LogWriter;
