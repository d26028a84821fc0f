//! Mode 10: a forward speed and a yaw rate from outside, such as those of ROS 2 or a joystick.
//!
//! The sender repeats its velocity while it wants the robot to move; the newest one counts. Half a second without
//! one the wheels are released: a sender that is gone drives nothing. ON begins without a velocity.
//!
//! Both wheels follow their speed loops ([`crate::drive`]), ramps included. Where a wheel would have to turn faster than
//! [`MAX_WHEEL_RAD_S`], both are slowed by the same factor: the arc stays.

use super::description::{FEEDFORWARD, SPEED, SPEED_LOOPS, WHEEL_RAMPS, states};
use super::{
    Action, Description, Law, MAX_WHEEL_RAD_S, Mode, ModePlot, SetpointError, Takes, within,
};
use crate::estimate::Estimate;
use crate::math::abs;
use crate::odometry::Geometry;
use crate::params::Params;
use crate::rig::Rigs;
use crate::types::{Drive, Fault, Velocity, Wheels};

/// Description of mode 10.
pub const DESCRIPTION: Description = Description {
    number: 10,
    name: "twist",
    about: "a forward speed and a yaw rate from outside",
    states: STATES,
    idle: None,
    reference: None,
    heading: false,
    takes: Some(Takes::Velocity),
    rigs: Rigs::ANY,
    parameters: &[WHEEL_RAMPS, SPEED_LOOPS, FEEDFORWARD],
    laws: &[LAWS, SPEED],
    plots: &[ModePlot::Wheels, ModePlot::Heading, ModePlot::Pwm],
    metrics: &[],
};

/// [`Twist::wheels`].
const LAWS: &[Law] = &[
    Law::new(
        "left_asked_rad_s",
        "(forward_ref_m_s - yaw_ref_rad_s * base_m / 2) / radius_left_m",
    ),
    Law::new(
        "right_asked_rad_s",
        "(forward_ref_m_s + yaw_ref_rad_s * base_m / 2) / radius_right_m",
    ),
    Law::new(
        "slower",
        "min(1, 20 / max(abs(left_asked_rad_s), abs(right_asked_rad_s)))",
    ),
    Law::new("left_ref_rad_s", "left_asked_rad_s * slower"),
    Law::new("right_ref_rad_s", "right_asked_rad_s * slower"),
];

/// Largest forward speed that is accepted, either way [m/s].
pub const MAX_FORWARD_M_S: f32 = 1.0;
/// Largest yaw rate that is accepted, either way [rad/s].
pub const MAX_YAW_RAD_S: f32 = 10.0;
/// Ticks for which a velocity is driven: 0.5 s.
const LIFE_TICKS: u8 = 50;

states! {
    /// States of mode 10.
    enum Phase {
        /// Wheels released: no velocity came during the last half second.
        #[default]
        Waiting = "waiting" { Driving: "a velocity comes" }
        /// Drives at the newest velocity.
        Driving = "driving" { Waiting: "none for half a second" }
    }
}

/// State of mode 10.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    /// For so many ticks the velocity is still driven.
    ticks_left: u8,
}

/// Whether a velocity is accepted.
///
/// # Errors
/// It is not finite or out of range.
pub fn check(velocity: Velocity) -> Result<(), SetpointError> {
    within(velocity.forward_m_s, -MAX_FORWARD_M_S, MAX_FORWARD_M_S)?;
    within(velocity.yaw_rad_s, -MAX_YAW_RAD_S, MAX_YAW_RAD_S)
}

/// Sets the velocity that counts from now on.
pub(super) fn set(
    velocity: &mut Velocity,
    state: &mut State,
    value: Velocity,
) -> Result<(), SetpointError> {
    check(value)?;
    *velocity = value;
    state.ticks_left = LIFE_TICKS;
    Ok(())
}

/// Configuration of mode 10.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Twist<'a> {
    /// The newest velocity.
    pub velocity: &'a Velocity,
    /// Of the robot.
    pub geometry: &'a Geometry,
}

impl Twist<'_> {
    /// Wheel speeds for the velocity [rad/s], in their ratio, none above what the wheels may turn.
    fn wheels(&self) -> Wheels<f32> {
        let Velocity {
            forward_m_s,
            yaw_rad_s,
        } = *self.velocity;
        let wheels = self.geometry.wheels_from_body(forward_m_s, yaw_rad_s);
        let fastest = abs(wheels.left).max(abs(wheels.right));
        if fastest <= MAX_WHEEL_RAD_S {
            return wheels;
        }
        let factor = MAX_WHEEL_RAD_S / fastest;
        wheels.map(|wheel| wheel * factor)
    }
}

impl<'a> Mode<'a> for Twist<'a> {
    type Setpoint = Velocity;
    type State = State;

    fn first() -> Velocity {
        Velocity::default()
    }

    fn new(params: &'a Params, velocity: &'a Velocity) -> Self {
        Self {
            velocity,
            geometry: params.geometry(),
        }
    }

    fn step(&self, state: &mut State, _: &Estimate) -> Result<Action, Fault> {
        let (drive, phase) = match state.ticks_left.checked_sub(1) {
            Some(left) => {
                state.ticks_left = left;
                (Drive::WheelSpeed(self.wheels()), Phase::Driving)
            }
            None => (Drive::Release, Phase::Waiting),
        };
        Ok(Action {
            drive,
            state: phase as u8,
            ..Action::default()
        })
    }

    #[cfg(not(target_arch = "avr"))]
    fn terms(&self, _: &State, _: &Estimate) -> Option<super::ModeTerms> {
        Some(super::ModeTerms::Velocity(*self.velocity))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mode::{ActiveMode, ModeId};

    fn velocity(forward_m_s: f32, yaw_rad_s: f32) -> Velocity {
        Velocity {
            forward_m_s,
            yaw_rad_s,
        }
    }

    fn step(mode: &mut ActiveMode) -> Drive {
        let action = mode.step(&Params::default(), &Estimate::default());
        action.unwrap().drive
    }

    fn driven(value: Velocity) -> Wheels<f32> {
        let mut mode = ActiveMode::new(ModeId::Twist);
        mode.set_velocity(value).unwrap();
        match step(&mut mode) {
            Drive::WheelSpeed(wheels) => wheels,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn a_velocity_is_driven_for_half_a_second_and_then_the_wheels_are_released() {
        let mut mode = ActiveMode::new(ModeId::Twist);
        assert_eq!(step(&mut mode), Drive::Release, "none has come yet");
        mode.set_velocity(velocity(0.2, 0.0)).unwrap();
        for tick in 0..50 {
            assert!(matches!(step(&mut mode), Drive::WheelSpeed(_)), "{tick}");
        }
        assert_eq!(step(&mut mode), Drive::Release);
        mode.set_velocity(velocity(0.1, 0.0)).unwrap();
        assert!(matches!(step(&mut mode), Drive::WheelSpeed(_)));
    }

    #[test]
    fn on_begins_without_the_velocity_from_before() {
        let mut mode = ActiveMode::new(ModeId::Twist);
        mode.set_velocity(velocity(0.2, 0.0)).unwrap();
        mode.start();
        assert_eq!(step(&mut mode), Drive::Release);
    }

    #[test]
    fn the_robot_turns_left_with_a_positive_yaw_rate() {
        let wheels = driven(velocity(0.0, 1.0));
        assert!(wheels.left < 0.0 && wheels.right > 0.0);
        let (forward_m_s, yaw_rad_s) =
            (Params::default().geometry()).body_from_wheels(driven(velocity(0.2, 0.5)));
        assert!((forward_m_s - 0.2).abs() < 1e-5 && (yaw_rad_s - 0.5).abs() < 1e-5);
    }

    #[test]
    fn where_a_wheel_would_turn_too_fast_the_arc_stays() {
        let wheels = driven(velocity(MAX_FORWARD_M_S, 2.0));
        assert!((wheels.right - MAX_WHEEL_RAD_S).abs() < 1e-4, "{wheels:?}");
        let (forward_m_s, yaw_rad_s) = Params::default().geometry().body_from_wheels(wheels);
        assert!((yaw_rad_s / forward_m_s - 2.0).abs() < 1e-4);
    }

    #[test]
    fn what_no_robot_drives_is_refused_and_the_last_velocity_stays() {
        let mut mode = ActiveMode::new(ModeId::Twist);
        mode.set_velocity(velocity(0.2, 0.0)).unwrap();
        let before = mode;
        for (wrong, why) in [
            (velocity(f32::NAN, 0.0), SetpointError::NotFinite),
            (velocity(0.0, f32::INFINITY), SetpointError::NotFinite),
            (velocity(1.01, 0.0), SetpointError::OutOfRange),
            (velocity(0.0, -10.1), SetpointError::OutOfRange),
        ] {
            assert_eq!(mode.set_velocity(wrong), Err(why));
            assert_eq!(mode, before);
        }
        let mut other = ActiveMode::new(ModeId::WheelSpeed);
        assert_eq!(
            other.set_velocity(velocity(0.1, 0.0)),
            Err(SetpointError::NotInThisMode)
        );
    }
}
