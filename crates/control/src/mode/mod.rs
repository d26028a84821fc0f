//! The modes: what the robot does, one file each.
//!
//! A mode is configuration (from the parameters and its setpoint) apart from state, and one function from the
//! [`Estimate`] to an [`Action`]: [`Mode::step`]. Beside it is its [`Description`]: number, name, states, reference,
//! rigs, parameters. The list of modes in `active.rs` generates [`ModeId`] and [`ActiveMode`], which dispatches.

mod description;

pub mod front_align;
pub mod front_distance;
pub mod manual;
pub mod mission;
pub mod policy;
pub mod straight_line;
pub mod twist;
pub mod wall_follow;
pub mod wall_hold;
pub mod waypoints;
pub mod wheel_speed;

mod active;
mod commands;
mod movement;
mod reference;

pub use active::{ActiveMode, ModeId};
pub use description::{
    Description, Law, MetricGroup, ModePlot, ParamGroup, StateDescription, Takes, Transition,
};
pub use movement::{Movement, MovementLevel};
pub use reference::{Reference, ReferenceDescription, ReferenceKind};

use crate::estimate::Estimate;
use crate::math::is_finite;
use crate::params::Params;
use crate::range::{MIN_RANGE_M, REACH_M};
use crate::types::{Drive, Fault, Look};

/// Fastest wheel reference that is accepted, either way [rad/s]: 191 rpm.
pub const MAX_WHEEL_RAD_S: f32 = 20.0;
/// Shortest distance reference that is accepted [m].
pub const MIN_DISTANCE_M: f32 = MIN_RANGE_M + 0.03;
/// Longest distance reference that is accepted [m]: the sonar must still see the wall beyond it.
pub const MAX_DISTANCE_M: f32 = REACH_M - 0.5;

/// Shortest distance to a wall beside the robot that is accepted [m], from the sonar.
pub const MIN_WALL_M: f32 = 0.10;
/// Longest distance to a wall beside the robot that is accepted [m].
pub const MAX_WALL_M: f32 = 1.5;
/// Distance to a wall beside the robot before the first command [m], as in the report.
pub const DEFAULT_WALL_M: f32 = 0.50;

/// Request of a mode.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Action {
    /// Of the wheels.
    pub drive: Drive,
    /// Of the sonars and the servo.
    pub look: Look,
    /// Number of its state, for telemetry; names: [`Description::states`].
    pub state: u8,
    /// Its heading setpoint, for telemetry [rad]; 0 where it has none.
    pub heading_ref_rad: f32,
    /// It has reached its reference.
    pub reached: bool,
    /// It has stopped trying to reach its goal.
    pub unreachable: bool,
    /// It did so because its time was over, not because every way was tried.
    pub out_of_time: bool,
    /// The present pose becomes the origin.
    pub new_origin: bool,
}

/// What a mode's own loops are made of at a tick: for people to see.
#[cfg(not(target_arch = "avr"))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ModeTerms {
    /// Of the loops beside a wall.
    Wall(WallTerms),
    /// The velocity that is asked for, before the wheels' limit.
    Velocity(crate::types::Velocity),
    /// The outputs of the network as shares, -1..=1: left and right wheel, servo.
    Network([f32; crate::policy::OUTPUTS]),
}

/// What the loops of the distance and the heading beside a wall add up, each before its limit.
#[cfg(not(target_arch = "avr"))]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WallTerms {
    /// Of the distance error, to the heading's setpoint [rad].
    pub distance_p_rad: f32,
    /// Of the past distance errors, to the heading's setpoint [rad].
    pub distance_i_rad: f32,
    /// Of the heading error, to the yaw rate [rad/s].
    pub heading_p_rad_s: f32,
    /// Of the present yaw rate, to the yaw rate [rad/s].
    pub heading_d_rad_s: f32,
}

/// A mode: configuration apart from state.
pub trait Mode<'a>: Sized {
    /// The setpoint.
    type Setpoint: Copy;
    /// Its state from tick to tick; the default is its start.
    type State: Default;

    /// Where it needs to look, armed or not.
    const LOOK: Look = Look::AHEAD;

    /// The setpoint before the first command.
    fn first() -> Self::Setpoint;

    /// From the parameters and the setpoint.
    fn new(params: &'a Params, setpoint: &'a Self::Setpoint) -> Self;

    /// Whether the sensors it needs give good readings.
    fn is_ready(&self, _estimate: &Estimate) -> bool {
        true
    }

    /// The wheels have just been armed.
    fn start(state: &mut Self::State) {
        *state = Self::State::default();
    }

    /// The reference in force.
    fn reference(_setpoint: &Self::Setpoint, _state: &Self::State) -> Reference {
        Reference::None
    }

    /// Sets the reference, where it is one number.
    ///
    /// # Errors
    /// Why it is refused; the last one stays.
    fn set_reference(_setpoint: &mut Self::Setpoint, _value: f32) -> Result<(), SetpointError> {
        Err(SetpointError::NotInThisMode)
    }

    /// One tick.
    ///
    /// # Errors
    /// Why it must stop; the supervisor then releases the wheels.
    fn step(&self, state: &mut Self::State, estimate: &Estimate) -> Result<Action, Fault>;

    /// What its own loops are made of by this estimate, after its tick; `None` where it has none.
    #[cfg(not(target_arch = "avr"))]
    fn terms(&self, _state: &Self::State, _estimate: &Estimate) -> Option<ModeTerms> {
        None
    }
}

/// Why a reference is refused; the last valid one stays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SetpointError {
    /// Not a finite number.
    NotFinite,
    /// Outside what the mode allows.
    OutOfRange,
    /// The mode has no such reference.
    NotInThisMode,
}

/// Whether a value is finite and in range.
fn within(value: f32, min: f32, max: f32) -> Result<(), SetpointError> {
    if !is_finite(value) {
        Err(SetpointError::NotFinite)
    } else if value < min || value > max {
        Err(SetpointError::OutOfRange)
    } else {
        Ok(())
    }
}
