//! The report's own program as a baseline: its schemes, gains and habits, reimplemented from its description.
//!
//! It drives the same plant at the same pins as our robot does, so that one set of metrics judges both. What made the
//! robot of the report slow or rough is here on purpose (docs/theory/baseline.md): a loop as long as what it prints,
//! gains per millisecond of that loop, speeds in steps of 3.125 rpm, three sonars fired at once, sleeps of 300 ms.
//! The link is not modelled: commands act at their time, where text lines would act some 50 ms later.
//!
//! | file | report | modes |
//! |---|---|---|
//! | [`walls`] | 2 and 3 | 1 to 4 |
//! | [`speed`] | 4 | 5 and 6, and the lower layer of 7 and 8 |
//! | [`square`] | 5 | 7 |
//! | [`mission`] | 6 | 8 |
//!
//! Units in here are the program's own: cm, degrees, rpm, ms, PWM counts. Motor A is the right wheel, B the left one.

mod chip;
mod mission;
mod pid;
mod speed;
mod square;
mod walls;

pub(crate) use chip::Pins;

use crate::error::SimError;
use chip::Chip;
use mission::Mission;
use rumbo_control::mode::ModeId;
use rumbo_control::{SonarId, Wheels};
use rumbo_plant::plant::Event;
use rumbo_wire::message::{Event as RobotEvent, EventKind, Telemetry};
use rumbo_wire::{Command, FromRobot};
use speed::{RAD_S_PER_RPM, SpeedMode};
use square::{Pose, Square};
use walls::{Task, Walls};

/// Period of the program's timer [us].
const TIMER_US: u64 = 50_000;
/// A loop that waits for `ON` looks for it this often [us].
const IDLE_US: u64 = 1_000;

/// The program of one mode.
#[derive(Clone, Debug)]
enum Program {
    Walls(Walls),
    Speed(SpeedMode),
    Square(Square),
    Mission(Mission),
}

/// The report's program, running.
#[derive(Clone, Debug)]
pub(crate) struct Baseline {
    chip: Chip,
    program: Program,
    on: bool,
    timer_us: u64,
    loop_us: u64,
}

impl Baseline {
    /// The program of a mode, for the rig of this name.
    ///
    /// # Errors
    /// The report has no program for this mode with these sonars.
    pub(crate) fn new(mode: ModeId, rig: &str) -> Result<Self, SimError> {
        let program = match (mode, rig) {
            (ModeId::FrontDistance, "front_single" | "final") => {
                Program::Walls(Walls::new(Task::Distance, false))
            }
            (ModeId::FrontAlign, "front_pair") => Program::Walls(Walls::new(Task::Align, false)),
            (ModeId::WallHold, "side_pair_left") => Program::Walls(Walls::new(Task::Hold, false)),
            (ModeId::WallHold, "side_pair_right") => Program::Walls(Walls::new(Task::Hold, true)),
            (ModeId::WallFollow, "side_pair_left") => {
                Program::Walls(Walls::new(Task::Follow, false))
            }
            (ModeId::WallFollow, "side_pair_right") => {
                Program::Walls(Walls::new(Task::Follow, true))
            }
            (ModeId::WheelSpeed, _) => Program::Speed(SpeedMode::new(false)),
            (ModeId::StraightLine, _) => Program::Speed(SpeedMode::new(true)),
            (ModeId::Waypoints, _) => Program::Square(Square::new()),
            (ModeId::Mission, "final") => Program::Mission(Mission::new()),
            _ => {
                return Err(SimError::NoBaseline {
                    mode,
                    rig: rig.to_owned(),
                });
            }
        };
        Ok(Self {
            chip: Chip::default(),
            program,
            on: false,
            timer_us: TIMER_US,
            loop_us: 0,
        })
    }

    /// When it next does something [us].
    pub(crate) fn next_us(&self) -> u64 {
        self.timer_us.min(self.loop_us)
    }

    /// An edge of an input pin.
    pub(crate) fn handle(&mut self, event: Event) {
        self.chip.now_us = event.at_us();
        if let Some(sonar) = self.chip.handle(event)
            && self.on
            && let Program::Mission(mission) = &mut self.program
        {
            mission.echo(&mut self.chip, sonar);
        }
    }

    /// Does what is due; returns what it wrote to its pins.
    pub(crate) fn tick(&mut self, now_us: u64) -> Pins {
        self.chip.now_us = now_us;
        if self.timer_us <= now_us {
            self.timer_us += TIMER_US;
            self.timer();
        }
        if self.loop_us <= now_us {
            let wait_us = if self.on { self.pass() } else { IDLE_US };
            self.loop_us = now_us + wait_us.max(1);
        }
        std::mem::take(&mut self.chip.pins)
    }

    /// Drains what it has sent, as messages of our link.
    pub(crate) fn drain_messages(&mut self) -> Vec<FromRobot> {
        std::mem::take(&mut self.chip.messages)
    }

    /// Handles a line from the station, given as the equivalent command of ours. The program ignores what it does not
    /// know.
    pub(crate) fn command(&mut self, command: Command) {
        match (&mut self.program, command) {
            (_, Command::Arm) => self.on = true,
            (_, Command::Stop | Command::Disarm) => {
                self.on = false;
                self.chip.drive(Wheels::both(0.0));
            }
            (Program::Walls(walls), Command::Reference(reference_m)) => {
                // The program keeps whole centimetres.
                walls.reference_cm = (f64::from(reference_m) * 100.0).round();
            }
            (Program::Speed(speed), Command::Reference(rad_s)) => {
                speed.reference_rpm = Wheels::both(f64::from(rad_s) / RAD_S_PER_RPM);
            }
            (Program::Speed(speed), Command::WheelReference(rad_s)) => {
                speed.reference_rpm = rad_s.map(|rad_s| f64::from(rad_s) / RAD_S_PER_RPM);
            }
            (Program::Square(square), Command::Route { repeat, .. }) => square.route(repeat),
            (Program::Square(square), Command::Waypoint(point)) => {
                square.points.push([point.x_m, point.y_m].map(f64::from));
            }
            (Program::Square(square), Command::Goal { x_m, y_m }) => {
                square.route(false);
                square.points.push([x_m, y_m].map(f64::from));
            }
            (Program::Mission(mission), Command::Goal { x_m, y_m }) => {
                mission.ordered = Some([x_m, y_m].map(f64::from));
            }
            (Program::Mission(mission), Command::Lane) => mission.follow_lane(),
            _ => {}
        }
    }

    fn timer(&mut self) {
        let chip = &mut self.chip;
        match &mut self.program {
            Program::Walls(_) => {}
            Program::Speed(speed) => speed.timer(chip),
            Program::Square(square) => square.timer(chip),
            Program::Mission(mission) => mission.timer(chip),
        }
    }

    /// One pass of the loop; returns when the next is due [us from now].
    fn pass(&mut self) -> u64 {
        let chip = &mut self.chip;
        let reached = match &mut self.program {
            Program::Walls(walls) => {
                if let Some(wait_us) = walls.pass(chip) {
                    return wait_us;
                }
                false
            }
            Program::Speed(speed) => {
                speed.pass(chip);
                false
            }
            Program::Square(square) => square.pass(chip),
            Program::Mission(mission) => {
                let (sleep_us, reached) = mission.pass(chip);
                if let Some(sleep_us) = sleep_us {
                    return sleep_us;
                }
                reached
            }
        };
        self.publish();
        if reached {
            let t_ms = (self.chip.millis() & 0xffff) as u16;
            let kind = EventKind::Reached;
            self.chip
                .messages
                .push(FromRobot::Event(RobotEvent { t_ms, kind }));
        }
        let bytes = self.line_bytes();
        let blocked_us = self.chip.print(bytes);
        match &self.program {
            Program::Walls(walls) => blocked_us + walls.pause_us(),
            _ => blocked_us,
        }
    }

    /// Length of the line that it prints: numbers as the serial library formats them, plus the extra output that the
    /// periods of recorded runs imply.
    fn line_bytes(&self) -> usize {
        let float = |value: f64| format!("{value:.2},").len();
        let floats = |values: &[f64]| values.iter().copied().map(float).sum::<usize>();
        let Wheels { left, right } = self.chip.driven();
        let whole = format!("88,{},{}\r\n", right.counts(), left.counts()).len();
        let both = |wheels: Wheels<f64>| [wheels.right, wheels.left];
        match &self.program {
            Program::Walls(_) => whole,
            Program::Speed(SpeedMode { speeds, .. }) => {
                9 + whole
                    + 2
                    + floats(&both(speeds.speed_rpm()))
                    + float(speeds.applied_rpm().right)
            }
            Program::Square(square) => {
                let Pose {
                    x_m,
                    y_m,
                    angle_deg,
                } = square.pose;
                let speeds = floats(&both(square.speeds.speed_rpm()));
                15 + whole
                    + speeds
                    + floats(&both(square.speeds.applied_rpm()))
                    + floats(&[x_m, y_m, angle_deg])
            }
            Program::Mission(mission) => {
                let ranges = [SonarId::Right, SonarId::Left, SonarId::Front]
                    .map(|sonar| self.chip.width_us(sonar) / 58.0);
                let Pose {
                    x_m,
                    y_m,
                    angle_deg,
                } = mission.pose;
                15 + "88,1,\r\n".len()
                    + floats(&both(mission.speeds.applied_rpm()))
                    + floats(&[angle_deg, 1.0, 1.0, x_m, y_m, angle_deg])
                    + floats(&ranges)
            }
        }
    }

    /// Publishes the content of a line as a telemetry frame.
    fn publish(&mut self) {
        let (speeds, pose, state) = match &self.program {
            Program::Walls(_) => (None, Pose::default(), 0),
            Program::Speed(speed) => (Some(speed.speeds), Pose::default(), 0),
            Program::Square(square) => (Some(square.speeds), square.pose, square.state()),
            Program::Mission(mission) => (Some(mission.speeds), mission.pose, mission.state()),
        };
        let rad_s = |rpm: Option<Wheels<f64>>| {
            rpm.unwrap_or_default()
                .map(|rpm| (rpm * RAD_S_PER_RPM) as f32)
        };
        // Two decimals are printed.
        let printed = |value: f64| (value * 100.0).round() / 100.0;
        self.chip.messages.push(FromRobot::Telemetry(Telemetry {
            t_ms: (self.chip.millis() & 0xffff) as u16,
            pose: rumbo_control::Pose {
                x_m: printed(pose.x_m) as f32,
                y_m: printed(pose.y_m) as f32,
                heading_rad: printed(pose.angle_deg).to_radians() as f32,
            },
            wheel_rad_s: [rad_s(speeds.map(|speeds| speeds.speed_rpm())); 2],
            wheel_ref_rad_s: rad_s(speeds.map(|speeds| speeds.applied_rpm())),
            duty: self.chip.driven(),
            state,
            armed: self.on,
            ..Telemetry::default()
        }));
    }
}
