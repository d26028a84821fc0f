//! What a client reports: events of the robot and the state of the link.

use crate::anomaly::Anomaly;
use crate::commands::CommandOutcome;
use rumbo_control::params;
use rumbo_wire::{EventKind, Hello, StatusReport, Telemetry};

/// An event of the link, in the session's time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LinkEvent {
    /// The robot answered for the first time, or after silence.
    Connected(Hello),
    /// The robot sends rows of the original's text, for the first time or after silence.
    Text,
    /// The robot speaks another version of the protocol, so nothing else of it can be decoded.
    OtherProtocol(Hello),
    /// The robot's program started again since it was last connected.
    Restarted(Hello),
    /// Nothing was received for a second.
    Lost,
    /// The fast signals, as of this time \[ms\].
    Telemetry(i64, Telemetry),
    /// The slow signals.
    Status(StatusReport),
    /// Something happened at this time \[ms\].
    Event(i64, EventKind),
    /// A command ended.
    Ended(CommandOutcome),
    /// STOP is not acknowledged, or the robot keeps reporting that it is armed.
    StopUnconfirmed,
    /// The robot does what no healthy robot does.
    Anomaly(Anomaly),
}

/// Why a command was not taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NotTaken {
    /// No robot is connected.
    NotConnected,
    /// The queue is full.
    QueueFull,
}

/// The parameter table the station knows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KnownTable {
    /// Its hash, compared with [`Hello::schema`].
    pub schema: u32,
    /// How many parameters it has, numbered from 0.
    pub len: u8,
}

impl KnownTable {
    /// The table this station is built with.
    pub const OURS: Self = Self {
        schema: params::SCHEMA,
        // Numbers of parameters are bytes on the link.
        len: params::COUNT as u8,
    };
}

/// Load and quality of the link.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LinkFigures {
    /// Bytes to the robot [1/s].
    pub up_bytes_s: f64,
    /// Bytes from the robot [1/s].
    pub down_bytes_s: f64,
    /// Telemetry frames from the robot [1/s].
    pub telemetry_hz: f64,
    /// Bytes from the robot since the port was opened.
    pub received_bytes: u64,
    /// Those of them that came after the last frame or row of text.
    pub unread_bytes: u64,
    /// Frames from the robot that failed the CRC, wrapping.
    pub crc_errors: u16,
    /// Frames from the robot missing by their sequence numbers, wrapping.
    pub frames_lost: u16,
    /// Frames that passed the CRC but cannot be decoded, wrapping.
    pub malformed: u32,
    /// Smoothed time from a command to its acknowledgement \[us\].
    pub round_trip_us: Option<u64>,
    /// The operator's commands not acknowledged yet.
    pub unacknowledged: usize,
    /// Session time at the robot's time 0, where the clocks did not start together \[ms\].
    pub clock_offset_ms: Option<i64>,
    /// By how much the robot's clock is fast, in millionths.
    pub clock_fast_ppm: Option<i64>,
}
