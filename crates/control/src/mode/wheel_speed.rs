//! Mode 5: each wheel at a commanded speed, both directions, through zero (memoria 4.1).
//!
//! The mode passes its references to the wheel-speed loops of [`crate::drive`]; ramp, feedforward, PID and the passage
//! through zero are there, since all other modes use them too.
//!
//! The report's controller is an equilibrium PWM of 50 plus a PI on a speed counted in 50 ms, in steps of 3.1 rpm. Ours
//! has a feedforward of each wheel's friction, times the edges, and acts every 10 ms: docs/theory/drive.md,
//! docs/theory/wheel_speed.md. Worst of 20 simulated robots against the real one: 0 -> 60 rpm in 0.32 s instead of 3.7,
//! 0 -> -100 rpm in 0.44 s instead of 5.3 (`rumbo run mode5 --runs 20`).

use super::description::{FEEDFORWARD, SPEED, SPEED_LOOPS, WHEEL_RAMPS, states};
use super::{
    Action, Description, MAX_WHEEL_RAD_S, MetricGroup, Mode, ModePlot, Reference,
    ReferenceDescription, ReferenceKind, SetpointError,
};
use crate::estimate::Estimate;
use crate::params::Params;
use crate::rig::Rigs;
use crate::types::{Drive, Fault, Wheels};
use core::f32::consts::TAU;

/// Description of mode 5.
pub const DESCRIPTION: Description = Description {
    number: 5,
    name: "wheel_speed",
    about: "each wheel at a commanded speed",
    states: STATES,
    idle: None,
    reference: Some(REFERENCE),
    heading: false,
    takes: None,
    rigs: Rigs::ANY,
    parameters: &[SPEED_LOOPS, FEEDFORWARD, WHEEL_RAMPS],
    laws: &[SPEED],
    plots: &[ModePlot::Wheels, ModePlot::Pwm],
    metrics: &[MetricGroup::SpeedSteps],
};

/// Of each wheel; 60 rpm by default.
const REFERENCE: ReferenceDescription = ReferenceDescription::commanded(
    ReferenceKind::WheelSpeed,
    -MAX_WHEEL_RAD_S,
    MAX_WHEEL_RAD_S,
    TAU,
);

states! {
    /// States of mode 5.
    enum Phase {
        /// Wheels released: both setpoints are zero.
        #[default]
        Rest = "at rest" { Turning: "a setpoint that is not zero" }
        /// Regulates the speeds.
        Turning = "turning" { Rest: "both setpoints are zero" }
    }
}

/// Sets both references, or neither.
pub(super) fn set(references: &mut Wheels<f32>, value: Wheels<f32>) -> Result<(), SetpointError> {
    REFERENCE.check(value.left)?;
    REFERENCE.check(value.right)?;
    *references = value;
    Ok(())
}

/// Configuration of mode 5.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WheelSpeed<'a> {
    /// Speed references [rad/s].
    pub references: &'a Wheels<f32>,
}

impl<'a> Mode<'a> for WheelSpeed<'a> {
    /// [rad/s]
    type Setpoint = Wheels<f32>;
    type State = ();

    fn first() -> Wheels<f32> {
        Wheels::both(0.0)
    }

    fn new(_: &Params, references: &'a Wheels<f32>) -> Self {
        Self { references }
    }

    fn reference(references: &Wheels<f32>, (): &()) -> Reference {
        Reference::Wheels(*references)
    }

    fn set_reference(references: &mut Wheels<f32>, value: f32) -> Result<(), SetpointError> {
        set(references, Wheels::both(value))
    }

    fn step(&self, (): &mut (), _: &Estimate) -> Result<Action, Fault> {
        let (drive, phase) = if *self.references == Wheels::both(0.0) {
            (Drive::Release, Phase::Rest)
        } else {
            (Drive::WheelSpeed(*self.references), Phase::Turning)
        };
        Ok(Action {
            drive,
            state: phase as u8,
            ..Action::default()
        })
    }
}
