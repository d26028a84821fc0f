//! Mode 9: a goal, by a policy that was learned in simulation.
//!
//! observation -> network ([`crate::policy`]) -> wheel speeds and servo, every 0.1 s
//!
//! The network works for the ticks of a decision, so what it makes of an observation drives from the next one on; where
//! it is learned it must drive as late. It knows nothing of safety: the sonars are watched as in mode 8, the wheels as in
//! every mode, and the robot stops at the goal by its odometry, where it stays until another one is given.
//! docs/theory/policy.md.

use super::description::{FEEDFORWARD, SPEED, SPEED_LOOPS, WHEEL_RAMPS, states, way};
use super::mission::Watch;
use super::{Action, Description, Law, MetricGroup, Mode, ModePlot, Reference, waypoints};
use crate::estimate::Estimate;
use crate::math::{clamp, sqrt};
use crate::params::{ParamId, Params};
use crate::policy::{DECISION_TICKS, Decision, NetworkShape, ONE, OUTPUTS, Observation};
use crate::rig::{Rig, Rigs};
use crate::types::{Drive, Fault, ServoAngle, Wheels};
use core::f32::consts::FRAC_PI_2;

/// Description of mode 9.
pub const DESCRIPTION: Description = Description {
    number: 9,
    name: "policy",
    about: "reach a goal by a learned network",
    states: STATES,
    idle: Some(Phase::Wait as u8),
    reference: Some(waypoints::REFERENCE),
    heading: false,
    takes: None,
    rigs: Rigs::of(&[Rig::Final]),
    parameters: &[SPEED_LOOPS, FEEDFORWARD, WHEEL_RAMPS],
    laws: &[LAWS, SPEED],
    plots: &[ModePlot::Position, ModePlot::Wheels, ModePlot::Distance],
    metrics: &[MetricGroup::Journey],
};

/// What [`Policy`] makes of the outputs of its network.
const LAWS: &[Law] = &[
    way(SEEKS)[0],
    Law::new("slower", "clamp(left_m / 0.08, 0.25, 1)").only_in(SEEKS),
    Law::new("left_ref_rad_s", "network_left * slower * 12").only_in(SEEKS),
    Law::new("right_ref_rad_s", "network_right * slower * 12").only_in(SEEKS),
    Law::new("servo_rad", "network_servo * 1.5707").only_in(SEEKS),
];
const SEEKS: &[u8] = &[Phase::Seek as u8];

/// The wheel speed of an output of 1 [rad/s].
pub const WHEEL_RAD_S: f32 = 12.0;
/// The servo's angle of an output of 1 [rad]; a little less than its end, which it must not pass.
pub const SERVO_RAD: f32 = FRAC_PI_2 - 1e-4;
/// Nearer than this the goal is reached, by odometry [m]; where it is learned an episode ends here.
const ARRIVED_M: f32 = 0.08;
/// Within that the robot goes on while it gets nearer, ever slower, for so many ticks at most.
const ARRIVING_TICKS: u8 = 100;
/// The slowest then, as a share of what the network says.
const SLOWEST: f32 = 0.25;
/// What the way left may grow meanwhile: more than the odometry's steps [m].
const FARTHER_M: f32 = 0.003;

states! {
    /// States of mode 9.
    enum Phase {
        /// Wheels released.
        #[default]
        Wait = "wait for goal" { Seek: "a goal arrives" }
        /// Drives as the network says.
        Seek = "seek" { Done: "at the goal" }
        /// Wheels released; the event *reached*, once.
        Done = "done" { Seek: "a goal arrives" }
    }
}

/// Where to go [m].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Goal(pub(super) Option<(f32, f32)>);

/// Configuration of mode 9.
#[derive(Clone, Copy, Debug)]
pub struct Policy<'a> {
    goal: &'a Goal,
    /// An answer of a sonar may be as old [s].
    stale_s: f32,
}

/// State of mode 9.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    phase: Phase,
    /// Ticks of the decision that is worked on.
    ticks: u8,
    decision: Decision,
    /// The last one.
    outputs: [i8; OUTPUTS],
    watch: Watch,
    /// Ticks since the goal was reached, and how near it was since [m].
    arriving: (u8, f32),
}

impl State {
    /// Whether the robot stays where it is: at the goal, and not getting nearer any more. The way left is in metres.
    fn is_done(&mut self, left_m: f32) -> bool {
        let (ticks, nearest_m) = &mut self.arriving;
        if left_m >= ARRIVED_M && *ticks == 0 {
            return false;
        }
        if *ticks == 0 || left_m < *nearest_m {
            *nearest_m = left_m;
        }
        *ticks += 1;
        *ticks > ARRIVING_TICKS || left_m > *nearest_m + FARTHER_M
    }

    /// A goal arrives: decisions begin again. The watch over the sonars goes on.
    pub(super) fn renew(&mut self) {
        let watch = self.watch;
        *self = Self {
            watch,
            ..Self::default()
        };
    }
}

/// Outputs of a network as shares of -1..=1.
pub fn shares(outputs: [i8; OUTPUTS]) -> [f32; OUTPUTS] {
    outputs.map(|output| f32::from(output) * (1.0 / ONE as f32))
}

impl<'a> Mode<'a> for Policy<'a> {
    type Setpoint = Goal;
    type State = State;

    fn first() -> Goal {
        Goal::default()
    }

    fn new(params: &Params, goal: &'a Goal) -> Self {
        Self {
            goal,
            stale_s: params.get(ParamId::StaleRange),
        }
    }

    fn reference(goal: &Goal, _: &State) -> Reference {
        let (x_m, y_m) = goal.0.unwrap_or_default();
        Reference::Goal { x_m, y_m }
    }

    fn step(&self, state: &mut State, estimate: &Estimate) -> Result<Action, Fault> {
        if let Some(reading) = &estimate.reading {
            state.watch.hear(estimate, reading);
        }
        state.watch.step(estimate, self.stale_s, false)?;
        if state.watch.is_wild() {
            return Err(Fault::SonarFaulty);
        }
        let mut action = Action::default();
        let mut slower = 1.0;
        state.phase = match self.goal.0 {
            None => Phase::Wait,
            Some((x_m, y_m)) => {
                let (x_m, y_m) = (x_m - estimate.pose.x_m, y_m - estimate.pose.y_m);
                let left_m = sqrt(x_m * x_m + y_m * y_m);
                slower = clamp(left_m / ARRIVED_M, SLOWEST, 1.0);
                // One that is pushed off its goal stays: nobody expects it to drive.
                match state.phase == Phase::Done || state.is_done(left_m) {
                    true => Phase::Done,
                    false => Phase::Seek,
                }
            }
        };
        action.state = state.phase as u8;
        action.reached = state.phase == Phase::Done;
        if state.phase == Phase::Seek {
            let [left, right, servo] = shares(state.outputs);
            let wheels = Wheels { left, right }.map(|share| share * slower * WHEEL_RAD_S);
            if wheels != Wheels::both(0.0) {
                action.drive = Drive::WheelSpeed(wheels);
            }
            action.look.servo = ServoAngle(servo * SERVO_RAD);
        }
        Ok(action)
    }

    #[cfg(not(target_arch = "avr"))]
    fn terms(&self, state: &State, _: &Estimate) -> Option<super::ModeTerms> {
        Some(super::ModeTerms::Network(shares(state.outputs)))
    }
}

impl State {
    /// Works on a decision towards the goal, as [`ActiveMode::decide`](super::ActiveMode::decide).
    pub(super) fn decide(
        &mut self,
        goal_m: &(f32, f32),
        shape: &NetworkShape,
        read: impl Fn(u16) -> u8,
        observe: impl FnOnce(&(f32, f32)) -> Observation,
    ) {
        match self.ticks {
            0 => {
                self.outputs = self.decision.outputs(shape).unwrap_or_default();
                self.decision = Decision::begin(shape, read, &observe(goal_m));
            }
            _ => self.decision.work(shape, read),
        }
        self.ticks = (self.ticks + 1) % DECISION_TICKS;
    }
}

#[cfg(test)]
mod tests;
