//! Commands to the running mode besides a single reference: a pair of them, goals, routes, movements; and refusals.

use super::mission::Task;
use super::waypoints::{self, Route, Waypoint};
use super::{
    ActiveMode, MAX_WHEEL_RAD_S, Movement, MovementLevel, SetpointError, manual, policy, twist,
    wheel_speed, within,
};
use crate::types::{Velocity, Wheels};

impl ActiveMode {
    /// Sets the reference of each wheel [rad/s] in mode 5.
    ///
    /// # Errors
    /// Why it is refused; the last one stays.
    pub fn set_wheel_reference(&mut self, value: Wheels<f32>) -> Result<(), SetpointError> {
        let Self::WheelSpeed(references, ()) = self else {
            return Err(SetpointError::NotInThisMode);
        };
        wheel_speed::set(references, value)
    }

    /// Sets the goal: the task of mode 8, that of mode 9, a route of one waypoint in mode 7. It may arrive at any time.
    ///
    /// # Errors
    /// Why it is refused; the last one stays.
    pub fn set_goal(&mut self, x_m: f32, y_m: f32) -> Result<(), SetpointError> {
        waypoints::REFERENCE.check(x_m)?;
        waypoints::REFERENCE.check(y_m)?;
        match self {
            Self::Mission(task, state) => {
                *task = Task::Goal { x_m, y_m };
                state.renew();
            }
            Self::Policy(goal, state) => {
                *goal = policy::Goal(Some((x_m, y_m)));
                state.renew();
            }
            Self::Waypoints(..) => {
                self.begin_route(false, false)?;
                self.add_waypoint(Waypoint {
                    x_m,
                    y_m,
                    heading_rad: None,
                })?;
            }
            _ => return Err(SetpointError::NotInThisMode),
        }
        Ok(())
    }

    /// Makes following a lane the task of mode 8.
    ///
    /// # Errors
    /// Another mode is selected.
    pub fn follow_lane(&mut self) -> Result<(), SetpointError> {
        let Self::Mission(task, state) = self else {
            return Err(SetpointError::NotInThisMode);
        };
        *task = Task::Lane;
        state.renew();
        Ok(())
    }

    /// Begins a new route of mode 7, without waypoints: the robot waits.
    ///
    /// # Errors
    /// Another mode is selected.
    pub fn begin_route(&mut self, repeat: bool, relative: bool) -> Result<(), SetpointError> {
        let Self::Waypoints(route, state) = self else {
            return Err(SetpointError::NotInThisMode);
        };
        *route = Route::empty(repeat, relative);
        *state = waypoints::State::default();
        Ok(())
    }

    /// Appends a waypoint to the route of mode 7.
    ///
    /// # Errors
    /// Why it is refused; the route is as before.
    pub fn add_waypoint(&mut self, waypoint: Waypoint) -> Result<(), SetpointError> {
        let Self::Waypoints(route, _) = self else {
            return Err(SetpointError::NotInThisMode);
        };
        route.push(waypoint)
    }

    /// Sets the velocity of mode 10, for half a second.
    ///
    /// # Errors
    /// Why it is refused; the last one stays.
    pub fn set_velocity(&mut self, value: Velocity) -> Result<(), SetpointError> {
        let Self::Twist(velocity, state) = self else {
            return Err(SetpointError::NotInThisMode);
        };
        twist::set(velocity, state, value)
    }

    /// Sets the movement of mode 0.
    ///
    /// # Errors
    /// Why it is refused; the last one stays.
    pub fn set_movement(
        &mut self,
        movement: Movement,
        level: MovementLevel,
    ) -> Result<(), SetpointError> {
        let Self::Manual(setpoint, ()) = self else {
            return Err(SetpointError::NotInThisMode);
        };
        match level {
            MovementLevel::Duty(duty) => within(duty, 0.0, 1.0)?,
            MovementLevel::Speed(rad_s) => within(rad_s, 0.0, MAX_WHEEL_RAD_S)?,
        }
        *setpoint = manual::Setpoint { movement, level };
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mode::waypoints::FARTHEST_M;
    use crate::mode::{ModeId, Reference};

    #[test]
    fn a_reference_out_of_range_is_refused_and_the_last_one_stays() {
        let mut mode = ActiveMode::new(ModeId::FrontDistance);
        assert_eq!(mode.set_reference(0.5), Ok(()));
        assert_eq!(mode.set_reference(-0.1), Err(SetpointError::OutOfRange));
        assert_eq!(mode.set_reference(2.2), Err(SetpointError::OutOfRange));
        assert_eq!(mode.set_reference(f32::NAN), Err(SetpointError::NotFinite));
        assert_eq!(mode.reference().numbers(), [0.5; 2]);
        assert_eq!(
            mode.set_wheel_reference(Wheels::both(1.0)),
            Err(SetpointError::NotInThisMode)
        );
    }

    #[test]
    fn half_a_valid_pair_of_references_is_refused_whole() {
        let mut mode = ActiveMode::new(ModeId::WheelSpeed);
        assert_eq!(
            mode.set_wheel_reference(Wheels {
                left: 3.0,
                right: 50.0
            }),
            Err(SetpointError::OutOfRange)
        );
        assert_eq!(mode.reference().numbers(), [0.0; 2]);
        assert_eq!(
            mode.set_movement(Movement::Forward, MovementLevel::Duty(0.5)),
            Err(SetpointError::NotInThisMode)
        );
    }

    #[test]
    fn every_mode_refuses_what_is_out_of_its_range_and_keeps_what_it_has() {
        let cases = [
            (ModeId::FrontDistance, 0.4, [-0.2, 2.1]),
            (ModeId::FrontAlign, 0.4, [0.01, 2.1]),
            (ModeId::WallFollow, 0.4, [0.09, 1.6]),
            (ModeId::WheelSpeed, 6.0, [-20.1, 20.1]),
            (ModeId::StraightLine, -6.0, [-20.1, 20.1]),
        ];
        for (id, good, bad) in cases {
            let mut mode = ActiveMode::new(id);
            assert_eq!(mode.set_reference(good), Ok(()), "{id:?}");
            for value in bad {
                let refused = Err(SetpointError::OutOfRange);
                assert_eq!(mode.set_reference(value), refused, "{id:?} {value}");
            }
            for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
                assert_eq!(
                    mode.set_reference(value),
                    Err(SetpointError::NotFinite),
                    "{id:?}"
                );
            }
            assert_eq!(mode.reference().numbers(), [good; 2], "{id:?}");
        }
    }

    #[test]
    fn modes_without_such_a_reference_refuse_it() {
        for id in [
            ModeId::Manual,
            ModeId::WallHold,
            ModeId::Waypoints,
            ModeId::Mission,
        ] {
            let refused = Err(SetpointError::NotInThisMode);
            assert_eq!(ActiveMode::new(id).set_reference(0.4), refused, "{id:?}");
        }
        let refused = Err(SetpointError::NotInThisMode);
        assert_eq!(
            ActiveMode::new(ModeId::WheelSpeed).set_goal(0.4, 0.0),
            refused
        );
    }

    #[test]
    fn a_goal_or_a_movement_out_of_range_is_refused_and_the_last_one_stays() {
        let mut mission = ActiveMode::new(ModeId::Mission);
        assert_eq!(mission.set_goal(1.0, -0.5), Ok(()));
        for (x_m, y_m) in [(FARTHEST_M + 0.1, 0.0), (0.0, -FARTHEST_M - 0.1)] {
            assert_eq!(mission.set_goal(x_m, y_m), Err(SetpointError::OutOfRange));
        }
        assert_eq!(
            mission.set_goal(0.0, f32::NAN),
            Err(SetpointError::NotFinite)
        );
        let goal = Reference::Goal {
            x_m: 1.0,
            y_m: -0.5,
        };
        assert_eq!(mission.reference(), goal);
        let mut manual = ActiveMode::new(ModeId::Manual);
        assert_eq!(
            manual.set_movement(Movement::Forward, MovementLevel::Duty(0.5)),
            Ok(())
        );
        let before = manual;
        for level in [
            MovementLevel::Duty(1.1),
            MovementLevel::Duty(-0.1),
            MovementLevel::Speed(20.1),
            MovementLevel::Speed(f32::NAN),
        ] {
            assert!(manual.set_movement(Movement::Backward, level).is_err());
        }
        assert_eq!(manual, before);
    }
}
