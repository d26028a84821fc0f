//! The robot of `rumbo-robot` in the plant of `rumbo-plant`, on one clock, behind a simulated serial link.
//!
//! Ticks fall on multiples of 10 ms and latch what the plant's edges left in the board; the outputs reach the plant
//! exactly 3 ms later, as on the chip. Bytes go through [`Link`]s at 9600 baud: whoever uses a [`Sim`] meets the robot
//! as it would behind a real port.
//!
//! Instead of our robot the report's program can be at the pins ([`Program::Original`]): it keeps its own time, and
//! [`Sim::order`] hands it commands without a link.

use crate::board::{Board, micros};
use crate::files::{FileError, Program, Setup, Spread};
use crate::original::Original;
use crate::sonar_fault::{SonarFault, SonarFaults, TimedSonarFault};
use rumbo_control::params::ParamId;
use rumbo_control::{Duty, Inputs, OUTPUT_DELAY_US, Outputs, SIDES, SonarId, TICK_US, Wheels};
use rumbo_plant::contact::Pose;
use rumbo_plant::drivetrain::{Bridge, Side};
use rumbo_plant::link::{Direction, Link, LinkParams};
use rumbo_plant::noise::Noise;
use rumbo_plant::params::Params;
use rumbo_plant::plant::{Event, Plant, State, Truth};
use rumbo_robot::{Config, Robot};
use rumbo_wire::{Command, FromRobot, ResetCause};

/// A simulated robot in its world.
#[derive(Clone, Debug)]
pub struct Sim {
    plant: Plant,
    params: Params,
    state: State,
    robot: Robot,
    /// The report's program, if it is at the pins in the robot's place.
    original: Option<Original>,
    board: Board,
    uplink: Link,
    downlink: Link,
    baud: u32,
    next_tick_us: u64,
    pending: Option<(u64, Outputs)>,
    duty: Wheels<Duty>,
    worst_reverse_rad_s: f64,
    worst_contact_m_s: f64,
    sonar_faults: SonarFaults,
    noise: Noise,
    /// When outputs first and last took effect, and how often since the first [us].
    outputs_us: (u64, u64, u64),
}

impl Sim {
    /// A robot at the start of a scenario; `seed` draws its parameters, unless the scenario says not to, its noise, and a random world.
    ///
    /// # Errors
    /// If the files' values do not fit together.
    pub fn new(setup: &Setup, seed: u64) -> Result<Self, FileError> {
        Self::with_noise(setup, seed, 0)
    }

    /// The same robot on another day: what `seed` draws of it is the same, its noise, slip and floor are those of number `day`.
    ///
    /// # Errors
    /// If the files' values do not fit together.
    pub(crate) fn with_noise(setup: &Setup, seed: u64, day: u32) -> Result<Self, FileError> {
        let setup = &*setup.of_seed(seed)?;
        let params = drawn_params(setup, seed)?;
        let scenario = &setup.scenario;
        let world = setup
            .world
            .world()
            .map_err(|error| FileError::Setting(format!("world {}: {error}", setup.world.name)))?;
        let plant = Plant::new(rumbo_plant::plant::Setup {
            params,
            rig: setup.rig,
            world,
            seed,
            robot: day,
            wheels_in_air: scenario.wheels_in_air,
        });
        let state = plant.start(Pose {
            x_m: scenario.start.x_m,
            y_m: scenario.start.y_m,
            heading_rad: scenario.start.heading_rad,
        });
        let mut robot = Robot::new(Config {
            image: 0,
            reset: ResetCause::PowerOn,
        });
        for (id, value) in setup.rig_parameters()? {
            set_param(&mut robot, id, value)?;
        }
        for (id, value) in setup.robot.parameters.iter().chain(&scenario.parameters) {
            set_param(&mut robot, *id, *value)?;
        }
        let original = match setup.program {
            Program::Rumbo => None,
            Program::Original => Some(Original::new(setup)?),
        };
        let link = LinkParams::default();
        let noise = Noise::new(seed, day);
        let mut sonar_faults = SonarFaults::default();
        for fault in &scenario.sonar_faults {
            sonar_faults.add(*fault);
        }
        Ok(Self {
            plant,
            params,
            state,
            robot,
            original,
            board: Board::default(),
            baud: link.baud,
            uplink: Link::new(link.clone(), noise, Direction::ToRobot),
            downlink: Link::new(link, noise, Direction::ToStation),
            next_tick_us: 0,
            pending: None,
            duty: Wheels::default(),
            worst_reverse_rad_s: 0.0,
            worst_contact_m_s: 0.0,
            sonar_faults,
            noise,
            outputs_us: (0, 0, 0),
        })
    }

    /// Simulated time since the start [us].
    pub fn now_us(&self) -> u64 {
        self.state.now_us()
    }

    /// Speed of the link [baud].
    pub fn baud(&self) -> u32 {
        self.baud
    }

    /// The plant's parameters, as drawn for this seed.
    pub fn params(&self) -> &Params {
        &self.params
    }

    /// What is really the case.
    pub fn truth(&self) -> Truth {
        self.plant.truth(&self.state)
    }

    /// The duties in force at the bridges.
    pub fn duty(&self) -> Wheels<Duty> {
        self.duty
    }

    /// Fastest that a wheel turned while its bridge drove it the other way [rad/s].
    pub fn worst_reverse_rad_s(&self) -> f64 {
        self.worst_reverse_rad_s
    }

    /// Fastest that a point of the body met an obstacle [m/s]; 0 without a contact.
    pub fn worst_contact_m_s(&self) -> f64 {
        self.worst_contact_m_s
    }

    /// Mean time between two settings of the bridges [s].
    pub fn control_period_s(&self) -> f64 {
        let (first_us, last_us, count) = self.outputs_us;
        (last_us - first_us) as f64 * 1e-6 / count.max(1) as f64
    }

    /// Puts bytes for the robot on the line.
    pub fn send(&mut self, bytes: &[u8]) {
        self.uplink.send(self.now_us(), bytes);
    }

    /// Appends the bytes that have arrived from the robot.
    pub fn receive(&mut self, into: &mut Vec<u8>) {
        self.downlink.receive(self.now_us(), into);
    }

    /// Makes a sonar fail at a time. The report's program, which times its own edges, notices a cut one only.
    pub fn fail_sonar(&mut self, fault: TimedSonarFault) {
        self.sonar_faults.add(fault);
    }

    /// Cuts a sonar's wires: from now on it answers no ping.
    pub fn cut_sonar(&mut self, sonar: SonarId) {
        self.fail_sonar(TimedSonarFault {
            at_s: self.now_us() as f64 * 1e-6,
            sonar,
            fault: SonarFault::Cut,
        });
    }

    /// Hands a command to the report's program, as a line of text would. False if our robot is at the pins: it listens to
    /// the link.
    pub fn order(&mut self, command: Command) -> bool {
        let Some(original) = &mut self.original else {
            return false;
        };
        original.command(command);
        true
    }

    /// What the report's program has told since it was last asked; nothing if our robot is at the pins.
    pub fn told(&mut self) -> Vec<FromRobot> {
        self.original
            .as_mut()
            .map(Original::told)
            .unwrap_or_default()
    }

    /// Lets robot and plant live until this time [us].
    pub fn advance(&mut self, until_us: u64) {
        loop {
            let mut next_us = self.next_tick_us.min(until_us);
            if let Some((at_us, _)) = self.pending {
                next_us = next_us.min(at_us);
            }
            let (board, original) = (&mut self.board, &mut self.original);
            let worst_contact_m_s = &mut self.worst_contact_m_s;
            self.plant.advance(&mut self.state, next_us, &mut |event| {
                if let Event::Contact { speed_m_s, .. } = event {
                    *worst_contact_m_s = worst_contact_m_s.max(speed_m_s);
                }
                match original {
                    Some(original) => original.take(event),
                    None => board.take(event),
                }
            });
            self.watch_reverse();
            if let Some((at_us, outputs)) = self.pending
                && at_us == next_us
            {
                self.pending = None;
                self.apply(&outputs);
            }
            if self.next_tick_us == next_us && next_us < until_us {
                self.tick();
            }
            if next_us == until_us {
                return;
            }
        }
    }

    fn tick(&mut self) {
        if self.original.is_some() {
            return self.tick_original();
        }
        let now_us = self.now_us();
        while let Some((_, byte)) = self.uplink.pop(now_us) {
            self.robot.receive(byte);
        }
        let echo = self
            .board
            .echo(now_us)
            .map(|answer| self.sonar_faults.answer(&self.noise, answer, now_us));
        let outputs = self.robot.tick(&Inputs {
            now: micros(now_us),
            encoders: self.board.encoders(),
            echo,
            battery_v: None,
        });
        self.pending = Some((now_us + u64::from(OUTPUT_DELAY_US), outputs));
        self.next_tick_us += u64::from(TICK_US);
        // The transmit interrupt hands a byte to the line whenever the line is free.
        while self.downlink.line_free_us() < self.next_tick_us {
            let Some(byte) = self.robot.transmit() else {
                break;
            };
            self.downlink.send(now_us, &[byte]);
        }
    }

    /// What the report's program does takes effect at once.
    fn tick_original(&mut self) {
        let now_us = self.now_us();
        let Some(original) = &mut self.original else {
            return;
        };
        let pins = original.tick(now_us);
        self.next_tick_us = original.next_us();
        if let Some(drive) = pins.drive {
            self.set_bridges(drive);
        }
        if let Some(servo_rad) = pins.servo_rad {
            self.plant.set_servo(&mut self.state, servo_rad);
        }
        for sonar in SonarId::ALL {
            if pins.pings[sonar as usize] {
                self.trigger(sonar);
            }
        }
    }

    fn apply(&mut self, outputs: &Outputs) {
        self.set_bridges(outputs.drive);
        self.plant
            .set_servo(&mut self.state, f64::from(outputs.servo.0));
        if let Some(sonar) = outputs.ping {
            self.trigger(sonar);
            self.board.pinged(sonar, self.state.now_us());
        }
    }

    fn trigger(&mut self, sonar: SonarId) {
        if !self.sonar_faults.is_cut(sonar, self.now_us()) {
            self.plant.trigger(&mut self.state, plant_sonar(sonar));
        }
    }

    fn set_bridges(&mut self, drive: Wheels<Duty>) {
        let now_us = self.now_us();
        self.outputs_us = match self.outputs_us {
            (0, ..) => (now_us, now_us, 0),
            (first_us, _, count) => (first_us, now_us, count + 1),
        };
        self.duty = drive;
        for side in SIDES {
            self.plant
                .set_bridge(&mut self.state, plant_side(side), bridge(drive[side]));
        }
        self.watch_reverse();
    }

    fn watch_reverse(&mut self) {
        let wheels = self.plant.wheel_rad_s(&self.state);
        for (side, speed) in SIDES.into_iter().zip(wheels) {
            let against = -speed * f64::from(self.duty[side].counts().signum());
            self.worst_reverse_rad_s = self.worst_reverse_rad_s.max(against);
        }
    }
}

/// The robot file's parameters, drawn for the seed, with the scenario's own values on top.
fn drawn_params(setup: &Setup, seed: u64) -> Result<Params, FileError> {
    let mut params = match setup.scenario.spread {
        Spread::Drawn => setup.robot.plant.draw(seed, 0),
        Spread::None => setup.robot.plant,
    };
    for (key, value) in &setup.scenario.plant {
        params
            .set(key, *value)
            .map_err(|error| FileError::Setting(error.to_string()))?;
    }
    Ok(params)
}

fn set_param(robot: &mut Robot, id: ParamId, value: f32) -> Result<(), FileError> {
    robot
        .set_param(id as u8, value)
        .map(|_| ())
        .map_err(|refusal| {
            FileError::Setting(format!(
                "parameter {} = {value}: {}",
                id.name(),
                refusal.explanation()
            ))
        })
}

fn bridge(duty: Duty) -> Bridge {
    let share = f64::from(duty.counts()) / f64::from(Duty::MAX);
    if duty == Duty::RELEASED {
        Bridge::Released
    } else if share > 0.0 {
        Bridge::Forward(share)
    } else {
        Bridge::Backward(-share)
    }
}

fn plant_side(side: rumbo_control::Side) -> Side {
    match side {
        rumbo_control::Side::Left => Side::Left,
        rumbo_control::Side::Right => Side::Right,
    }
}

fn plant_sonar(sonar: SonarId) -> rumbo_plant::sonar::SonarId {
    match sonar {
        SonarId::Left => rumbo_plant::sonar::SonarId::Left,
        SonarId::Right => rumbo_plant::sonar::SonarId::Right,
        SonarId::Front => rumbo_plant::sonar::SonarId::Front,
    }
}
