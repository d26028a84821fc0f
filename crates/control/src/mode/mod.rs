//! The modes: what the robot does, one file each.
//!
//! A mode is configuration (from the parameters and its setpoint) apart from state, and one function of the
//! [`Situation`]: [`Mode::step`]. One enum dispatches: [`ActiveMode`]. Numbers of modes appear in [`ModeId`] only.

pub mod front_align;
pub mod front_distance;
pub mod manual;
pub mod mission;
pub mod straight_line;
pub mod wall_follow;
pub mod wall_hold;
pub mod waypoints;
pub mod wheel_speed;

use crate::ahead::Ahead;
use crate::beside::Beside;
use crate::estimate::Estimate;
use crate::params::{ParamId, Params};
use crate::range::{MIN_RANGE_M, REACH_M};
use crate::rig::Rig;
use crate::types::{Drive, Fault, ServoAngle, SonarId, Wheels};
use front_align::FrontAlign;
use front_distance::FrontDistance;
use manual::Manual;
use mission::{Mission, Task};
use straight_line::StraightLine;
use wall_follow::WallFollow;
use wall_hold::WallHold;
use waypoints::{FARTHEST_M, Route, Waypoint, Waypoints};
use wheel_speed::WheelSpeed;

/// The modes of the report, by the number they have there.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum ModeId {
    /// Basic movements, open loop or by speed (memoria 1).
    #[default]
    Manual = 0,
    /// Stop at a distance from a wall (memoria 2.1).
    FrontDistance = 1,
    /// Stop square to a wall at a distance from it (memoria 2.2).
    FrontAlign = 2,
    /// Follow a wall at the distance at which the robot starts (memoria 3.1).
    WallHold = 3,
    /// Follow a wall at a commanded distance (memoria 3.2).
    WallFollow = 4,
    /// Each wheel at a commanded speed (memoria 4.1).
    WheelSpeed = 5,
    /// Straight on, by the difference of distance travelled (memoria 4.2).
    StraightLine = 6,
    /// A route of poses by odometry (memoria 4.3).
    Waypoints = 7,
    /// A goal around obstacles, or a lane of boxes (memoria 5).
    Mission = 8,
}

impl ModeId {
    /// The modes that exist, in the order of their numbers.
    pub const ALL: [ModeId; 9] = [
        ModeId::Manual,
        ModeId::FrontDistance,
        ModeId::FrontAlign,
        ModeId::WallHold,
        ModeId::WallFollow,
        ModeId::WheelSpeed,
        ModeId::StraightLine,
        ModeId::Waypoints,
        ModeId::Mission,
    ];

    /// The mode with this number.
    pub fn from_number(number: u8) -> Option<ModeId> {
        Self::ALL.into_iter().find(|mode| *mode as u8 == number)
    }

    /// The name used in files, commands and the dashboard.
    #[cfg(feature = "names")]
    pub const fn name(self) -> &'static str {
        match self {
            ModeId::Manual => "manual",
            ModeId::FrontDistance => "front_distance",
            ModeId::FrontAlign => "front_align",
            ModeId::WallHold => "wall_hold",
            ModeId::WallFollow => "wall_follow",
            ModeId::WheelSpeed => "wheel_speed",
            ModeId::StraightLine => "straight_line",
            ModeId::Waypoints => "waypoints",
            ModeId::Mission => "mission",
        }
    }

    /// The names of its states, by the number in the telemetry.
    #[cfg(feature = "names")]
    pub const fn state_names(self) -> &'static [&'static str] {
        match self {
            ModeId::Manual => &manual::STATE_NAMES,
            ModeId::FrontDistance => &front_distance::STATE_NAMES,
            ModeId::FrontAlign => &front_align::STATE_NAMES,
            ModeId::WallHold => &wall_hold::STATE_NAMES,
            ModeId::WallFollow => &wall_follow::STATE_NAMES,
            ModeId::WheelSpeed => &wheel_speed::STATE_NAMES,
            ModeId::StraightLine => &straight_line::STATE_NAMES,
            ModeId::Waypoints => &waypoints::STATE_NAMES,
            ModeId::Mission => &mission::STATE_NAMES,
        }
    }
}

/// The basic movements of the report's first section.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum Movement {
    /// Both wheels released.
    #[default]
    Stop = 0,
    /// Both wheels forward.
    Forward = 1,
    /// Both wheels backward.
    Backward = 2,
    /// About the centre, counter-clockwise.
    TurnLeft = 3,
    /// About the centre, clockwise.
    TurnRight = 4,
    /// About the standing left wheel: the right wheel forward (counter-clockwise).
    PivotLeftForward = 5,
    /// About the standing left wheel: the right wheel backward (clockwise).
    PivotLeftBackward = 6,
    /// About the standing right wheel: the left wheel forward (clockwise).
    PivotRightForward = 7,
    /// About the standing right wheel: the left wheel backward (counter-clockwise).
    PivotRightBackward = 8,
    /// Forward along an arc to the left.
    ArcLeft = 9,
    /// Forward along an arc to the right.
    ArcRight = 10,
    /// Backward along an arc, the centre on the left.
    ArcLeftBackward = 11,
    /// Backward along an arc, the centre on the right.
    ArcRightBackward = 12,
}

impl Movement {
    /// All movements, by number.
    pub const ALL: [Movement; 13] = [
        Movement::Stop,
        Movement::Forward,
        Movement::Backward,
        Movement::TurnLeft,
        Movement::TurnRight,
        Movement::PivotLeftForward,
        Movement::PivotLeftBackward,
        Movement::PivotRightForward,
        Movement::PivotRightBackward,
        Movement::ArcLeft,
        Movement::ArcRight,
        Movement::ArcLeftBackward,
        Movement::ArcRightBackward,
    ];
}

/// How much of a basic movement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Level {
    /// Open loop: fraction of full PWM, 0..=1.
    Duty(f32),
    /// Closed loop: wheel speed [rad/s], 0 to [`MAX_WHEEL_RAD_S`].
    Speed(f32),
}

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

/// What a mode knows when it steps.
#[derive(Clone, Copy, Debug)]
pub struct Situation<'a> {
    /// What the estimators say.
    pub estimate: &'a Estimate,
}

/// What a mode asks for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Action {
    /// Of the wheels.
    pub drive: Drive,
    /// Of the sonars and the servo.
    pub look: Look,
    /// Number of its state, for telemetry; names: `ModeId::state_names`.
    pub state: u8,
    /// The heading that it wants, for telemetry [rad]; 0 where it wants none.
    pub heading_ref_rad: f32,
    /// It has reached its reference.
    pub reached: bool,
    /// It has found out that its goal cannot be reached.
    pub unreachable: bool,
    /// The present place is the origin from now on.
    pub new_origin: bool,
}

/// Where the robot looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// Where the servo points.
    pub servo: ServoAngle,
    /// Which sonars matter, by `SonarId` number; these are pinged in turn.
    pub sonars: [bool; 3],
}

impl Default for Look {
    fn default() -> Self {
        Self {
            servo: ServoAngle::default(),
            sonars: [true; 3],
        }
    }
}

impl Look {
    /// One sonar only, as often as it can.
    pub const fn only(sonar: SonarId) -> Self {
        let mut sonars = [false; 3];
        sonars[sonar as usize] = true;
        Self {
            servo: ServoAngle(0.0),
            sonars,
        }
    }
}

/// A mode: configuration apart from state.
pub trait Mode {
    /// What it remembers from tick to tick; the default is its start.
    type State: Default;

    /// One tick.
    ///
    /// # Errors
    /// Why it cannot go on; the supervisor then releases the wheels.
    fn step(&self, state: &mut Self::State, at: &Situation) -> Result<Action, Fault>;
}

/// Why a reference is refused; the last valid one stays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SetpointError {
    /// Not a finite number.
    NotFinite,
    /// Outside what the mode allows.
    OutOfRange,
    /// The mode takes no such reference.
    NotInThisMode,
}

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

    /// Sets the reference: distance [m] in modes 1, 2 and 4, speed of both wheels [rad/s] in modes 5 and 6.
    ///
    /// # Errors
    /// Why it is refused; the last one stays.
    pub fn set_reference(&mut self, value: f32) -> Result<(), SetpointError> {
        match self {
            Self::Manual(_) | Self::WallHold(_) | Self::Waypoints(..) | Self::Mission(..) => {
                Err(SetpointError::NotInThisMode)
            }
            Self::FrontDistance(distance_m, _) | Self::FrontAlign(distance_m, _) => {
                *distance_m = within(value, MIN_DISTANCE_M, MAX_DISTANCE_M)?;
                Ok(())
            }
            Self::WallFollow(distance_m, _) => {
                *distance_m = within(value, MIN_WALL_M, MAX_WALL_M)?;
                Ok(())
            }
            Self::StraightLine(rad_s, _) => {
                *rad_s = within(value, -MAX_WHEEL_RAD_S, MAX_WHEEL_RAD_S)?;
                Ok(())
            }
            Self::WheelSpeed(references) => {
                *references = Wheels::both(within(value, -MAX_WHEEL_RAD_S, MAX_WHEEL_RAD_S)?);
                Ok(())
            }
        }
    }

    /// Sets the reference of each wheel [rad/s] in mode 5.
    ///
    /// # Errors
    /// Why it is refused; the last one stays.
    pub fn set_wheel_reference(&mut self, value: Wheels<f32>) -> Result<(), SetpointError> {
        let Self::WheelSpeed(references) = self else {
            return Err(SetpointError::NotInThisMode);
        };
        let left = within(value.left, -MAX_WHEEL_RAD_S, MAX_WHEEL_RAD_S)?;
        let right = within(value.right, -MAX_WHEEL_RAD_S, MAX_WHEEL_RAD_S)?;
        *references = Wheels { left, right };
        Ok(())
    }

    /// Sets the goal: the task of mode 8, a route of one waypoint in mode 7. It may arrive at any time.
    ///
    /// # Errors
    /// Why it is refused; the last one stays.
    pub fn set_goal(&mut self, x_m: f32, y_m: f32) -> Result<(), SetpointError> {
        let (x_m, y_m) = (
            within(x_m, -FARTHEST_M, FARTHEST_M)?,
            within(y_m, -FARTHEST_M, FARTHEST_M)?,
        );
        match self {
            Self::Mission(task, state) => {
                *task = Task::Goal { x_m, y_m };
                state.renew();
            }
            Self::Waypoints(..) => {
                let mut route = Route::empty(false, false);
                route.push(Waypoint {
                    x_m,
                    y_m,
                    heading_rad: None,
                })?;
                *self = Self::Waypoints(route, waypoints::State::default());
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
        let Self::Waypoints(..) = self else {
            return Err(SetpointError::NotInThisMode);
        };
        *self = Self::Waypoints(Route::empty(repeat, relative), waypoints::State::default());
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

    /// Sets the movement of mode 0.
    ///
    /// # Errors
    /// Why it is refused; the last one stays.
    pub fn set_movement(&mut self, movement: Movement, level: Level) -> Result<(), SetpointError> {
        let Self::Manual(setpoint) = self else {
            return Err(SetpointError::NotInThisMode);
        };
        let level = match level {
            Level::Duty(duty) => Level::Duty(within(duty, 0.0, 1.0)?),
            Level::Speed(rad_s) => Level::Speed(within(rad_s, 0.0, MAX_WHEEL_RAD_S)?),
        };
        *setpoint = manual::Setpoint { movement, level };
        Ok(())
    }

    /// One tick.
    ///
    /// # Errors
    /// Why the mode cannot go on.
    pub fn step(&mut self, params: &Params, at: &Situation) -> Result<Action, Fault> {
        match self {
            Self::Manual(setpoint) => Manual::new(params, *setpoint).step(&mut (), at),
            Self::FrontDistance(distance_m, state) => {
                FrontDistance::new(params, *distance_m).step(state, at)
            }
            Self::FrontAlign(distance_m, state) => {
                FrontAlign::new(params, *distance_m).step(state, at)
            }
            Self::WallHold(state) => WallHold::new(params).step(state, at),
            Self::WallFollow(distance_m, state) => {
                WallFollow::new(params, *distance_m).step(state, at)
            }
            Self::WheelSpeed(references) => WheelSpeed {
                references: *references,
            }
            .step(&mut (), at),
            Self::StraightLine(rad_s, state) => StraightLine::new(params, *rad_s).step(state, at),
            Self::Waypoints(route, state) => Waypoints::new(params, route).step(state, at),
            Self::Mission(task, state) => Mission::new(params, *task).step(state, at),
        }
    }
}

fn within(value: f32, min: f32, max: f32) -> Result<f32, SetpointError> {
    if !value.is_finite() {
        Err(SetpointError::NotFinite)
    } else if value < min || value > max {
        Err(SetpointError::OutOfRange)
    } else {
        Ok(value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::types::Range;

    #[test]
    fn a_reference_out_of_range_is_refused_and_the_last_one_stays() {
        let mut mode = ActiveMode::new(ModeId::FrontDistance);
        assert_eq!(mode.set_reference(0.5), Ok(()));
        assert_eq!(mode.set_reference(-0.1), Err(SetpointError::OutOfRange));
        assert_eq!(mode.set_reference(2.2), Err(SetpointError::OutOfRange));
        assert_eq!(mode.set_reference(f32::NAN), Err(SetpointError::NotFinite));
        assert_eq!(mode.reference(), Wheels::both(0.5));
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
        assert_eq!(mode.reference(), Wheels::both(0.0));
        assert_eq!(
            mode.set_movement(Movement::Forward, Level::Duty(0.5)),
            Err(SetpointError::NotInThisMode)
        );
    }

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
        estimate.ranges[SonarId::Front as usize].age_s = 0.1;
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

    #[test]
    fn modes_and_movements_are_found_by_their_number() {
        for mode in ModeId::ALL {
            assert_eq!(ModeId::from_number(mode as u8), Some(mode));
            assert_eq!(ActiveMode::new(mode).id(), mode);
        }
        assert_eq!(ModeId::from_number(9), None);
        #[cfg(feature = "names")]
        for mode in ModeId::ALL {
            assert!(mode.state_names().len() <= 16, "telemetry has four bits");
        }
        assert!(
            Movement::ALL
                .iter()
                .enumerate()
                .all(|(number, movement)| *movement as usize == number)
        );
    }
}
