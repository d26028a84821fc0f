//! Who commands a robot that is stepped, its scenario or the caller; what it knows, and what is true, as rows of numbers.

use crate::files::commands::read_one;
use crate::files::{FileError, Setup, goal_seen_from};
use crate::operator::Operator;
use crate::run::{of_seed, parameters};
use rumbo_control::mode::ModeId;
use rumbo_control::params::{ParamId, Params};
use rumbo_control::policy::{Known, Observation, observe};
use rumbo_control::{Drive, ServoAngle};
use rumbo_sim::Sim;
use rumbo_sim::trace::TimedMessage;
use rumbo_wire::{Command, Refusal};
use std::sync::Arc;

/// Ground truth, in the order of [`super::Robot::true_values`].
pub const TRUE: [&str; 20] = [
    "t_s",
    "x_m",
    "y_m",
    "heading_rad",
    "left_rad_s",
    "right_rad_s",
    "forward_m_s",
    "yaw_rad_s",
    "range_left_m",
    "range_right_m",
    "range_front_m",
    "servo_rad",
    "battery_v",
    "touching",
    "contacts",
    "contact_m_s",
    "armed",
    "fault",
    "goal_x_m",
    "goal_y_m",
];

/// Who commands the robot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DrivenBy {
    /// Its scenario, over the link, as in a run.
    #[default]
    Scenario,
    /// The caller, without a link: commands are applied at once, and there is no calibration before. The robot starts
    /// disarmed, and the scenario's own commands are not sent.
    Caller,
}

/// What there is of a robot beside its simulation.
#[derive(Clone)]
pub(super) struct Pilot {
    operator: Option<Box<Operator<Arc<Setup>>>>,
    goal: Option<Goal>,
    /// The mode that was selected last.
    mode: ModeId,
}

/// Where the robot is to go.
#[derive(Clone, Copy, Debug)]
struct Goal {
    /// In the world [m].
    at_m: [f64; 2],
    /// As seen from the start: ahead, left [m].
    from_start_m: [f32; 2],
}

impl Pilot {
    /// With the robot of a seed, at its start.
    ///
    /// # Errors
    /// The setup's values do not fit together, its calibration failed, or its program takes no commands of a caller.
    pub(super) fn new(
        setup: &Arc<Setup>,
        driver: DrivenBy,
        seed: u64,
    ) -> Result<(Sim, Self), FileError> {
        let drawn = setup.of_seed(seed)?;
        let start = &drawn.scenario.start;
        let goal = drawn.world.journey.as_ref().map(|journey| Goal {
            at_m: journey.goal_m,
            from_start_m: match goal_seen_from(start, journey.goal_m) {
                Command::Goal { x_m, y_m } => [x_m, y_m],
                _ => [0.0; 2],
            },
        });
        if driver == DrivenBy::Caller {
            let mut sim = drawn.sim(seed)?;
            if !sim.unlink() {
                return Err(FileError::Setting(format!(
                    "scenario {}: a caller can drive Rumbo's own control program only; leave out `program` and `firmware`",
                    drawn.scenario.name
                )));
            }
            let mode = drawn.scenario.mode;
            let mut pilot = Self {
                operator: None,
                goal,
                mode,
            };
            // A robot at its start is disarmed: it refuses no mode.
            let _ = pilot.command(&mut sim, &Command::Mode(mode));
            return Ok((sim, pilot));
        }
        let prepared = of_seed(setup, seed)?;
        let mode = prepared.scenario.mode;
        let mut sim = prepared.sim(seed)?;
        let mut operator = Operator::new(prepared);
        operator.brief(&mut sim)?;
        let pilot = Self {
            operator: Some(Box::new(operator)),
            goal,
            mode,
        };
        Ok((sim, pilot))
    }

    /// Without a goal of its world it has the first one of its scenario's commands.
    pub(super) fn seek_first_goal(&mut self, setup: &Setup) {
        let start = &setup.scenario.start;
        let mut commands = setup.scenario.commands.iter();
        let goal = commands.find_map(|timed| match timed.command {
            Command::Goal { x_m, y_m } => Some([x_m, y_m]),
            _ => None,
        });
        self.goal = self.goal.or_else(|| {
            goal.map(|from_start_m| {
                let [ahead_m, left_m] = from_start_m.map(f64::from);
                let (sin, cos) = libm::sincos(start.heading_rad);
                let at_m = [
                    start.x_m + cos * ahead_m - sin * left_m,
                    start.y_m + sin * ahead_m + cos * left_m,
                ];
                Goal { at_m, from_start_m }
            })
        });
    }

    /// The caller commands it.
    pub(super) fn is_caller(&self) -> bool {
        self.operator.is_none()
    }

    /// Has the scenario, if it commands the robot, send what is due; gives what it has received.
    pub(super) fn operate(&mut self, sim: &mut Sim) -> impl Iterator<Item = TimedMessage> {
        let operator = self.operator.as_mut().map(|operator| {
            operator.step(sim);
            operator.received.drain(..)
        });
        operator.into_iter().flatten()
    }

    /// The robot's parameters now, if the caller commands it, else those at its start; `None` where its program has no
    /// table of them.
    ///
    /// # Errors
    /// The setup's values do not fit together.
    pub(super) fn parameters(&self, sim: &mut Sim) -> Result<Option<Params>, FileError> {
        if let Some(operator) = &self.operator {
            return parameters(operator.setup());
        }
        let mut parameters = Params::default();
        for id in ParamId::ALL {
            if let Ok(value) = sim.instruct(&Command::GetParam { id: id as u8 }) {
                // In range, since it is in force.
                let _ = parameters.set(id, value);
            }
        }
        Ok(Some(parameters))
    }

    /// Where the robot is to go, as seen from its start: ahead, left [m].
    pub(super) fn goal_m(&self) -> Option<[f32; 2]> {
        self.goal.map(|goal| goal.from_start_m)
    }

    /// Applies a command at once; gives the value in force, 0 where there is none.
    ///
    /// # Errors
    /// Why the robot refuses it; `None` if its scenario commands it.
    pub(super) fn command(
        &mut self,
        sim: &mut Sim,
        command: &Command,
    ) -> Result<f32, Option<Refusal>> {
        if self.operator.is_some() {
            return Err(None);
        }
        let in_force = sim.instruct(command)?;
        if let Command::Mode(mode) = command {
            self.mode = *mode;
        }
        Ok(in_force)
    }

    /// Applies a command in the words of a scenario's `[[command]]`, without its time: `arm = true`, `reference_m = 0.3`.
    ///
    /// # Errors
    /// What is wrong with the text, or why the robot refuses it.
    pub(super) fn instruct(&mut self, sim: &mut Sim, text: &str) -> Result<(), FileError> {
        for timed in read_one(text, self.mode)? {
            let command = match (timed.goal_of_world, self.goal) {
                (false, _) => timed.command,
                (true, Some(goal)) => {
                    let [x_m, y_m] = goal.from_start_m;
                    Command::Goal { x_m, y_m }
                }
                (true, None) => {
                    return Err(FileError::Setting(
                        "command: this world has no goal; give goal_m = [x, y]".to_owned(),
                    ));
                }
            };
            self.command(sim, &command).map_err(|refusal| {
                FileError::Setting(match refusal {
                    Some(refusal) => format!("command refused: {}", refusal.explanation()),
                    None => "command refused: the scenario commands this robot".to_owned(),
                })
            })?;
        }
        Ok(())
    }

    /// Points the servo, whatever the mode requests; `None` leaves it to the mode again. A scenario's robot does not obey.
    pub(super) fn aim(&self, sim: &mut Sim, servo: Option<ServoAngle>) {
        if self.operator.is_none() {
            sim.aim(servo);
        }
    }

    /// Gives the wheels speeds, or shares of the full PWM in place of the mode, and points the servo. A scenario's robot
    /// does not obey, one of another mode than that of wheel speeds goes by its mode.
    pub(super) fn drive(&mut self, sim: &mut Sim, drive: &Drive, servo: ServoAngle) {
        if self.operator.is_some() {
            return;
        }
        let duty = match drive {
            Drive::Duty(duty) => Some(*duty),
            _ => None,
        };
        if let Drive::WheelSpeed(wheels) = drive {
            // Another mode refuses it.
            let _ = self.command(sim, &Command::WheelReference(*wheels));
        }
        sim.drive_duty(duty);
        sim.aim(Some(servo));
    }

    /// What the robot's program knows after its last tick; zeros if the program is not Rumbo's own.
    ///
    /// Ranges are those of telemetry, the front one in the servo's direction. The pose is by odometry from the start, the
    /// goal as seen from there; without a goal it is 0.
    pub(super) fn observed(&self, sim: &Sim) -> Observation {
        let Some(known) = sim.knowledge() else {
            return Observation::default();
        };
        let [_, wheels] = known.wheel_rad_s;
        let pose = &known.pose;
        let [x_m, y_m] = match self.goal {
            Some(goal) => goal.from_start_m,
            None => [pose.x_m, pose.y_m],
        };
        let known = Known {
            wheel_rad_s: &wheels,
            ranges: &known.ranges,
            servo_rad: known.servo_rad,
            pose,
        };
        observe(&known, &(x_m, y_m))
    }

    /// Ground truth now, by [`TRUE`]: ranges infinite where nothing is within reach and not a number where
    /// there is no such sonar, `fault` the number of the latched one or
    /// 0, the goal not a number where there is none.
    pub(super) fn true_values(&self, sim: &Sim) -> [f64; TRUE.len()] {
        let truth = sim.truth();
        let [left, right, front, ..] = truth.range_m.map(|range_m| range_m.unwrap_or(f64::NAN));
        let [goal_x_m, goal_y_m] = self.goal.map_or([f64::NAN; 2], |goal| goal.at_m);
        let armed = sim.mode_state().is_some();
        let fault = sim.fault().map_or(0, |fault| fault as u8);
        [
            truth.now_us as f64 * 1e-6,
            truth.pose.x_m,
            truth.pose.y_m,
            truth.pose.heading_rad,
            truth.wheel_rad_s[0],
            truth.wheel_rad_s[1],
            truth.forward_m_s,
            truth.yaw_rad_s,
            left,
            right,
            front,
            truth.servo_rad,
            truth.battery_v,
            f64::from(u8::from(truth.touching)),
            f64::from(truth.contacts),
            sim.worst_contact_m_s(),
            f64::from(u8::from(armed)),
            f64::from(fault),
            goal_x_m,
            goal_y_m,
        ]
    }
}
