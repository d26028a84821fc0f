//! The one mode that runs: its setpoint, its state, and what it needs of the robot.

use super::front_align::{self, FrontAlign};
use super::front_distance::{self, FrontDistance};
use super::manual::{self, Manual};
use super::mission::{self, Mission, Task};
use super::straight_line::{self, StraightLine};
use super::wall_follow::{self, WallFollow};
use super::wall_hold::{self, WallHold};
use super::waypoints::{self, Route, Waypoints};
use super::wheel_speed::WheelSpeed;
use super::{Action, DEFAULT_WALL_M, Look, MAX_WALL_M, MIN_WALL_M, Mode, ModeId, Situation};
use crate::ahead::Ahead;
use crate::beside::Beside;
use crate::estimate::Estimate;
use crate::params::{ParamId, Params};
use crate::range::{MIN_RANGE_M, REACH_M};
use crate::rig::Rig;
use crate::types::{Fault, SonarId, Wheels};

/// The mode that runs, with its setpoint and its state.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(
    clippy::large_enum_variant,
    reason = "one mode is active at a time, in place; there is no heap to box the large one in"
)]
pub enum ActiveMode {
    /// Mode 0.
    Manual(manual::Setpoint),
    /// Mode 1: reference [m] and state.
    FrontDistance(f32, front_distance::State),
    /// Mode 2: reference [m] and state.
    FrontAlign(f32, front_align::State),
    /// Mode 3: state.
    WallHold(wall_hold::State),
    /// Mode 4: reference [m] and state.
    WallFollow(f32, wall_follow::State),
    /// Mode 5: references [rad/s].
    WheelSpeed(Wheels<f32>),
    /// Mode 6: reference of both wheels [rad/s] and state.
    StraightLine(f32, straight_line::State),
    /// Mode 7: route and state.
    Waypoints(Route, waypoints::State),
    /// Mode 8: task and state.
    Mission(Task, mission::State),
}

impl Default for ActiveMode {
    fn default() -> Self {
        Self::new(ModeId::default())
    }
}

impl ActiveMode {
    /// A mode at its start, with its default reference.
    pub fn new(id: ModeId) -> Self {
        match id {
            ModeId::Manual => Self::Manual(manual::Setpoint::default()),
            ModeId::FrontDistance => {
                Self::FrontDistance(front_distance::DEFAULT_M, front_distance::State::default())
            }
            ModeId::FrontAlign => {
                Self::FrontAlign(front_distance::DEFAULT_M, front_align::State::default())
            }
            ModeId::WallHold => Self::WallHold(wall_hold::State::default()),
            ModeId::WallFollow => Self::WallFollow(DEFAULT_WALL_M, wall_follow::State::default()),
            ModeId::WheelSpeed => Self::WheelSpeed(Wheels::both(0.0)),
            ModeId::StraightLine => Self::StraightLine(0.0, straight_line::State::default()),
            ModeId::Waypoints => Self::Waypoints(Route::default(), waypoints::State::default()),
            ModeId::Mission => Self::Mission(Task::default(), mission::State::default()),
        }
    }

    /// Which mode it is.
    pub fn id(&self) -> ModeId {
        match self {
            Self::Manual(_) => ModeId::Manual,
            Self::FrontDistance(..) => ModeId::FrontDistance,
            Self::FrontAlign(..) => ModeId::FrontAlign,
            Self::WallHold(_) => ModeId::WallHold,
            Self::WallFollow(..) => ModeId::WallFollow,
            Self::WheelSpeed(_) => ModeId::WheelSpeed,
            Self::StraightLine(..) => ModeId::StraightLine,
            Self::Waypoints(..) => ModeId::Waypoints,
            Self::Mission(..) => ModeId::Mission,
        }
    }

    /// Forgets its state and keeps its reference: the wheels have just been armed.
    pub fn start(&mut self) {
        match self {
            Self::Manual(_) | Self::WheelSpeed(_) => {}
            Self::FrontDistance(_, state) => *state = front_distance::State::default(),
            Self::FrontAlign(_, state) => *state = front_align::State::default(),
            Self::WallHold(state) => *state = wall_hold::State::default(),
            Self::WallFollow(_, state) => *state = wall_follow::State::default(),
            Self::StraightLine(_, state) => *state = straight_line::State::default(),
            Self::Waypoints(_, state) => *state = waypoints::State::default(),
            Self::Mission(_, state) => {
                *state = mission::State::default();
                state.renew();
            }
        }
    }

    /// Where it needs to look, armed or not.
    pub fn look(&self) -> Look {
        match self {
            Self::FrontDistance(..) => Look::only(SonarId::Front),
            _ => Look::default(),
        }
    }

    /// Whether the mode can do its work with the sonars of this rig.
    pub fn fits(&self, rig: Rig) -> bool {
        match self {
            Self::FrontDistance(..) => matches!(rig, Rig::FrontSingle | Rig::Final),
            Self::FrontAlign(..) => matches!(rig, Rig::FrontPair | Rig::Final),
            Self::WallHold(_) | Self::WallFollow(..) => {
                rig.paired_side().is_some() || rig == Rig::Final
            }
            Self::Mission(..) => rig == Rig::Final,
            Self::Manual(_)
            | Self::WheelSpeed(_)
            | Self::StraightLine(..)
            | Self::Waypoints(..) => true,
        }
    }

    /// Whether the sensors it needs give good readings.
    pub fn is_ready(&self, params: &Params, estimate: &Estimate) -> bool {
        let stale_s = params.get(ParamId::StaleRange);
        match self {
            Self::WallHold(_) => {
                Beside::new(params).is_ready(estimate, stale_s, (MIN_WALL_M, MAX_WALL_M))
            }
            Self::WallFollow(..) => {
                Beside::new(params).is_ready(estimate, stale_s, (MIN_RANGE_M, REACH_M))
            }
            Self::FrontDistance(distance_m, _) => {
                FrontDistance::new(params, *distance_m).is_ready(estimate)
            }
            Self::FrontAlign(..) => Ahead::new(params).is_ready(estimate),
            _ => true,
        }
    }

    /// The reference in force: a distance [m] in modes 1 to 4, wheel speeds [rad/s] in modes 5 and 6, the place to go to
    /// (x on the left, y on the right) [m] in modes 7 and 8, else 0.
    pub fn reference(&self) -> Wheels<f32> {
        match self {
            Self::FrontDistance(distance_m, _)
            | Self::FrontAlign(distance_m, _)
            | Self::WallFollow(distance_m, _) => Wheels::both(*distance_m),
            Self::WheelSpeed(references) => *references,
            Self::StraightLine(rad_s, _) => Wheels::both(*rad_s),
            Self::Mission(Task::Goal { x_m, y_m }, _) => Wheels {
                left: *x_m,
                right: *y_m,
            },
            Self::Waypoints(_, state) => {
                let (left, right) = state.target();
                Wheels { left, right }
            }
            Self::WallHold(state) => Wheels::both(state.reference_m()),
            Self::Manual(_) | Self::Mission(..) => Wheels::both(0.0),
        }
    }

    /// One tick, into an action that asks for nothing yet.
    ///
    /// # Errors
    /// Why the mode cannot go on.
    pub fn act(
        &mut self,
        params: &Params,
        at: &Situation,
        action: &mut Action,
    ) -> Result<(), Fault> {
        match self {
            Self::Manual(setpoint) => Manual::new(params, *setpoint).act(&mut (), at, action),
            Self::FrontDistance(distance_m, state) => {
                FrontDistance::new(params, *distance_m).act(state, at, action)
            }
            Self::FrontAlign(distance_m, state) => {
                FrontAlign::new(params, *distance_m).act(state, at, action)
            }
            Self::WallHold(state) => WallHold::new(params).act(state, at, action),
            Self::WallFollow(distance_m, state) => {
                WallFollow::new(params, *distance_m).act(state, at, action)
            }
            Self::WheelSpeed(references) => WheelSpeed {
                references: *references,
            }
            .act(&mut (), at, action),
            Self::StraightLine(rad_s, state) => {
                StraightLine::new(params, *rad_s).act(state, at, action)
            }
            Self::Waypoints(route, state) => Waypoints::new(params, route).act(state, at, action),
            Self::Mission(task, state) => Mission::new(params, *task).act(state, at, action),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::types::Range;

    #[test]
    fn the_front_mode_is_ready_only_when_its_sonar_sees_a_wall() {
        let mode = ActiveMode::new(ModeId::FrontDistance);
        let (params, mut estimate) = (Params::default(), Estimate::default());
        assert!(!mode.is_ready(&params, &estimate));
        estimate.ranges[SonarId::Front as usize].range = Range::Clear;
        assert!(!mode.is_ready(&params, &estimate));
        let front = &mut estimate.ranges[SonarId::Front as usize];
        front.range = Range::Valid(0.8);
        assert!(!mode.is_ready(&params, &estimate), "an old reading");
        estimate.ranges[SonarId::Front as usize].age_ticks = 10;
        assert!(mode.is_ready(&params, &estimate));
        assert!(ActiveMode::new(ModeId::Manual).is_ready(&params, &Estimate::default()));
    }

    #[test]
    fn a_mode_fits_the_rigs_that_carry_its_sonars() {
        let fits = |id| Rig::ALL.map(|rig| ActiveMode::new(id).fits(rig));
        assert_eq!(
            fits(ModeId::FrontDistance),
            [true, false, false, false, true]
        );
        assert_eq!(fits(ModeId::FrontAlign), [false, true, false, false, true]);
        assert_eq!(fits(ModeId::WallFollow), [false, false, true, true, true]);
        assert_eq!(fits(ModeId::Waypoints), [true; 5]);
    }
}
