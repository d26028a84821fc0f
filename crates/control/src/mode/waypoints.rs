//! Mode 7: a route of poses by odometry (memoria 4.3): turn, drive, turn.
//!
//! | state | does | leaves when | to |
//! |---|---|---|---|
//! | 0 wait | wheels released | both stand and there is a waypoint to go to: the line to it is fixed | 1 |
//! | 1 turn | turns on the spot along the line | it faces along it | 2 |
//! | 2 drive | follows the line to the waypoint | it stands at its end | 3, 0 if the waypoint has no heading |
//! | 3 final turn | turns to the waypoint's heading; its place is no longer judged | it faces there | 0 |
//! | 4 done | wheels released: the route is at its end, the event *reached* | a waypoint is appended | 0 |

use super::{Action, Mode, SetpointError, Situation};
use crate::math::wrap_angle;
use crate::motion::{Line, LineState, Segment, Turn, TurnState};
use crate::params::Params;
use crate::types::{Drive, Fault, Pose};

/// Names of the states.
#[cfg(feature = "names")]
pub const STATE_NAMES: [&str; 5] = ["wait", "turn", "drive", "final turn", "done"];

/// Most waypoints of a route.
pub const MAX_WAYPOINTS: usize = 16;
/// Farthest coordinate of a waypoint or a goal from the origin [m].
pub const FARTHEST_M: f32 = 20.0;

/// A place to go to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Waypoint {
    /// Forward of the origin [m].
    pub x_m: f32,
    /// Left of the origin [m].
    pub y_m: f32,
    /// Heading to turn to there [rad]; `None`: as it comes.
    pub heading_rad: Option<f32>,
}

/// The waypoints to visit in turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Route {
    waypoints: [Waypoint; MAX_WAYPOINTS],
    len: u8,
    /// Starts over at the end, until it is stopped.
    pub repeat: bool,
    /// The places are as seen from where the robot starts, not from the origin.
    pub relative: bool,
}

impl Default for Route {
    /// The square of the report: 1 m, counter-clockwise, once.
    fn default() -> Self {
        let mut route = Route::empty(false, false);
        for (x_m, y_m) in [(1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (0.0, 0.0)] {
            // Four of sixteen fit.
            let _ = route.push(Waypoint {
                x_m,
                y_m,
                heading_rad: None,
            });
        }
        route
    }
}

impl Route {
    /// A route without waypoints.
    pub fn empty(repeat: bool, relative: bool) -> Self {
        Self {
            waypoints: [Waypoint::default(); MAX_WAYPOINTS],
            len: 0,
            repeat,
            relative,
        }
    }

    /// The waypoints.
    pub fn waypoints(&self) -> &[Waypoint] {
        self.waypoints
            .get(..usize::from(self.len))
            .unwrap_or_default()
    }

    /// Appends a waypoint.
    ///
    /// # Errors
    /// It is not finite, too far away, or the route is full; the route is as before.
    pub fn push(&mut self, waypoint: Waypoint) -> Result<(), SetpointError> {
        super::within(waypoint.x_m, -FARTHEST_M, FARTHEST_M)?;
        super::within(waypoint.y_m, -FARTHEST_M, FARTHEST_M)?;
        super::within(waypoint.heading_rad.unwrap_or(0.0), -7.0, 7.0)?;
        let slot = self
            .waypoints
            .get_mut(usize::from(self.len))
            .ok_or(SetpointError::OutOfRange)?;
        *slot = waypoint;
        self.len += 1;
        Ok(())
    }
}

/// Configuration of mode 7.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Waypoints<'a> {
    /// Where to go.
    pub route: &'a Route,
    /// How to turn.
    pub turn: Turn,
    /// How to drive.
    pub line: Line,
}

/// Where mode 7 stands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Phase {
    #[default]
    Wait = 0,
    Turn = 1,
    Drive = 2,
    FinalTurn = 3,
    Done = 4,
}

/// Memory of mode 7.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    phase: Phase,
    /// Number of the waypoint to go to.
    next: u8,
    /// From where the route is reckoned.
    frame: Option<Pose>,
    /// The waypoint before this one [m].
    from: Option<(f32, f32)>,
    segment: Segment,
    turn: TurnState,
    line: LineState,
}

impl State {
    /// The place it goes to [m]; the origin before it has one.
    pub fn target(&self) -> (f32, f32) {
        self.segment.point(self.segment.length_m)
    }

    fn enter(&mut self, phase: Phase) {
        self.phase = phase;
        self.turn = TurnState::default();
        self.line = LineState::default();
    }
}

impl<'a> Waypoints<'a> {
    /// From the parameters.
    pub fn new(params: &Params, route: &'a Route) -> Self {
        Self {
            route,
            turn: Turn::new(params),
            line: Line::new(params),
        }
    }

    /// The waypoint to go to, in the frame of the odometry.
    fn waypoint(&self, state: &State) -> Option<Waypoint> {
        let waypoint = *self.route.waypoints().get(usize::from(state.next))?;
        let frame = state.frame.filter(|_| self.route.relative);
        let frame = frame.unwrap_or_default();
        let (x_m, y_m) = frame.to_world(waypoint.x_m, waypoint.y_m);
        let turned = |heading_rad| wrap_angle(frame.heading_rad + heading_rad);
        Some(Waypoint {
            x_m,
            y_m,
            heading_rad: waypoint.heading_rad.map(turned),
        })
    }

    /// Fixes the line to the next waypoint: from the one before, if the robot is there.
    fn plan(&self, state: &mut State, pose: &Pose, waypoint: &Waypoint) {
        let here = (pose.x_m, pose.y_m);
        let near = |from: &(f32, f32)| Segment::between(*from, here).length_m < NEAR_M;
        let to = (waypoint.x_m, waypoint.y_m);
        let from = state.from.filter(near).unwrap_or(here);
        state.segment = Segment::between(from, to);
        let there = Segment::between(here, to).length_m < THERE_M;
        state.enter(if there { Phase::FinalTurn } else { Phase::Turn });
    }

    /// The waypoint is reached: on to the next, or to the first again.
    fn advance(&self, state: &mut State) {
        state.from = Some(state.target());
        state.next = state.next.saturating_add(1);
        let at_the_end = usize::from(state.next) >= self.route.waypoints().len();
        if at_the_end && self.route.repeat {
            state.next = 0;
        }
        state.enter(if at_the_end && !self.route.repeat {
            Phase::Done
        } else {
            Phase::Wait
        });
    }
}

/// The robot counts as being at the waypoint before when it is this near [m].
const NEAR_M: f32 = 0.1;
/// A waypoint this near needs no drive [m].
const THERE_M: f32 = 0.01;

impl Mode for Waypoints<'_> {
    type State = State;

    fn step(&self, state: &mut State, at: &Situation) -> Result<Action, Fault> {
        let pose = &at.estimate.pose;
        state.frame.get_or_insert(*pose);
        let waypoint = self.waypoint(state);
        let (mut drive, mut heading_ref_rad) = (Drive::Release, 0.0);
        match (state.phase, waypoint) {
            (Phase::Wait | Phase::Done, Some(waypoint)) => {
                state.phase = Phase::Wait;
                if at.estimate.standing() {
                    self.plan(state, pose, &waypoint);
                }
            }
            (Phase::Wait | Phase::Done, None) => {}
            (_, None) => state.enter(Phase::Wait),
            (Phase::Turn, Some(_)) => {
                heading_ref_rad = state.segment.heading_rad;
                let step = self
                    .turn
                    .step(&mut state.turn, at.estimate, heading_ref_rad);
                drive = step.drive;
                if step.done {
                    state.enter(Phase::Drive);
                }
            }
            (Phase::Drive, Some(_)) => {
                let step = self
                    .line
                    .step(&mut state.line, at.estimate, &state.segment, f32::MAX);
                (drive, heading_ref_rad) = (step.drive, step.heading_ref_rad);
                if step.done {
                    state.enter(Phase::FinalTurn);
                }
            }
            (Phase::FinalTurn, Some(waypoint)) => match waypoint.heading_rad {
                None => self.advance(state),
                Some(heading_rad) => {
                    heading_ref_rad = heading_rad;
                    let step = self.turn.step(&mut state.turn, at.estimate, heading_rad);
                    drive = step.drive;
                    if step.done {
                        self.advance(state);
                    }
                }
            },
        }
        Ok(Action {
            drive,
            state: state.phase as u8,
            heading_ref_rad,
            reached: state.phase == Phase::Done,
            ..Action::default()
        })
    }
}
