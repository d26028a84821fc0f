//! A robot file: what the robot is made of, where its sensors sit, and which control values it prefers.

use rumbo_plant::params::Params;
use std::collections::BTreeMap;

/// A robot, as `robots/*.toml` describes it.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotFile {
    /// The name by which scenarios and commands call it: the file's name without `.toml`.
    pub name: String,
    /// One line for people.
    pub title: String,
    /// The text it was read from, kept for the log's manifest.
    pub text: String,
    /// Physics, from `[plant.*]`: nominal values where the file says nothing.
    pub plant: Params,
    /// Where the sonars sit, by the name of the rig. At least one.
    pub rigs: BTreeMap<String, Rig>,
    /// Which signal is on which pin, by the name of the wiring.
    pub wirings: BTreeMap<String, Wiring>,
    /// Control parameters that differ from their defaults, from `[parameters]`; sent to the robot before arming.
    pub parameters: BTreeMap<String, f32>,
    /// What the firmware may take of the chip.
    pub firmware: FirmwareCaps,
}

/// Where the sonars sit. `None`: not fitted in this rig.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rig {
    /// `SonarId::Left`: the left one, or the first (foremost) of a pair on one side.
    pub left: Option<Mount>,
    /// `SonarId::Right`: the right one, or the second of a pair on one side.
    pub right: Option<Mount>,
    /// `SonarId::Front`.
    pub front: Option<Mount>,
}

/// The place of one sonar on the body. The origin is the middle of the wheels' axis, x forward, y left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mount {
    /// Ahead of the wheels' axis [m].
    pub x_m: f64,
    /// Left of the body's middle line [m].
    pub y_m: f64,
    /// Where it looks, counter-clockwise from straight ahead, with the servo (if it sits on it) at 0 [rad].
    pub angle_rad: f64,
    /// The servo turns it about its own place.
    pub on_servo: bool,
}

/// Signal names (`right_enable`, `front_echo`, ...) and the Mega's pin numbers.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Wiring {
    /// Pin of each signal.
    pub pins: BTreeMap<String, u8>,
}

/// Most that an image may take, from `[firmware]`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FirmwareCaps {
    /// Flash [bytes].
    pub flash_bytes: u32,
    /// Static SRAM [bytes].
    pub sram_bytes: u32,
}

impl Default for FirmwareCaps {
    fn default() -> Self {
        Self {
            flash_bytes: 48 * 1024,
            sram_bytes: 3 * 1024,
        }
    }
}
