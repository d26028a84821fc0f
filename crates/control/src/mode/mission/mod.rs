//! Mode 8: a goal around obstacles, or a lane of boxes (memoria 5).

mod echoes;
mod goal;
mod obstacle;
mod plan;
mod watch;

use super::{Action, Look, Mode, Situation};
use crate::math::{abs, min, sqrt};
use crate::motion::{Line, LineState, Segment, Turn, TurnState};
use crate::params::{ParamId, Params};
use crate::types::{Drive, Fault, Pose, ServoAngle, Side};
use echoes::{Echoes, Place};
use obstacle::Way;
use plan::Plan;
use watch::Watch;

/// Names of the states.
#[cfg(feature = "names")]
pub const STATE_NAMES: [&str; 12] = [
    "wait for goal",
    "initial turn",
    "initialise",
    "go to goal",
    "sweep right",
    "sweep left",
    "decide",
    "avoidance turn",
    "advance seeking the obstacle",
    "advance along it",
    "advance a safe distance",
    "unreachable",
];

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

/// Where a mission stands; the report's numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
enum Phase {
    #[default]
    Wait = 0,
    InitialTurn = 1,
    Initialise = 2,
    GoToGoal = 3,
    SweepRight = 4,
    SweepLeft = 5,
    Decide = 6,
    AvoidanceTurn = 7,
    Seek = 8,
    Along = 9,
    SafeDistance = 10,
    Unreachable = 11,
}

/// Configuration of mode 8.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mission {
    task: Task,
    turn: Turn,
    line: Line,
    cruise_m_s: f32,
    around_m_s: f32,
    brake_m_s2: f32,
    give_up_s: f32,
    reset_origin: bool,
    stale_s: f32,
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
    phase: Phase,
    /// There is a task that has not been begun.
    fresh: bool,
    echoes: Echoes,
    plan: Plan,
    watch: Watch,
    detour: Option<Detour>,
    segment: Segment,
    line: LineState,
    turn: TurnState,
    heading_ref_rad: f32,
    speed_m_s: f32,
    /// Way since the obstacle beside was lost [m].
    lost_m: f32,
    gap_m: f32,
    age_s: f32,
    fade_s: f32,
    servo_left: bool,
    /// Times once around something.
    laps: u8,
}

impl State {
    /// A task has been commanded.
    pub fn renew(&mut self) {
        self.fresh = true;
    }
}

impl Mission {
    /// From the parameters.
    pub fn new(params: &Params, task: Task) -> Self {
        Self {
            task,
            turn: Turn::new(params),
            line: Line::new(params),
            cruise_m_s: params.get(ParamId::MissionCruise),
            around_m_s: params.get(ParamId::MissionAround),
            brake_m_s2: params.get(ParamId::LineBrake),
            give_up_s: params.get(ParamId::MissionGiveUp),
            reset_origin: params.get(ParamId::MissionResetOrigin) > 0.5,
            stale_s: params.get(ParamId::StaleRange),
        }
    }
}

impl Mode for Mission {
    type State = State;

    fn step(&self, state: &mut State, at: &Situation) -> Result<Action, Fault> {
        state.watch.step(at.estimate, self.stale_s)?;
        if let Some(reading) = &at.estimate.reading {
            state.echoes.take(&at.estimate.pose, reading);
        }
        match self.task {
            Task::Goal { x_m, y_m } => Ok(self.goal(state, at.estimate, (x_m, y_m))),
            Task::Wait | Task::Lane => Ok(Action::default()),
        }
    }
}
