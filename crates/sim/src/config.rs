//! What a simulation is made from, in plain values.

use crate::floor::DarkLine;
use crate::light::Light;
use crate::mega::firmware::Firmware;
use crate::sonar_fault::TimedSonarFault;
use crate::wire_fault::TimedWireFault;
use crate::wiring::Divider;
use rumbo_control::mode::ModeId;
use rumbo_control::params::ParamId;
use rumbo_plant::contact::Pose;
use rumbo_plant::params::Params;
use rumbo_plant::plant::Mounts;
use rumbo_plant::world::World;
use std::sync::Arc;

/// A robot, its world, the program at its pins, and what fails on the way.
#[derive(Clone, Debug, PartialEq)]
pub struct Config {
    /// The robot's physics, as drawn for the seed.
    pub plant: Params,
    /// Where its sonars sit.
    pub rig: Mounts,
    /// The world that it drives in.
    pub world: World,
    /// The dark lines on its floor.
    pub lines: Arc<[DarkLine]>,
    /// Where magnetic north is, counter-clockwise from the world's x axis \[rad\].
    pub north_rad: f64,
    /// Its lamps, and the light of the room.
    pub light: Arc<Light>,
    /// Start pose in the world.
    pub start: Pose,
    /// The wheels turn freely: no floor, the body stays where it is.
    pub wheels_in_air: bool,
    /// The program at the pins.
    pub program: Program,
    /// What its EEPROM holds already; the rest is erased.
    pub memory: Vec<u8>,
    /// Sonars that fail on the way.
    pub sonar_faults: Vec<TimedSonarFault>,
    /// Wires that fail on the way.
    pub wire_faults: Vec<TimedWireFault>,
    /// The key of all noise.
    pub seed: u64,
    /// The same robot on another day has other noise, slip and floor.
    pub day: u32,
}

/// The program at the robot's pins.
#[derive(Clone, Debug, PartialEq)]
pub enum Program {
    /// Ours, native.
    Rumbo {
        /// Set at the start, over what the EEPROM holds; later ones win.
        parameters: Vec<(ParamId, f32)>,
        /// The battery's divider, where one is wired.
        divider: Option<Divider>,
        /// The network of mode 9 beside it, in bytes ([`rumbo_control::policy`]); empty without one.
        network: Arc<[u8]>,
    },
    /// The report's, native (docs/theory/baseline.md).
    Baseline {
        /// It has a program for each mode.
        mode: ModeId,
        /// Name of the rig, by which it has variants.
        rig: String,
    },
    /// An image on an emulated Mega.
    Image(Arc<Firmware>),
}
