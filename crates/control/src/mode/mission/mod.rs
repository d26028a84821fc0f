//! Mode 8: a goal around obstacles, or a lane of boxes (memoria 6).
//!
//! ```text
//! echoes -> remembered points -> the obstacle that blocks the way, with two ends -> a side -> the direction that just passes that end
//!        -> forward speed and yaw rate -> wheel-speed loops                  angles count counter-clockwise, left is positive
//! ```
//!
//! | state | does | leaves when | to |
//! |---|---|---|---|
//! | 0 wait for goal | wheels released | a goal arrives; at any other time too | 2 |
//! | 1 initial turn | turns on the spot to the goal | it faces it | 3 |
//! | 2 initialise | forgets the last goal's detour | at once | 1, or 3 if it faces the goal |
//! | 3 go to goal | follows the straight line to the goal | it stands there: *reached*, the origin moves there | 0 |
//! | | | an obstacle is 0.6 m ahead on the way: a new one | 4 |
//! | | | the one it has just left | 8 |
//! | 4, 5 sweep right, left | goes on slowly, the servo looks 86 degrees aside | the servo has been there | 5, 6 |
//! | 6 decide | takes the side past whose end the way to the goal is shorter | at once | 8 |
//! | 7 avoidance turn | turns on the spot to the direction that passes the end | it faces there | 8 |
//! | 8 advance seeking the obstacle | drives in that direction, the sonar beside not yet seeing it | the sonar sees it | 9 |
//! | 9 advance along it | the same along the obstacle | the sonar loses it | 10 |
//! | 10 advance a safe distance | the same around its corner | 12.5 cm on; the sonar sees it | 8; 9 |
//! | (8, 9, 10) | | that direction is far from ahead | 7 |
//! | (7 to 10) | | the way to the goal is clear and leads nearer to it than the robot ever was | 3 |
//! | | | back where it met the obstacle, or once around the goal | 11 |
//! | 11 unreachable | wheels released: *unreachable* | a goal arrives | 2 |
//!
//! The report turns by 90 degrees to the side on which the obstacle's edge appears at the smaller angle, follows its faces by turns of
//! 90 degrees, and leaves when the bearing to the goal is the line's again. Ours needs no right angles, looks while it drives, goes straight
//! past what it remembers, leaves early, and knows when to give up. Derivation, proof of termination and figures: docs/theory/mission.md.

mod detour;
mod echoes;
mod gaze;
mod goal;
mod landmarks;
mod lane;
mod obstacle;
mod place;
mod plan;
mod proof;
mod watch;

use super::{Action, Look, Mode, Situation};
use crate::estimate::Estimate;
use crate::math::{abs, min, sqrt};
use crate::motion::{Line, LineState, Segment, Turn, TurnState};
use crate::params::{ParamId, Params};
use crate::types::{Drive, Fault, Pose, Range, Reading, ServoAngle, Side, SonarId, TICK_S};
use detour::following;
use echoes::Echoes;
use gaze::Gaze;
use goal::CAREFUL_M;
use obstacle::Way;
use place::Place;
use plan::Plan;
use proof::Proof;
use watch::{Watch, Worth};

/// Time between two fadings of the memory [s].
const FADE_S: f32 = 1.0;

/// Names of the states.
#[cfg(feature = "names")]
pub const STATE_NAMES: [&str; 13] = [
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
    "straight on",
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
// What is small and often used first: the AVR reaches 64 bytes from a pointer by one instruction each.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct State {
    /// There is a task that has not been begun.
    fresh: bool,
    phase: Phase,
    /// The gap ahead was measured at this tick, not the distance to what is nearest.
    looks_ahead: bool,
    gaze: Gaze,
    /// Times once around something.
    laps: u8,
    heading_ref_rad: f32,
    speed_m_s: f32,
    /// Way since the obstacle beside was lost [m].
    lost_m: f32,
    gap_m: f32,
    /// Distance from the middle of the axis to what is nearest [m].
    near_m: f32,
    age_s: f32,
    fade_s: f32,
    detour: Option<Detour>,
    /// The side on which the last obstacle was passed, and the way since [m].
    last: Option<(Side, f32)>,
    line: LineState,
    turn: TurnState,
    /// The front sonar is put to the proof.
    proof: Option<Proof>,
    segment: Segment,
    watch: Watch,
    lane: lane::Lane,
    plan: Plan,
    echoes: Echoes,
}

impl State {
    /// A task has been commanded.
    pub fn renew(&mut self) {
        self.fresh = true;
    }

    /// Remembers what an answer says, as far as it can be believed.
    fn ingest(&mut self, estimate: &Estimate, reading: &Reading) {
        let driving =
            !matches!(self.phase, Phase::Wait | Phase::Unreachable) || self.lane.is_driving();
        let worth = self.watch.ingest(estimate, reading, driving);
        let front = reading.sonar == SonarId::Front;
        if front {
            self.gaze.count(reading, worth);
        }
        let believed = match reading.range {
            Range::Valid(_) => true,
            Range::Clear => worth == Worth::Sure && (!front || self.watch.landmarks.is_alive()),
            Range::Faulty => false,
        };
        if believed {
            let sure = worth == Worth::Sure;
            self.echoes.ingest(&estimate.transform(), reading, sure);
        }
    }
}

impl<'a> Mission<'a> {
    /// From the parameters.
    pub fn new(params: &'a Params, task: Task) -> Self {
        Self {
            task,
            params,
            line: Line::new(params),
            around_m_s: params.get(ParamId::MissionAround),
        }
    }
}

impl Mode for Mission<'_> {
    type State = State;

    fn act(
        &self,
        state: &mut Self::State,
        at: &Situation,
        action: &mut Action,
    ) -> Result<(), Fault> {
        if let Some(reading) = &at.estimate.reading {
            state.ingest(at.estimate, reading);
        }
        let stale_s = self.params.get(ParamId::StaleRange);
        let beside = following(state.phase) || state.near_m < CAREFUL_M;
        state.watch.step(at.estimate, stale_s, beside)?;
        state.fade_s += TICK_S;
        if state.fade_s > FADE_S {
            state.fade_s = 0.0;
            state.echoes.fade();
        }
        match self.task {
            Task::Goal { x_m, y_m } => {
                self.goal(state, at.estimate, &(x_m, y_m), action)?;
            }
            Task::Lane => self.lane(state, at.estimate, action)?,
            Task::Wait => {}
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_that_is_remembered_fits_into_900_bytes() {
        let bytes = core::mem::size_of::<State>();
        assert!(bytes <= 900, "{bytes}");
    }
}
