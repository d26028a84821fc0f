//! Mode 0: the basic movements (memoria 1), open loop by duty or closed loop by wheel speed.
//!
//! Each movement is a pair of factors for the two wheels: +1 forward, -1 backward, 0 standing, the arcs' inner wheel
//! at a ratio of the outer one. A pivot moves one wheel alone, so it also serves the tests of section 1: dead zone,
//! asymmetry and static curve of each wheel and direction, on the floor or in the air.
//!
//! The report moves open loop only; by speed the two wheels keep their ratio on any floor.

use super::description::{FEEDFORWARD, SPEED, SPEED_LOOPS, WHEEL_RAMPS, states};
use super::{
    Action, Description, MetricGroup, Mode, ModePlot, Movement, MovementLevel, ParamGroup, Takes,
};
use crate::estimate::Estimate;
use crate::params::{ParamId, Params};
use crate::rig::Rigs;
use crate::types::{Drive, Fault, Wheels};

/// Description of mode 0.
pub const DESCRIPTION: Description = Description {
    number: 0,
    name: "manual",
    about: "basic movements, open loop or by speed",
    states: STATES,
    idle: None,
    reference: None,
    heading: false,
    takes: Some(Takes::Movements),
    rigs: Rigs::ANY,
    parameters: &[
        ParamGroup::new("arcs", &[ParamId::ArcRatio]),
        SPEED_LOOPS,
        FEEDFORWARD,
        WHEEL_RAMPS,
    ],
    laws: &[SPEED],
    plots: &[ModePlot::Wheels, ModePlot::Pwm, ModePlot::Heading],
    metrics: &[
        MetricGroup::Movement,
        MetricGroup::DeadZones,
        MetricGroup::StaticCurve,
    ],
};

states! {
    /// States of mode 0.
    enum Phase {
        /// Wheels released: the movement is *stop*.
        #[default]
        Stop = "stop" { OpenLoop: "a movement by duty", BySpeed: "a movement by speed" }
        /// Drives by a duty.
        OpenLoop = "open loop" { Stop: "stop", BySpeed: "a movement by speed" }
        /// Drives by a wheel speed.
        BySpeed = "by speed" { Stop: "stop", OpenLoop: "a movement by duty" }
    }
}

/// The setpoint of mode 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setpoint {
    /// Which movement.
    pub movement: Movement,
    /// How fast the outer wheel turns.
    pub level: MovementLevel,
}

impl Default for Setpoint {
    fn default() -> Self {
        Self {
            movement: Movement::Stop,
            level: MovementLevel::Duty(0.0),
        }
    }
}

/// Configuration of mode 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Manual<'a> {
    /// What to do.
    pub setpoint: &'a Setpoint,
    /// Inner wheel's share in arcs, 0..=1.
    pub arc_ratio: f32,
}

impl Manual<'_> {
    /// Factors on the level for both wheels.
    fn factors(&self) -> Wheels<f32> {
        let inner = self.arc_ratio;
        let (left, right) = match self.setpoint.movement {
            Movement::Stop => (0.0, 0.0),
            Movement::Forward => (1.0, 1.0),
            Movement::Backward => (-1.0, -1.0),
            Movement::TurnLeft => (-1.0, 1.0),
            Movement::TurnRight => (1.0, -1.0),
            Movement::PivotLeftForward => (0.0, 1.0),
            Movement::PivotLeftBackward => (0.0, -1.0),
            Movement::PivotRightForward => (1.0, 0.0),
            Movement::PivotRightBackward => (-1.0, 0.0),
            Movement::ArcLeft => (inner, 1.0),
            Movement::ArcRight => (1.0, inner),
            Movement::ArcLeftBackward => (-inner, -1.0),
            Movement::ArcRightBackward => (-1.0, -inner),
        };
        Wheels { left, right }
    }
}

impl<'a> Mode<'a> for Manual<'a> {
    type Setpoint = Setpoint;
    type State = ();

    fn first() -> Setpoint {
        Setpoint::default()
    }

    fn new(params: &'a Params, setpoint: &'a Setpoint) -> Self {
        Self {
            setpoint,
            arc_ratio: params.get(ParamId::ArcRatio),
        }
    }

    fn step(&self, (): &mut (), _: &Estimate) -> Result<Action, Fault> {
        let factors = self.factors();
        let (drive, phase) = match (self.setpoint.movement, self.setpoint.level) {
            (Movement::Stop, _) => (Drive::Release, Phase::Stop),
            (_, MovementLevel::Duty(duty)) => (
                Drive::Duty(factors.map(|factor| factor * duty)),
                Phase::OpenLoop,
            ),
            (_, MovementLevel::Speed(rad_s)) => (
                Drive::WheelSpeed(factors.map(|factor| factor * rad_s)),
                Phase::BySpeed,
            ),
        };
        Ok(Action {
            drive,
            state: phase as u8,
            ..Action::default()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drive(movement: Movement, level: MovementLevel) -> Drive {
        Manual::new(&Params::default(), &Setpoint { movement, level })
            .step(&mut (), &Estimate::default())
            .unwrap()
            .drive
    }

    #[test]
    fn a_pivot_moves_one_wheel_alone() {
        let duty = |movement| drive(movement, MovementLevel::Duty(0.4));
        assert_eq!(
            duty(Movement::PivotLeftForward),
            Drive::Duty(Wheels {
                left: 0.0,
                right: 0.4
            })
        );
        assert_eq!(
            duty(Movement::PivotRightBackward),
            Drive::Duty(Wheels {
                left: -0.4,
                right: 0.0
            })
        );
    }

    #[test]
    fn an_arc_to_the_left_has_the_left_wheel_inside() {
        assert_eq!(
            drive(Movement::ArcLeft, MovementLevel::Speed(6.0)),
            Drive::WheelSpeed(Wheels {
                left: 3.0,
                right: 6.0
            })
        );
        assert_eq!(
            drive(Movement::ArcRight, MovementLevel::Speed(6.0)),
            Drive::WheelSpeed(Wheels {
                left: 6.0,
                right: 3.0
            })
        );
    }

    #[test]
    fn every_movement_backward_is_the_opposite_of_its_twin() {
        for (forward, backward) in [
            (Movement::Forward, Movement::Backward),
            (Movement::TurnLeft, Movement::TurnRight),
            (Movement::PivotLeftForward, Movement::PivotLeftBackward),
            (Movement::PivotRightForward, Movement::PivotRightBackward),
            (Movement::ArcLeft, Movement::ArcLeftBackward),
            (Movement::ArcRight, Movement::ArcRightBackward),
        ] {
            let (Drive::Duty(there), Drive::Duty(back)) = (
                drive(forward, MovementLevel::Duty(0.5)),
                drive(backward, MovementLevel::Duty(0.5)),
            ) else {
                panic!("open loop");
            };
            assert_eq!(there.map(|duty| duty + 0.0), back.map(|duty| 0.0 - duty));
        }
    }

    #[test]
    fn stop_releases_whatever_the_level() {
        assert_eq!(
            drive(Movement::Stop, MovementLevel::Duty(1.0)),
            Drive::Release
        );
        assert_eq!(
            drive(Movement::Stop, MovementLevel::Speed(5.0)),
            Drive::Release
        );
    }
}
