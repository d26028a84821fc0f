//! Mode 8: a goal around obstacles, or a lane of boxes (memoria 6).
//!
//! ```text
//! echoes -> remembered points -> the obstacle that blocks the way, with two ends -> a side -> the direction that just
//! passes that end
//!        -> forward speed and yaw rate -> wheel-speed loops                  angles count counter-clockwise, left is positive
//! ```
//!
//! The report turns by 90 degrees to the side on which the obstacle's edge appears at the smaller angle, follows its
//! faces by turns of 90 degrees, and leaves when the bearing to the goal is that of the line again. Ours needs no right
//! angles, scans while it drives, goes straight past stored points, leaves early, and detects when to give up.
//! Derivation, proof of termination and figures: docs/theory/mission.md.

mod beam;
mod detour;
mod echoes;
mod gaze;
mod goal;
mod landmarks;
mod lane;
mod moving;
mod obstacle;
mod place;
mod plan;
mod proof;
mod still;
mod watch;

use super::description::{
    FEEDFORWARD, LINES, SPEED, SPEED_LOOPS, TURNS, TWIST, WHEEL_RAMPS, states, steering, turning,
    way,
};
use super::{
    Action, Description, Law, MetricGroup, Mode, ModePlot, ParamGroup, Reference, Takes, waypoints,
};
use crate::estimate::Estimate;
use crate::math::{abs, min, sqrt};
use crate::motion::{Line, LineState, Segment, Turn, TurnState};
use crate::params::{ParamId, Params};
use crate::rig::{Rig, Rigs};
use crate::types::{
    Drive, Fault, Look, Pose, Range, ServoAngle, Side, SonarId, SonarReading, TICK_S,
};
use beam::Beam;
use echoes::Echoes;
use gaze::Gaze;
use goal::CAREFUL_M;
use moving::MotionMemory;
use obstacle::Way;
use place::Place;
use plan::Plan;
use proof::Proof;
pub(super) use watch::Watch;
use watch::Worth;

/// The servo looks this far to each side while sweeping [rad].
const SWEEP_RAD: f32 = 1.5;
/// A range that stands for nothing within reach [m].
const FAR_M: f32 = 3.0;
/// Heading errors beyond this are turned on the spot [rad].
const SPOT_RAD: f32 = 0.7;
/// Progress that counts [m].
const PROGRESS_M: f32 = 0.05;
/// Speed while a sonar may be lying [m/s].
const DOUBT_M_S: f32 = 0.08;
/// A robot that may not even drive so fast stands [m/s].
const CREEP_M_S: f32 = 0.03;
/// Way around an obstacle without an echo of the sonar towards it, after which that sonar is suspected [m].
const UNSEEN_M: f32 = 0.25;
/// What passes a robot that gives way nearer than this is remembered [m].
const PASSING_M: f32 = 0.2;
/// What no point explains, and the front sonar hears within this, may move [m].
const UNKNOWN_M: f32 = 0.9;
/// Time between two fades of the memory [s].
const FADE_S: f32 = 1.0;

/// What mode 8 is.
pub const DESCRIPTION: Description = Description {
    number: 8,
    name: "mission",
    about: "reach a goal around obstacles, or follow a lane of boxes",
    states: STATES,
    idle: Some(Phase::Wait as u8),
    reference: Some(waypoints::REFERENCE),
    heading: true,
    takes: Some(Takes::Lane),
    rigs: Rigs::of(&[Rig::Final]),
    parameters: &[
        ParamGroup::new("goal", &[ParamId::MissionCruise, ParamId::MissionAround]),
        ParamGroup::new(
            "end of a goal",
            &[ParamId::MissionGiveUp, ParamId::MissionResetOrigin],
        ),
        ParamGroup::new("lane", &[ParamId::LaneSafe]),
        TURNS,
        LINES,
        SPEED_LOOPS,
        FEEDFORWARD,
        WHEEL_RAMPS,
    ],
    laws: &[&way(LINE), LAWS, TWIST, SPEED],
    plots: &[
        ModePlot::Position,
        ModePlot::Heading,
        ModePlot::Distance,
        ModePlot::Wheels,
    ],
    metrics: &[MetricGroup::Journey, MetricGroup::Goals, MetricGroup::Lane],
};

const LINE: &[u8] = &[Phase::GoToGoal as u8];
/// On the line to the goal, where nothing is in the way ([`crate::motion`]).
const LAWS: &[Law] = &[
    Law::new(
        "forward_ref_m_s",
        "max(0.03, min(mission_cruise_m_s, line_cruise_m_s / (1 + abs(heading_error_rad) / 0.35), \
         sqrt(2 * line_brake_m_s2 * max(0, left_m - speed_lag_s * speed_m_s))))",
    )
    .with(&[ParamId::LineAccel])
    .only_in(LINE),
    steering(LINE),
    turning(&[Phase::InitialTurn as u8]),
];

states! {
    /// Where a mission stands; the report's numbers, and one more for the lane.
    enum Phase {
        /// Wheels released.
        #[default]
        Wait = "wait for goal" { Initialise: "a goal arrives" }
        /// Turns on the spot to the goal.
        InitialTurn = "initial turn" {
            GoToGoal: "it faces the goal",
            Prove: "the front sonar is in doubt",
            GiveWay: "something approaches",
        }
        /// Forgets the last goal's detour; left at once.
        Initialise = "initialise" {
            InitialTurn: "the goal is not ahead",
            GoToGoal: "it faces the goal",
            StraightOn: "lane: begin",
            GiveWay: "something approaches",
        }
        /// Follows the straight line to the goal, at 0.40 m/s at most; at its end the event *reached*.
        GoToGoal = "go to goal" {
            Wait: "it stands at the goal",
            InitialTurn: "the goal is not ahead",
            SweepRight: "an obstacle ahead",
            Seek: "the obstacle that it has just left",
            Prove: "the front sonar is in doubt",
            GiveWay: "something approaches",
        }
        /// Goes on at 0.1 m/s at most, the servo looks 1.5 rad to the right.
        SweepRight = "sweep right" {
            SweepLeft: "looked to the right",
            Prove: "the front sonar is in doubt",
            GiveWay: "something approaches",
        }
        /// The same to the left.
        SweepLeft = "sweep left" {
            Decide: "looked to the left",
            Prove: "the front sonar is in doubt",
            GiveWay: "something approaches",
        }
        /// Stands and sees whether it moves; then takes the side past whose end the way to the goal is shorter.
        Decide = "decide" {
            Seek: "the shorter way round",
            GoToGoal: "the way to the goal is clear",
            InitialTurn: "the goal is not ahead",
            AvoidanceTurn: "lane: a quarter turn, or half a turn",
            Prove: "the front sonar is in doubt",
            GiveWay: "something approaches",
        }
        /// Turns on the spot to the direction that passes the end.
        AvoidanceTurn = "avoidance turn" {
            Seek: "it faces past the end",
            GoToGoal: "the way to the goal is clear",
            InitialTurn: "the goal is not ahead",
            Unreachable: "there is no way",
            StraightOn: "lane: it faces the heading",
            Prove: "the front sonar is in doubt",
            GiveWay: "something approaches",
        }
        /// Drives in that direction, at 0.22 m/s at most, the sonar beside not yet seeing the obstacle.
        Seek = "advance seeking the obstacle" {
            Along: "the sonar beside sees the obstacle",
            AvoidanceTurn: "the way past is far from ahead",
            GoToGoal: "the way to the goal is clear",
            InitialTurn: "the goal is not ahead",
            Unreachable: "there is no way",
            Prove: "the front sonar is in doubt",
            GiveWay: "something approaches",
        }
        /// The same along the obstacle.
        Along = "advance along the obstacle" {
            SafeDistance: "the sonar beside loses the obstacle",
            AvoidanceTurn: "the way past is far from ahead",
            GoToGoal: "the way to the goal is clear",
            InitialTurn: "the goal is not ahead",
            Unreachable: "there is no way",
            Prove: "the front sonar is in doubt",
            GiveWay: "something approaches",
        }
        /// The same around its corner.
        SafeDistance = "advance a safe distance" {
            Seek: "12.5 cm on",
            Along: "the sonar beside sees the obstacle",
            AvoidanceTurn: "the way past is far from ahead",
            GoToGoal: "the way to the goal is clear",
            InitialTurn: "the goal is not ahead",
            Unreachable: "there is no way",
            Prove: "the front sonar is in doubt",
            GiveWay: "something approaches",
        }
        /// Wheels released: the event *unreachable*.
        Unreachable = "unreachable" { Initialise: "a goal arrives" }
        /// In a lane only: straight on to the next face.
        StraightOn = "straight on" {
            SweepRight: "lane: stands before a face",
            Prove: "the front sonar is in doubt",
        }
        /// Stands and turns the front sonar, and then itself, to what must answer.
        Prove = "prove the front sonar" {
            GoToGoal: "the sonar answers",
            InitialTurn: "the goal is not ahead",
            AvoidanceTurn: "the sonar answers, beside an obstacle",
            Seek: "the sonar answers, before an obstacle",
            Along: "the sonar answers, along an obstacle",
            SafeDistance: "the sonar answers, around a corner",
            Unreachable: "there is no way",
            GiveWay: "something approaches",
        }
        /// Something approaches: stands, backs off, or drives out of its way. A sonar contradicts itself: stands.
        GiveWay = "give way to what moves" {
            GoToGoal: "nothing approaches",
            InitialTurn: "nothing approaches, the goal is not ahead",
            SweepRight: "out of its way, before an obstacle",
            SweepLeft: "out of its way, before an obstacle",
            Decide: "ranges agree again",
            AvoidanceTurn: "ranges agree again",
            Seek: "ranges agree again",
            Along: "ranges agree again",
            SafeDistance: "ranges agree again",
            Prove: "out of its way, the front sonar is in doubt",
            Unreachable: "there is no way",
        }
    }
}

/// What the mission is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Task {
    /// Wait for a goal.
    #[default]
    Wait,
    /// Reach a point, around what stands in the way.
    Goal {
        /// Forward of the origin [m].
        x_m: f32,
        /// Left of the origin [m].
        y_m: f32,
    },
    /// Follow a lane of boxes.
    Lane,
}

/// Configuration of mode 8.
#[derive(Clone, Copy, Debug)]
pub struct Mission<'a> {
    task: Task,
    params: &'a Params,
    line: Line<'a>,
    /// Largest speed around an obstacle [m/s].
    around_m_s: f32,
}

/// The obstacle that is gone around.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Detour {
    side: Side,
    /// Where it was met.
    met: Place,
    /// Least distance to the goal before it [m].
    least_m: f32,
    /// Way since it was met [m].
    way_m: f32,
    /// The robot has been away from where it met it.
    away: bool,
    /// Times that the robot left it without getting nearer to the goal than before.
    vain: u8,
    /// Changes of the side.
    changes: u8,
    /// Angle by which the robot has gone around the goal since then [rad].
    wound_rad: f32,
    /// The goal's bearing at the last tick [rad].
    bearing_rad: f32,
}

/// Memory of mode 8.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    /// A task has not been started yet.
    fresh: bool,
    phase: Phase,
    age_s: f32,
    heading_ref_rad: f32,
    speed_m_s: f32,
    /// The way to the goal.
    segment: Segment,
    line: LineState,
    turn: TurnState,
    lane: lane::Lane,

    /// Stored points of the surroundings, and the time since they last faded [s].
    echoes: Echoes,
    fade_s: f32,
    /// The gap ahead was measured at this tick, not the distance to what is nearest.
    looks_ahead: bool,
    gap_m: f32,
    /// Distance from the middle of the axis to what is nearest [m].
    near_m: f32,

    plan: Plan,
    detour: Option<Detour>,
    /// The side on which the last obstacle was passed, and the way since [m].
    last: Option<(Side, f32)>,
    /// Way since the obstacle beside was lost [m].
    lost_m: f32,
    /// Way of a detour since the sonar towards the obstacle had an echo; it stays as it is a little beyond the end [m].
    unseen_m: f32,
    /// Times once around something.
    laps: u8,

    gaze: Gaze,
    watch: Watch,
    /// The front sonar is put to the proof.
    proof: Option<Proof>,
    /// What moves.
    movement: MotionMemory,
}

impl Phase {
    /// The robot goes around something.
    fn is_around(self) -> bool {
        matches!(
            self,
            Phase::AvoidanceTurn | Phase::Seek | Phase::Along | Phase::SafeDistance
        )
    }
}

/// What a sonar at the side sees, [`FAR_M`] where that is nothing [m].
fn side_m(estimate: &Estimate, sonar: SonarId) -> f32 {
    match estimate.range(sonar).range {
        Range::Valid(range_m) => range_m,
        Range::Clear | Range::Faulty => FAR_M,
    }
}

impl State {
    /// A task has been commanded.
    pub fn renew(&mut self) {
        self.fresh = true;
    }

    /// Whether a sonar may be wrong, so that the robot should be slow. The one towards the obstacle counts once it has
    /// been silent for too long.
    fn doubts(&self) -> bool {
        self.watch.doubts() || self.unseen_m > UNSEEN_M
    }

    /// It looks to the right and to the left before an obstacle.
    fn sweeps(&self) -> bool {
        matches!(self.phase, Phase::SweepRight | Phase::SweepLeft)
    }

    /// The state for display.
    fn shown(&self, state: u8) -> u8 {
        match self.proof {
            _ if self.movement.gives_way() || self.watch.is_wild() => Phase::GiveWay as u8,
            Some(_) => Phase::Prove as u8,
            None => state,
        }
    }

    /// Stores a reading, as far as it can be trusted.
    fn ingest(&mut self, estimate: &Estimate, reading: &SonarReading) {
        let driving =
            !matches!(self.phase, Phase::Wait | Phase::Unreachable) || self.lane.is_driving();
        let driving = driving && (self.proof.is_some() || !self.movement.is_passing());
        let robot = estimate.transform();
        let sight = Beam::of(&robot, reading);
        let worth = self.watch.ingest(estimate, reading, &sight, driving);
        let front = reading.sonar == SonarId::Front;
        if front {
            self.gaze.count(reading, worth);
        }
        let (beam, sure) = (&sight.0, worth == Worth::Sure);
        match reading.range {
            Range::Clear if sure && front => self.echoes.silence(beam),
            Range::Clear if sure => {
                self.echoes.ingest(&robot, reading, beam, sure);
            }
            Range::Valid(range_m) => {
                // While the robot waits, what passes leaves no points behind, unless it is near.
                if !self.movement.waits() || range_m < PASSING_M {
                    let new = self.echoes.ingest(&robot, reading, beam, sure);
                    if new && front && range_m < UNKNOWN_M {
                        self.movement.wonder(reading.view.axis_rad);
                    }
                }
                if sure && front {
                    self.echoes.confirm_silences();
                }
            }
            Range::Clear | Range::Faulty => {}
        }
    }
}

impl<'a> Mode<'a> for Mission<'a> {
    type Setpoint = Task;
    type State = State;

    fn first() -> Task {
        Task::default()
    }

    fn new(params: &'a Params, task: &Task) -> Self {
        Self {
            task: *task,
            params,
            line: Line::new(params),
            around_m_s: params.get(ParamId::MissionAround),
        }
    }

    fn start(state: &mut State) {
        *state = State::default();
        state.renew();
    }

    fn reference(task: &Task, _: &State) -> Reference {
        match *task {
            Task::Goal { x_m, y_m } => Reference::Goal { x_m, y_m },
            Task::Wait | Task::Lane => Reference::Goal { x_m: 0.0, y_m: 0.0 },
        }
    }

    fn step(&self, state: &mut State, estimate: &Estimate) -> Result<Action, Fault> {
        if let Some(reading) = &estimate.reading {
            state.ingest(estimate, reading);
            // An echo takes longest, and in a tick without a reading a plan may begin.
            if reading.range == Range::Clear {
                state.echoes.settle();
            }
        }
        let stale_s = self.params.get(ParamId::StaleRange);
        let beside = state.phase.is_around() || state.near_m < CAREFUL_M;
        state.watch.step(estimate, stale_s, beside)?;
        state.fade_s += TICK_S;
        if state.fade_s > FADE_S {
            state.fade_s = 0.0;
            // Before a robot that stands, things that move leave their points.
            let all = estimate.standing() && state.movement.is_known();
            state.echoes.fade(all);
        }
        match self.task {
            Task::Goal { x_m, y_m } => self.goal(state, estimate, &(x_m, y_m)),
            Task::Lane => self.lane(state, estimate),
            Task::Wait => Ok(Action::default()),
        }
    }
}

#[cfg(test)]
mod tests;
