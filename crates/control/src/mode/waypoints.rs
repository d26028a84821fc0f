//! Mode 7: a route of poses by odometry (memoria 4.3): turn, drive, turn.
//!
//! ```text
//! turn:  heading error -> yaw rate that friction can still brake       (motion::turn; left is positive)
//! drive: distance from the line -> heading -> yaw rate; distance left -> speed  (motion::line; left of the line steers right)
//! or, with `waypoint_tracker = "pure_pursuit"`, a pure pursuit of all waypoints up to the next with a heading (pursuit)
//! ```
//!
//! A new route or goal may come at any time: the robot stops and starts it from there. A refused waypoint changes
//! nothing; a route without waypoints waits. A line begins at the previous waypoint, not at the robot's position, so
//! errors at the corners do not add up; the first begins where the robot starts.
//!
//! The report drives at the point itself, with tolerances of 5 degrees and 10 cm; here the line is followed and every
//! stop is planned. Worst of 1,000 simulated robots against the real one, off the square by the robot's odometry: 0.6
//! cm instead of 6, 18.4 s instead of 30; calibrated, they end within 3.2 cm of their start (`rumbo run mode7 --runs
//! 1000`). Theory: docs/theory/waypoints.md.

mod route;

use super::description::{
    FEEDFORWARD, LINES, SPEED, SPEED_LOOPS, TURNS, TWIST, WHEEL_RAMPS, states, steering, turning,
    way,
};
use super::{
    Action, Description, Law, MetricGroup, Mode, ModePlot, ParamGroup, Reference,
    ReferenceDescription, ReferenceKind, Takes,
};
use crate::estimate::Estimate;
use crate::math::wrap_angle;
use crate::motion::{Line, LineState, Segment, Turn, TurnState};
use crate::params::{ParamId, Params};
use crate::pursuit::{Point, Pursuit, PursuitState};
use crate::rig::Rigs;
use crate::types::{Drive, Fault, Pose, Transform};

pub use route::{FARTHEST_M, MAX_WAYPOINTS, Route, Waypoint};

/// Description of mode 7.
pub const DESCRIPTION: Description = Description {
    number: 7,
    name: "waypoints",
    about: "visit the waypoints of a route in turn, such as a square of 1 m",
    states: STATES,
    idle: None,
    reference: Some(REFERENCE),
    heading: true,
    takes: Some(Takes::Route(MAX_WAYPOINTS)),
    rigs: Rigs::ANY,
    parameters: &[
        ParamGroup::new("route", &[ParamId::WaypointTracker]),
        TURNS,
        LINES,
        ParamGroup::new(
            "pure pursuit",
            &[
                ParamId::PursuitTime,
                ParamId::PursuitLeast,
                ParamId::PursuitSide,
                ParamId::PursuitSpacing,
            ],
        ),
        SPEED_LOOPS,
        FEEDFORWARD,
        WHEEL_RAMPS,
    ],
    laws: &[&way(LINE), LAWS, TWIST, SPEED],
    plots: &[ModePlot::Position, ModePlot::Heading, ModePlot::Wheels],
    metrics: &[MetricGroup::Route],
};

const LINE: &[u8] = &[Phase::Drive as u8];
/// [`crate::motion`].
const LAWS: &[Law] = &[
    Law::new(
        "forward_ref_m_s",
        "max(0.03, min(line_cruise_m_s / (1 + abs(heading_error_rad) / 0.35), \
         sqrt(2 * line_brake_m_s2 * max(0, left_m - speed_lag_s * speed_m_s))))",
    )
    .with(&[ParamId::LineAccel])
    .only_in(LINE),
    steering(LINE),
    turning(&[Phase::Turn as u8, Phase::FinalTurn as u8]),
];

/// Each coordinate of a waypoint or a goal, in mode 8 too.
pub(super) const REFERENCE: ReferenceDescription =
    ReferenceDescription::commanded(ReferenceKind::Goal, -FARTHEST_M, FARTHEST_M, 0.0);

states! {
    /// States of mode 7.
    enum Phase {
        /// Wheels released; the line to the next waypoint begins when both stand.
        #[default]
        Wait = "wait" {
            Turn: "both wheels stand and there is a waypoint",
            Drive: "it faces the waypoint already",
            Pursue: "pure pursuit",
            FinalTurn: "at the waypoint already, which has a heading",
            Done: "at the last waypoint already",
        }
        /// Turns on the spot, along the line or to the lookahead.
        Turn = "turn" { Drive: "it faces the waypoint", Pursue: "it faces the lookahead" }
        /// Follows the line to the waypoint.
        Drive = "drive" {
            Wait: "it stands at the waypoint",
            FinalTurn: "it stands at the waypoint, which has a heading",
            Done: "it stands at the last waypoint",
        }
        /// Follows the polyline without stopping.
        Pursue = "pursue" {
            Wait: "it stands at the waypoint",
            Turn: "it stands and the lookahead is far to a side",
            FinalTurn: "it stands at the waypoint, which has a heading",
            Done: "it stands at the last waypoint",
        }
        /// Turns to the waypoint's heading; its position is no longer checked.
        FinalTurn = "final turn" { Wait: "it faces the waypoint's heading", Done: "it faces the last waypoint's heading" }
        /// Wheels released; the event *reached*, once, at the end of the route.
        Done = "done" { Wait: "a waypoint is appended" }
    }
}

/// Configuration of mode 7.
#[derive(Clone, Copy, Debug)]
pub struct Waypoints<'a> {
    /// Where to go.
    route: &'a Route,
    params: &'a Params,
    /// Without stopping; otherwise turn, drive, turn.
    pursues: bool,
}

/// State of mode 7.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    phase: Phase,
    /// Start of the route, the frame of a relative one.
    frame: Option<Transform>,
    /// Index of the present waypoint.
    next: u8,
    /// The previous waypoint [m].
    from: Option<Point>,
    /// The present waypoint [m].
    to: Point,
    /// The segment between them.
    segment: Segment,
    line: LineState,
    /// Heading of the present turn, latched when it begins [rad].
    heading_rad: f32,
    turn: TurnState,
    pursuit: PursuitState,
}

impl State {
    /// The present target [m]; the origin before there is one.
    pub fn target(&self) -> Point {
        self.to
    }

    fn enter(&mut self, phase: Phase) {
        self.phase = phase;
        self.turn = TurnState::default();
        self.line = LineState::default();
    }

    fn turn_to(&mut self, phase: Phase, heading_rad: f32) {
        self.heading_rad = heading_rad;
        self.enter(phase);
    }
}

impl Waypoints<'_> {
    /// A waypoint of the route by its number, in the frame of the odometry.
    fn waypoint(&self, state: &State, number: u8) -> Option<Waypoint> {
        let waypoint = *self.route.waypoints().get(usize::from(number))?;
        let Some(frame) = &state.frame else {
            return Some(waypoint);
        };
        if !self.route.relative {
            return Some(waypoint);
        }
        let (x_m, y_m) = frame.to_world(waypoint.x_m, waypoint.y_m);
        let turned = |heading_rad| wrap_angle(frame.pose.heading_rad + heading_rad);
        Some(Waypoint {
            x_m,
            y_m,
            heading_rad: waypoint.heading_rad.map(turned),
        })
    }

    /// The number that comes after another, `None` at the end of the route.
    fn after(&self, number: u8) -> Option<u8> {
        let next = number.saturating_add(1);
        if usize::from(next) < self.route.waypoints().len() {
            Some(next)
        } else {
            self.route.repeat.then_some(0)
        }
    }

    /// The part driven without stopping: from the next waypoint to the first with a heading, or to the end.
    fn path(&self, state: &State, number: u8) -> Option<Point> {
        let mut at = state.next;
        for _ in 0..number {
            let stops = |waypoint: &Waypoint| waypoint.heading_rad.is_some();
            at = match self.route.waypoints().get(usize::from(at)) {
                Some(waypoint) if !stops(waypoint) => self.after(at)?,
                _ => return None,
            };
        }
        self.waypoint(state, at)
            .map(|waypoint| (waypoint.x_m, waypoint.y_m))
    }

    /// Fixes the line to the next waypoint: from the one before, if the robot is there.
    fn plan(&self, state: &mut State, pose: &Pose) {
        if state.frame.is_none() {
            state.frame = Some(Transform::of(*pose));
        }
        let Some(waypoint) = self.waypoint(state, state.next) else {
            return;
        };
        let here = (pose.x_m, pose.y_m);
        let near = |from: &Point| Segment::between(*from, here).length_m < NEAR_M;
        let from = state.from.filter(near).unwrap_or(here);
        state.to = (waypoint.x_m, waypoint.y_m);
        state.segment = Segment::between(from, state.to);
        state.pursuit = PursuitState::from(from);
        if Segment::between(here, state.to).length_m < THERE_M {
            self.arrive(state, &waypoint);
        } else if self.pursues {
            state.enter(Phase::Pursue);
        } else {
            state.turn_to(Phase::Turn, state.segment.heading_rad());
        }
    }

    /// The robot stands at the waypoint: turns to its heading, if it has one.
    fn arrive(&self, state: &mut State, waypoint: &Waypoint) {
        match waypoint.heading_rad {
            Some(heading_rad) => state.turn_to(Phase::FinalTurn, heading_rad),
            None => self.advance(state),
        }
    }

    /// Advances to the next waypoint, or to the first again.
    fn advance(&self, state: &mut State) {
        state.from = Some(state.to);
        match self.after(state.next) {
            Some(next) => {
                state.next = next;
                state.enter(Phase::Wait);
            }
            None => state.enter(Phase::Done),
        }
    }

    fn pursue(&self, state: &mut State, estimate: &Estimate, waypoint: &Waypoint) -> Drive {
        let mut memory = state.pursuit;
        let path = |number| self.path(state, number);
        let step = Pursuit::new(self.params).step(&mut memory, estimate, f32::MAX, path);
        state.pursuit = memory;
        state.heading_rad = step.heading_ref_rad;
        if step.done {
            self.arrive(state, waypoint);
        } else if step.turn && estimate.standing() {
            state.turn_to(Phase::Turn, step.heading_ref_rad);
        } else if step.passed
            && let Some(next) = self.after(state.next)
        {
            state.next = next;
            if let Some(waypoint) = self.waypoint(state, next) {
                state.to = (waypoint.x_m, waypoint.y_m);
            }
        }
        step.drive
    }
}

/// The robot counts as being at the waypoint before when it is this near [m].
const NEAR_M: f32 = 0.1;
/// A waypoint this near needs no drive [m].
const THERE_M: f32 = 0.01;

impl<'a> Mode<'a> for Waypoints<'a> {
    type Setpoint = Route;
    type State = State;

    fn first() -> Route {
        Route::default()
    }

    fn new(params: &'a Params, route: &'a Route) -> Self {
        Self {
            route,
            params,
            pursues: params.is_on(ParamId::WaypointTracker),
        }
    }

    fn reference(_: &Route, state: &State) -> Reference {
        let (x_m, y_m) = state.target();
        Reference::Goal { x_m, y_m }
    }

    fn step(&self, state: &mut State, estimate: &Estimate) -> Result<Action, Fault> {
        if state.phase == Phase::Done
            && let Some(next) = self.after(state.next)
        {
            state.next = next;
            state.enter(Phase::Wait);
        }
        let mut drive = Drive::Release;
        let mut heading_ref_rad = state.heading_rad;
        match (state.phase, self.waypoint(state, state.next)) {
            (Phase::Done, _) => {}
            (_, None) => state.enter(Phase::Wait),
            (Phase::Wait, Some(_)) => {
                if estimate.standing() {
                    self.plan(state, &estimate.pose);
                }
            }
            (Phase::Turn | Phase::FinalTurn, Some(_)) => {
                let turn = Turn::new(self.params);
                let step = turn.step(&mut state.turn, estimate, state.heading_rad);
                drive = step.drive;
                match (step.done, state.phase) {
                    (false, _) => {}
                    (true, Phase::FinalTurn) => self.advance(state),
                    (true, _) if self.pursues => state.enter(Phase::Pursue),
                    (true, _) => state.enter(Phase::Drive),
                }
            }
            (Phase::Drive, Some(waypoint)) => {
                let line = Line::new(self.params);
                let step = line.step(&mut state.line, estimate, &state.segment, f32::MAX);
                drive = step.drive;
                heading_ref_rad = step.heading_ref_rad;
                if step.done {
                    self.arrive(state, &waypoint);
                }
            }
            (Phase::Pursue, Some(waypoint)) if self.pursues => {
                drive = self.pursue(state, estimate, &waypoint);
            }
            (Phase::Pursue, Some(_)) => state.enter(Phase::Wait),
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

#[cfg(test)]
mod tests;
